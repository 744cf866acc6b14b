"""Keeping keys and tokens out of everything a person or a file gets to see."""

import logging
import re
import threading
from urllib.parse import quote

HIDDEN = "***"

# Query parameters whose value is a credential, whoever put them into the text.
_CREDENTIAL_PARAMETER = re.compile(
    r"(?i)\b(key|api_?key|session|signature|access_token|token|client_secret)=[^&\s\"'<>)]+"
)
_CREDENTIAL_HEADER = re.compile(r"(?i)\b(bearer|oauth|basic)\s+[A-Za-z0-9._~+/|=-]{8,}")


class Redactor:
    """Replaces credentials in text: those it was told of, and those that look like one.

    Threads may share it.
    """

    def __init__(self) -> None:
        self._secrets: frozenset[str] = frozenset()
        self._lock = threading.Lock()

    def remember(self, secret: str) -> None:
        """Hide this value from now on, also in its URL-encoded form."""
        if secret and secret not in self._secrets:
            with self._lock:
                self._secrets |= {secret, quote(secret, safe="")}

    def is_secret(self, value: str) -> bool:
        """Whether this is a value it was told of."""
        return value in self._secrets

    def redact(self, text: str) -> str:
        """The text with every credential replaced by three stars."""
        # Longest first: one secret may be a part of another.
        for secret in sorted(self._secrets, key=len, reverse=True):
            text = text.replace(secret, HIDDEN)
        text = _CREDENTIAL_PARAMETER.sub(rf"\1={HIDDEN}", text)
        return _CREDENTIAL_HEADER.sub(rf"\1 {HIDDEN}", text)


class RedactingFilter(logging.Filter):
    """Redacts the records of a logger that is not ours: urllib3 logs whole URLs when debugging."""

    def __init__(self, redactor: Redactor) -> None:
        super().__init__()
        self._redactor = redactor

    def filter(self, record: logging.LogRecord) -> bool:
        """Rewrite the record in place; every record passes."""
        record.msg = self._redactor.redact(record.getMessage())
        record.args = ()
        return True
