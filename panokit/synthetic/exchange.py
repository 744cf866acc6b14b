"""What goes back and forth between the look-alike services and the HTTP server."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

JPEG = "image/jpeg"
JSON = "application/json; charset=utf-8"

Port = Literal["api", "storage"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """One request as it arrived; also the form it has in the server's log.

    Attributes:
        port: "api" for the service itself, "storage" for the host its pictures redirect to.
        method: "GET" or "POST".
        path: Without the query.
        query: The last value of each parameter.
        headers: With lower-case names.
        body: The bytes that were posted.
        target: Path and query exactly as they were sent.
    """

    port: Port
    method: str
    path: str
    query: Mapping[str, str] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)
    body: bytes = b""
    target: str = ""

    def json(self) -> Any:
        """The posted JSON value, or None if the body is not JSON."""
        try:
            return json.loads(self.body)
        except ValueError:
            return None


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """What the server answers.

    Attributes:
        status: HTTP status.
        body: The bytes.
        content_type: Of the body.
        headers: More headers.
        truncate: Send only half of the body that Content-Length promises, then hang up.
        reset: Cut the connection in place of a reply.
        seconds: How long sending the body takes.
    """

    status: int = 200
    body: bytes = b""
    content_type: str = JSON
    headers: Mapping[str, str] = field(default_factory=dict)
    truncate: bool = False
    reset: bool = False
    seconds: float = 0.0


def json_reply(value: Any, status: int = 200) -> Reply:
    """A reply with a JSON body."""
    return Reply(status=status, body=json.dumps(value, ensure_ascii=False).encode())


def jpeg_reply(data: bytes) -> Reply:
    """A reply with a JPEG body, cacheable as the real services' pictures are."""
    return Reply(body=data, content_type=JPEG, headers={"Cache-Control": "private, max-age=3600"})
