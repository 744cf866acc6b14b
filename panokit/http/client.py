"""The HTTP client: sends requests until they succeed or it is clear that they will not.

It retries by class of failure, waits where servers ask for it (for all its threads at once),
counts what it spends, and keeps credentials out of messages, logs and other origins.
"""

import json
import logging
import random
import threading
import time
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any
from urllib.parse import urlsplit

from panokit.errors import ItemError, UsageError
from panokit.http.breaker import Breaker
from panokit.http.budget import Budget
from panokit.http.failures import (
    WEB_PAGE,
    Failure,
    FailureKind,
    error_of_failure,
    failure_of_reply,
)
from panokit.http.limiter import RateLimiter
from panokit.http.messages import Reply, Request, public_url
from panokit.http.policy import Policy
from panokit.http.redact import RedactingFilter, Redactor
from panokit.http.transport import NO_CONNECTION, Transport

USER_AGENT = "panokit (+https://pypi.org/project/panokit/)"

_log = logging.getLogger("panokit.http")
_URLLIB3_LOG = "urllib3.connectionpool"
_ATTEMPTS_TO_MEET = 3
_DELAYS_BELIEVED = 3
_NOTABLE_PAUSE_S = 5.0
_LOOPBACK = {"127.0.0.1", "localhost", "::1"}


