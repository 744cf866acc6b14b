"""Who may talk to the application: nobody but pages that it served itself, on this machine.

A server on 127.0.0.1 is within reach of every web page that its user visits. Three ways lead
there: a name that is made to point at 127.0.0.1 (the Host header tells), requests and WebSockets
from a foreign page (the Origin header tells), and pictures or scripts that such a page embeds
(Sec-Fetch-Site tells). All three get 403. NiceGUI itself checks none of them.
"""

from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from typing import Any

from panokit.app.settings import HOST

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Asgi = Callable[[Scope, Receive, Send], Awaitable[None]]

_NAMES = (HOST, "localhost", "[::1]")
# Inline scripts and evaluated templates are NiceGUI's; nothing may come from, or go, elsewhere.
_POLICY = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self' 'unsafe-inline' 'unsafe-eval'",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self' ws://{host}:{port} ws://localhost:{port}",
        "frame-src 'self'",
        "frame-ancestors 'self'",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
    )
)
_HEADERS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "x-frame-options": "SAMEORIGIN",
}
# What a proxy would say; there is none, and NiceGUI would write it into its pages.
_DROPPED = frozenset({b"x-forwarded-prefix", b"x-forwarded-host", b"x-forwarded-proto"})


def own_hosts(port: int) -> frozenset[str]:
    """What a Host header may say of a server that listens on 127.0.0.1."""
    return frozenset(f"{name}:{port}" for name in _NAMES)


def refusal(headers: Iterable[tuple[bytes, bytes]], port: int) -> str | None:
    """Why a request is refused, or None if it is the application's own.

    Args:
        headers: Names in lower case and values, as ASGI has them.
        port: Where the server listens.
    """
    found: dict[bytes, list[str]] = {}
    for name, value in headers:
        found.setdefault(name.lower(), []).append(value.decode("latin-1"))
    hosts = own_hosts(port)
    named = found.get(b"host", [])
    if len(named) != 1 or named[0].lower() not in hosts:
        return "This server answers to 127.0.0.1 and localhost only."
    origins = {f"http://{host}" for host in hosts}
    if any(origin.lower() not in origins for origin in found.get(b"origin", [])):
        return "Requests from other pages are refused."
    site = (found.get(b"sec-fetch-site") or [""])[0]
    mode = (found.get(b"sec-fetch-mode") or [""])[0]
    # A link to the application may be followed from anywhere; what comes is a page of its own.
    if site in ("cross-site", "same-site") and mode != "navigate":
        return "Requests from other pages are refused."
    return None


class Guard:
    """ASGI middleware that refuses what is not the application's own, and signs what it sends.

    Args:
        app: What is guarded.
        port: Where the server listens.
    """

    def __init__(self, app: Asgi, port: int) -> None:
        self.app = app
        self.port = port
        policy = _POLICY.format(host=HOST, port=port)
        self._headers = [
            (name.encode(), value.encode())
            for name, value in {**_HEADERS, "content-security-policy": policy}.items()
        ]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or answer it with 403."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        why = refusal(scope["headers"], self.port)
        if why is not None:
            await _refuse(scope, receive, send, why)
            return
        scope["headers"] = [pair for pair in scope["headers"] if pair[0].lower() not in _DROPPED]
        await self.app(scope, receive, self._signing(send))

    def _signing(self, send: Send) -> Send:
        async def signed(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                headers = list(message.get("headers", []))
                there = {name.lower() for name, _ in headers}
                # A page with a stricter policy of its own keeps it.
                headers += [pair for pair in self._headers if pair[0] not in there]
                message = {**message, "headers": headers}
            await send(message)

        return signed


async def _refuse(scope: Scope, receive: Receive, send: Send, why: str) -> None:
    if scope["type"] == "websocket":
        # Closed before it was accepted: the server answers the handshake with 403.
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": why})
        return
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close")]
    await send({"type": "http.response.start", "status": 403, "headers": headers})
    await send({"type": "http.response.body", "body": why.encode()})
