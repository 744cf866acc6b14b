"""What the look-alike services can be told to do wrong."""

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from panokit.synthetic.exchange import Reply, Request

TWO_WEEKS_S = 14 * 24 * 3600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """A passing fault: the first `times` requests to a path meet it, later ones do not.

    Attributes:
        kind: "429" with a Retry-After header, "429-body" with the delay in Google's JSON body
            only, "500", "html" (a web page with status 200), or "truncated" (half a body).
        path: The fault meets requests whose path contains this text.
        times: How many of them.
        retry_after_s: The delay that a 429 asks for.
    """

    kind: Literal["429", "429-body", "500", "html", "truncated"]
    path: str = ""
    times: int = 1
    retry_after_s: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """How the services differ from their best behavior; the default is that they do not.

    Attributes:
        troubles: Passing faults; a request meets the first one that is left for its path.
        api_disabled: The Google project has the API switched off: 403 SERVICE_DISABLED.
        session_lifetime_s: After this a Google session is refused.
        out_of_range: A tile outside the picture is an all-black tile, or a 404.
        edge_tiles: Tiles at the right and lower edge are padded with black, or cropped.
        tile_body_px: The size of Google tile bodies; 256 px bodies have been seen in the wild.
        missing_tiles: (zoom, column, row) of Google tiles that are lost: 404.
        retired: Ids that the services list but no longer have.
        sparse_metadata: Leave out every metadata field that may be absent.
    """

    troubles: Sequence[Trouble] = ()
    api_disabled: bool = False
    session_lifetime_s: float = TWO_WEEKS_S
    out_of_range: Literal["black", "not-found"] = "black"
    edge_tiles: Literal["padded", "cropped"] = "padded"
    tile_body_px: int = 512
    missing_tiles: frozenset[tuple[int, int, int]] = frozenset()
    retired: frozenset[str] = frozenset()
    sparse_metadata: bool = False


class TroubleSchedule:
    """Counts down the passing faults of one server; safe to use from many threads."""

    def __init__(self, troubles: Sequence[Trouble]) -> None:
        self._troubles = tuple(troubles)
        self._left = [trouble.times for trouble in troubles]
        self._lock = threading.Lock()

    def next_for(self, request: Request) -> Trouble | None:
        """The fault that this request meets, or None."""
        with self._lock:
            for index, trouble in enumerate(self._troubles):
                if self._left[index] > 0 and trouble.path in request.path:
                    self._left[index] -= 1
                    return trouble
        return None


def spoil(reply: Reply, trouble: Trouble) -> Reply:
    """The reply as a request that meets `trouble` sees it."""
    if trouble.kind == "truncated":
        return Reply(
            status=reply.status, body=reply.body, content_type=reply.content_type, truncate=True
        )
    if trouble.kind == "html":
        page = b"<!DOCTYPE html><html><body>Please sign in to the network.</body></html>"
        return Reply(body=page, content_type="text/html; charset=utf-8")
    if trouble.kind == "500":
        return Reply(status=500, body=b'{"message": "Internal Server Error", "status_code": 500}')
    if trouble.kind == "429":
        return Reply(
            status=429,
            body=b'{"message": "Too Many Requests", "status_code": 429}',
            headers={"Retry-After": str(trouble.retry_after_s)},
        )
    return Reply(status=429, body=_quota_body(trouble.retry_after_s))


def _quota_body(delay_s: int) -> bytes:
    # Google states the delay in the body and often sends no Retry-After.
    return (
        '{"error": {"code": 429, "message": "Quota exceeded for quota metric '
        "'Street View tile requests' and limit 'Street View tile requests per minute'.\", "
        '"status": "RESOURCE_EXHAUSTED", "details": ['
        '{"@type": "type.googleapis.com/google.rpc.ErrorInfo", '
        '"reason": "RATE_LIMIT_EXCEEDED", "domain": "googleapis.com", "metadata": {}}, '
        '{"@type": "type.googleapis.com/google.rpc.RetryInfo", '
        f'"retryDelay": "{delay_s}s"}}]}}}}'
    ).encode()
