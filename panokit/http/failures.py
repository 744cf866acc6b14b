"""What went wrong with a request, and whether asking again can help."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from enum import StrEnum
from typing import Any

from panokit.errors import AuthError, ItemError, NetworkError, PanokitError, QuotaError


class FailureKind(StrEnum):
    """Classes of failure; each asks for another answer."""

    TRANSIENT = "transient"  # ask again soon
    QUOTA = "quota"  # ask again when the server says so
    AUTH = "auth"  # the key is missing, wrong or not enabled
    PERMANENT = "permanent"  # this thing cannot be had: a verdict about the thing
    UNREACHABLE = "unreachable"  # the connection cannot work as it is configured


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """Why one attempt did not bring what was asked.

    Attributes:
        kind: What to do about it.
        message: What the server or the network said, in one line.
        reason: A short stable code, for counting.
        status: The HTTP status, None where there was no answer.
        delay_s: How long the server asks to wait, None where it does not say.
        verdict: The judgment of the request's own check, raised as it is in the end.
    """

    kind: FailureKind
    message: str
    reason: str
    status: int | None = None
    delay_s: float | None = None
    verdict: ItemError | None = None

    @property
    def is_worth_retrying(self) -> bool:
        """Whether the same request may succeed later."""
        return self.kind in (FailureKind.TRANSIENT, FailureKind.QUOTA)


WEB_PAGE = "web-page"
_TRANSIENT_STATUSES = {408, 425, 500, 502, 503, 504}
_REASONS = {400: "bad-request", 404: "not-found", 410: "gone"}
# Google's machine-readable reasons (google.rpc.ErrorInfo, and the older errors[].reason).
_GOOGLE_AUTH_REASONS = {"API_KEY_INVALID", "SERVICE_DISABLED", "keyInvalid", "accessNotConfigured"}
_GOOGLE_QUOTA_REASONS = {"RATE_LIMIT_EXCEEDED", "rateLimitExceeded", "dailyLimitExceeded"}
_PER_DAY = re.compile(r"(?i)per ?day|daily")
# Mapillary numbers its errors, and sends them with statuses that do not fit: 500 for a bad
# token or for a box that holds too much, 400 for an unknown id.
_MAPILLARY_AUTH, _MAPILLARY_QUOTA = (190,), (4, 17, 613)
_MAPILLARY_TOO_MUCH = 1
_MAPILLARY_UNKNOWN = (100, 33)


def failure_of_reply(
    status: int, headers: Mapping[str, str], body: bytes, now: datetime
) -> Failure | None:
    """The failure that a reply means, or None for a good one.

    Google reports a bad key with status 400 and the time to wait in the body, so both are
    looked for there (google.rpc.ErrorInfo and google.rpc.RetryInfo, AIP-193).

    Args:
        status: The HTTP status.
        headers: Of the reply, with case-insensitive names.
        body: Of the reply.
        now: Timezone-aware; used where the reply has no Date of its own.
    """
    if 200 <= status < 300:
        return None
    error = _error_object(body)
    reasons, code = _google_reasons(error), error.get("code")
    reason = _reason(status, error)
    if status == 429 or reasons & _GOOGLE_QUOTA_REASONS or code in _MAPILLARY_QUOTA:
        kind = FailureKind.QUOTA
    elif status in (401, 403) or reasons & _GOOGLE_AUTH_REASONS or code in _MAPILLARY_AUTH:
        kind = FailureKind.AUTH
    elif reason in ("too-much", "not-found"):
        kind = FailureKind.PERMANENT
    elif status in _TRANSIENT_STATUSES:
        kind = FailureKind.TRANSIENT
    else:
        kind = FailureKind.PERMANENT
    said = str(error.get("message") or "")
    return Failure(
        kind=kind,
        message=f"HTTP {status}" + (f": {said[:200]}" if said else ""),
        reason=reason,
        status=status,
        delay_s=_delay_s(kind, said, error, headers, now),
    )


def _delay_s(
    kind: FailureKind,
    said: str,
    error: Mapping[str, Any],
    headers: Mapping[str, str],
    now: datetime,
) -> float | None:
    """How long the server asks to wait: by its header, its body, or because a day is used up."""
    asked_s = retry_after_s(headers, now)
    if asked_s is None:
        asked_s = _google_delay_s(error)
    if asked_s is None and kind is FailureKind.QUOTA and _PER_DAY.search(said):
        return float("inf")
    return asked_s


def retry_after_s(headers: Mapping[str, str], now: datetime) -> float | None:
    """The wait that a Retry-After header asks for, given in seconds or as an HTTP date.

    A date is measured from the server's own Date, so that a wrong local clock does no harm
    (RFC 9110, section 10.2.3).
    """
    value = headers.get("Retry-After", "").strip()
    if not value:
        return None
    if value.isdecimal():
        return float(value)
    until = _http_date(value)
    if until is None:
        return None
    server_now = _http_date(headers.get("Date", "")) or now
    return max((until - server_now).total_seconds(), 0.0)


def error_of_failure(failure: Failure, what: str, attempts: int) -> PanokitError:
    """The exception to raise for a failure that is final.

    Args:
        failure: The last one.
        what: The address asked, without its query.
        attempts: How often it was asked.
    """
    if failure.verdict is not None:
        return failure.verdict
    said = f"{what}: {failure.message}".rstrip(".")
    tries = "" if attempts == 1 else f" after {attempts} attempts"
    match failure.kind:
        case FailureKind.AUTH:
            return AuthError(
                f"{said}. Check the API key, that the service is enabled for it, and its billing."
            )
        case FailureKind.QUOTA:
            return QuotaError(
                f"{said}{tries}. The quota is used up; what is fetched is kept, run again later."
            )
        case FailureKind.PERMANENT:
            return ItemError(
                f"{said}. The server does not have it or does not understand the request.",
                reason=failure.reason,
                values={"status": failure.status},
            )
        case FailureKind.UNREACHABLE:
            return NetworkError(f"{said}. Check the address of the service.")
        case _:
            return NetworkError(
                f"{said}{tries}. Check the connection; what is fetched is kept, run again later."
            )


def _error_object(body: bytes) -> Mapping[str, Any]:
    """The object that describes the error: `{"error": {..}}`, or the reply itself."""
    try:
        reply = json.loads(body)
    except ValueError:
        return {}
    if not isinstance(reply, dict):
        return {}
    error = reply.get("error", reply)
    return error if isinstance(error, dict) else {"message": error}


def _reason(status: int, error: Mapping[str, Any]) -> str:
    """A short code for a failed request: what the server calls it, or else the status."""
    if (error.get("code"), error.get("error_subcode")) == _MAPILLARY_UNKNOWN:
        return "not-found"
    if error.get("code") == _MAPILLARY_TOO_MUCH and "reduce" in str(error.get("message")):
        return "too-much"
    return _REASONS.get(status, f"http-{status}")


def _google_reasons(error: Mapping[str, Any]) -> set[str]:
    entries = [*_objects(error.get("details")), *_objects(error.get("errors"))]
    return {str(entry["reason"]) for entry in entries if "reason" in entry}


def _google_delay_s(error: Mapping[str, Any]) -> float | None:
    for entry in _objects(error.get("details")):
        match = re.fullmatch(r"(\d+(?:\.\d+)?)s", str(entry.get("retryDelay", "")))
        if match:
            return float(match[1])
    return None


def _objects(value: Any) -> list[Mapping[str, Any]]:
    return [entry for entry in value if isinstance(entry, dict)] if isinstance(value, list) else []


def _http_date(value: str) -> datetime | None:
    try:
        date = parsedate_to_datetime(value)
    except ValueError:
        return None
    return date if date.tzinfo else date.replace(tzinfo=UTC)
