"""Which request meets which passing fault, and what its reply becomes."""

import hashlib
import threading
import time
from collections import Counter
from dataclasses import replace
from email.utils import formatdate

import cv2
import numpy as np

from panokit.io.images import encode_jpeg
from panokit.synthetic import google_errors
from panokit.synthetic.exchange import Reply, Request, json_reply
from panokit.synthetic.faults import Faults, Trouble

_PAGE = b"<!DOCTYPE html><html><body>Please sign in to the network.</body></html>"
_DELAY_KINDS = ("429", "429-date", "429-body")
# What differs from one attempt for the same thing to the next.
_CREDENTIALS = ("key", "session", "signature", "access_token", "oh", "oe")


class TroubleSchedule:
    """Decides the fate of each request of one server; safe to use from many threads."""

    def __init__(self, faults: Faults) -> None:
        self._seed = faults.seed
        self._drawn = [one for one in faults.troubles if one.rate is not None]
        self._counted = [one for one in faults.troubles if one.rate is None]
        self._left = [trouble.times for trouble in self._counted]
        self._attempts: Counter[str] = Counter()
        self._lock = threading.Lock()

    def next_for(self, request: Request) -> Trouble | None:
        """The fault that this request meets, with its delay rounded to what a header can say."""
        name = _identity(request)
        with self._lock:
            attempt = self._attempts[name]
            self._attempts[name] += 1
            trouble = self._count_down(request)
        chance = _chance(f"{self._seed} {name} {attempt}")
        if trouble is None:
            trouble = self._draw(request, attempt, chance)
        return None if trouble is None else _settled(trouble, _chance(f"{name} {attempt} delay"))

    def _count_down(self, request: Request) -> Trouble | None:
        for index, trouble in enumerate(self._counted):
            if self._left[index] > 0 and trouble.path in request.path:
                self._left[index] -= 1
                return trouble
        return None

    def _draw(self, request: Request, attempt: int, chance: float) -> Trouble | None:
        """The troubles share the chances: one with a rate of 10 % takes just a tenth of them."""
        for trouble in self._drawn:
            if trouble.path not in request.path:
                continue
            if trouble.attempts is not None and attempt >= trouble.attempts:
                continue
            if chance < (trouble.rate or 0.0):
                return trouble
            chance -= trouble.rate or 0.0
        return None


def spoil(reply: Reply, trouble: Trouble, request: Request) -> Reply:
    """The reply as a request that meets `trouble` sees it."""
    match trouble.kind:
        case "429" | "429-date" | "429-body" | "429-any":
            return _too_many(trouble)
        case "500" | "503":
            return _server_error(int(trouble.kind), request)
        case "html":
            return Reply(body=_PAGE, content_type="text/html; charset=utf-8")
        case "wrong-type":
            return replace(reply, content_type="text/plain")
        case "empty":
            return replace(reply, body=b"")
        case "truncated":
            return replace(reply, truncate=True)
        case "reset":
            return replace(reply, reset=True)
        case "slow":
            return replace(reply, seconds=trouble.slow_s)
        case "small" | "black":
            return _other_picture(reply, trouble.kind)


def _too_many(trouble: Trouble) -> Reply:
    if trouble.kind == "429-body":
        return google_errors.too_many("minute", trouble.retry_after_s)
    until = str(round(trouble.retry_after_s))
    if trouble.kind == "429-date":
        until = formatdate(time.time() + trouble.retry_after_s, usegmt=True)
    return Reply(
        status=429,
        body=b'{"message": "Too Many Requests", "status_code": 429}',
        headers={"Retry-After": until},
    )


def _server_error(status: int, request: Request) -> Reply:
    """As each of the services says it."""
    if request.path.startswith(("/v1/", "/maps/")):
        return google_errors.error(status, "Internal error encountered.", "INTERNAL")
    if request.path.startswith("/api"):
        return json_reply({"message": "Internal Server Error", "status_code": status}, status)
    message = "Service temporarily unavailable"
    return json_reply({"error": {"message": message, "code": 2, "is_transient": True}}, status)


def _other_picture(reply: Reply, kind: str) -> Reply:
    if not reply.content_type.startswith("image/jpeg"):
        return reply
    pixels = cv2.imdecode(np.frombuffer(reply.body, np.uint8), cv2.IMREAD_COLOR_RGB)
    if pixels is None:
        return reply
    spoiled = np.ascontiguousarray(pixels[::2, ::2]) if kind == "small" else np.zeros_like(pixels)
    return replace(reply, body=encode_jpeg(np.asarray(spoiled, np.uint8), quality=90))


def _settled(trouble: Trouble, chance: float) -> Trouble:
    kind = trouble.kind
    if kind == "429-any":
        kind = _DELAY_KINDS[int(chance * len(_DELAY_KINDS))]  # type: ignore[assignment]
        chance = chance * len(_DELAY_KINDS) % 1
    delay_s = trouble.retry_after_s
    if kind in ("429", "429-date"):
        delay_s = int(delay_s) + (chance < delay_s % 1)
    return replace(trouble, kind=kind, retry_after_s=delay_s)


def _identity(request: Request) -> str:
    """The same for each attempt at the same thing, whatever its credentials."""
    asked = sorted((n, v) for n, v in request.query.items() if n not in _CREDENTIALS)
    body = hashlib.sha256(request.body).hexdigest()[:16] if request.body else ""
    return f"{request.port} {request.method} {request.path} {asked} {body}"


def _chance(text: str) -> float:
    """A number from 0 to 1 that depends on the text alone."""
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8]) / 2**64