class Client:
    """Sends requests; any number of threads may share one.

    Args:
        policy: Patience and politeness.
        budget: What may be spent; None counts without a limit.
        user_agent: How servers know us.
    """

    def __init__(
        self,
        policy: Policy | None = None,
        *,
        budget: Budget | None = None,
        user_agent: str = USER_AGENT,
    ) -> None:
        self.policy = policy or Policy()
        self.budget = budget or Budget()
        self._redactor = Redactor()
        self._limiter = RateLimiter(self.policy.rate_per_s, self.policy.burst)
        self._transport = Transport(self.policy, self._redactor, user_agent)
        self._random = random.Random(self.policy.seed)
        self._breaker = Breaker(self.policy, time.monotonic)
        self._quota_since_s: dict[str, float] = {}
        self._answered: set[str] = set()
        self._lock = threading.Lock()
        self._log_filter = RedactingFilter(self._redactor)
        logging.getLogger(_URLLIB3_LOG).addFilter(self._log_filter)

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def stop(self) -> None:
        """Let waiting threads fail at once and no further request start."""
        self._limiter.stop()

    def close(self) -> None:
        """Stop, and close every connection."""
        self.stop()
        self._transport.close()
        logging.getLogger(_URLLIB3_LOG).removeFilter(self._log_filter)

    def redact(self, text: str) -> str:
        """The text without the credentials that this client has sent."""
        return self._redactor.redact(text)

    def redact_json(self, value: Any) -> Any:
        """A JSON value without them, for what servers say that is going to be kept."""
        if isinstance(value, str):
            return self._redactor.redact(value)
        if isinstance(value, Mapping):
            return {self.redact_json(name): self.redact_json(one) for name, one in value.items()}
        if isinstance(value, list | tuple):
            return [self.redact_json(one) for one in value]
        return value

    def send(self, request: Request) -> Reply:
        """The good answer to a request, after as many attempts as it takes.

        Raises:
            ItemError: The server does not have it (reason "not-found", ...), or its body
                never passed the request's check.
            AuthError: The key is missing or refused.
            QuotaError: The server's quota or our budget is used up.
            OutageError: The whole service is down.
            NetworkError: No good answer after all attempts.
            UsageError: The address cannot be asked.
        """
        host = self._admit(request)
        attempt = 1
        while True:
            self._limiter.wait(host)
            self._breaker.check(host)
            self.budget.spend(request.cost_usd)
            started_s = time.monotonic()
            outcome = self._attempt(request)
            if isinstance(outcome, Reply):
                self._breaker.succeeded(host)
                self._quota_since_s.pop(host, None)
                return outcome
            pause_s = self._breaker.failed(host, outcome, started_s)
            if pause_s is not None:
                # The service failed, not this request: it keeps its attempts.
                self._pause(host, pause_s, f"fails again and again ({outcome.message})")
                continue
            if not self._may_retry(host, outcome, attempt):
                break
            self._hold(host, outcome, attempt)
            attempt += 1
        # Raised here, outside of any `except`: the error of `requests` would carry the URL along.
        raise error_of_failure(outcome, public_url(request.url), attempt)

    def _admit(self, request: Request) -> str:
        """Note the request's credentials and give its host.

        Raises:
            UsageError: If the address is none, or credentials would travel unencrypted.
        """
        credentials = [*request.secrets.values(), request.authorization]
        for secret in (*credentials, request.authorization.rpartition(" ")[2]):
            self._redactor.remember(secret)
        parts = urlsplit(request.url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise UsageError(
                f"{public_url(request.url)!r} is not a web address. Write it like "
                "https://example.org."
            )
        is_open = parts.scheme != "https" and parts.hostname not in _LOOPBACK
        if any(credentials) and is_open:
            raise UsageError(
                f"A key would travel unencrypted to {parts.hostname}. Use an https:// address."
            )
        return parts.netloc

    def _attempt(self, request: Request) -> Reply | Failure:
        """One exchange and the judgment of its reply."""
        outcome = self._transport.exchange(request)
        if isinstance(outcome, Reply):
            self._answered.add(urlsplit(request.url).netloc)
            failure = failure_of_reply(
                outcome.status, outcome.headers, outcome.body, datetime.now(UTC)
            ) or _body_failure(request, outcome.headers, outcome.body)
            if failure is None:
                return outcome
            outcome = failure
        outcome = replace(outcome, message=self.redact(outcome.message))
        if outcome.kind is FailureKind.AUTH and outcome.status == 403 and not _has_key(request):
            # Who sent no key cannot have had it refused: the thing itself is closed.
            outcome = replace(outcome, kind=FailureKind.PERMANENT, reason="forbidden")
        _log.info("%s: %s", public_url(request.url), outcome.message)
        return outcome

    def _may_retry(self, host: str, failure: Failure, attempt: int) -> bool:
        attempts = self.policy.attempts
        if failure.reason == NO_CONNECTION and host not in self._answered:
            # Rather a wrong address or no network at all than a hiccup: say so soon.
            attempts = min(attempts, _ATTEMPTS_TO_MEET)
        if (failure.delay_s or 0) > self.policy.max_delay_s:
            return False
        if failure.kind is FailureKind.QUOTA and self._is_used_up(host):
            return False
        return failure.is_worth_retrying and attempt < attempts

    def _is_used_up(self, host: str) -> bool:
        """Whether the host has refused everything for longer than a minute's quota lasts."""
        now_s = time.monotonic()
        return now_s - self._quota_since_s.setdefault(host, now_s) > self.policy.quota_patience_s

    def _hold(self, host: str, failure: Failure, attempt: int) -> None:
        """Wait before the next attempt; a quota or a demanded delay holds every thread."""
        # A per-minute quota wants more patience than a hiccup.
        is_quota = failure.kind is FailureKind.QUOTA
        first_s = self.policy.first_delay_s * (4 if is_quota else 1)
        with self._lock:
            jitter = self._random.uniform(0.75, 1.25)
        delay_s = min(first_s * 2.0 ** (attempt - 1) * jitter, self.policy.max_delay_s)
        if failure.delay_s is not None:
            # A server that names ever shorter delays than it means is not believed for ever.
            delay_s = max(failure.delay_s, delay_s if attempt > _DELAYS_BELIEVED else 0.0)
            self._pause(host, delay_s, "asks to wait")
        elif is_quota:
            self._pause(host, delay_s, "gets too many requests")
        else:
            self._limiter.sleep(delay_s)

    def _pause(self, host: str, seconds: float, why: str) -> None:
        level = logging.WARNING if seconds >= _NOTABLE_PAUSE_S else logging.INFO
        _log.log(level, "%s %s: waiting for %.0f s", host, why, seconds)
        self._limiter.pause(host, seconds)


def _has_key(request: Request) -> bool:
    return bool(request.authorization or any(request.secrets.values()))


def _body_failure(request: Request, headers: Mapping[str, str], body: bytes) -> Failure | None:
    """What is wrong with the body of a reply whose status is good."""
    content_type = headers.get("Content-Type", "").partition(";")[0].strip().lower()
    if request.expect == "json":
        try:
            json.loads(body)
        except ValueError:
            return _wrong_body(f"the answer is {content_type or 'of no type'}, not JSON", body)
    elif content_type.startswith("text/") or content_type.endswith("json") or not body:
        said = f"the answer is {content_type if body else 'empty'}, not a picture"
        return _wrong_body(said, body)
    if request.check is None:
        return None
    try:
        request.check(body)
    except ItemError as verdict:
        return Failure(
            kind=FailureKind.TRANSIENT,
            message=str(verdict),
            reason=verdict.reason,
            verdict=verdict,
        )
    return None


def _wrong_body(message: str, body: bytes) -> Failure:
    is_page = body[:256].lstrip().lower().startswith((b"<!doctype html", b"<html"))
    reason = WEB_PAGE if is_page else "wrong-body"
    return Failure(kind=FailureKind.TRANSIENT, message=message, reason=reason)
