"""What goes to a server and what comes back, as values."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal
from urllib.parse import urlsplit, urlunsplit


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What to ask, and how to tell a good answer.

    Attributes:
        url: With scheme and host; without credentials.
        method: "GET" or "POST".
        params: Query parameters.
        secrets: Query parameters whose values nobody may see; never sent to another origin.
        authorization: The Authorization header ("OAuth MLY|..."), just as secret.
        body: A JSON value to post.
        expect: "json" bodies must parse; "image" bodies must not be text.
        check: Raises an `ItemError` for a body that is not what was asked; then the request
            is tried again, and in the end that error is raised.
        cost_usd: What the provider charges for it.
    """

    url: str
    method: Literal["GET", "POST"] = "GET"
    params: Mapping[str, str] = field(default_factory=dict)
    secrets: Mapping[str, str] = field(default_factory=dict, repr=False)
    authorization: str = field(default="", repr=False)
    body: Any = None
    expect: Literal["json", "image"] = "json"
    check: Callable[[bytes], object] | None = None
    cost_usd: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """What came back.

    Attributes:
        status: HTTP status; what `Client.send` returns is good, 200 to 299.
        headers: With case-insensitive names.
        body: The bytes.
    """

    status: int
    headers: Mapping[str, str]
    body: bytes = field(repr=False)

    def json(self) -> Any:
        """The JSON value of the body."""
        return json.loads(self.body)


def public_url(url: str) -> str:
    """Scheme, host and path: what may be shown of an address."""
    parts = urlsplit(url)
    return urlunsplit((parts.scheme, parts.netloc.rpartition("@")[2], parts.path, "", ""))
