"""A local server that looks like street-imagery services, over real HTTP.

    with StreetServer(pictures) as server:
        requests.get(f"{server.url}/api/search?bbox=...")     # a Panoramax instance
        requests.post(f"{server.url}/v1/createSession?key=panokit", json=...)   # Google Map Tiles

It listens on 127.0.0.1 only. A second port plays the object storage that full Panoramax
pictures redirect to; credentials that arrive there are recorded as violations.
"""

import errno
import hashlib
import logging
import socket
import struct
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any
from urllib.parse import parse_qsl, unquote, urlsplit

from panokit.errors import UsageError
from panokit.synthetic.exchange import Port, Reply, Request, json_reply
from panokit.synthetic.faults import Faults
from panokit.synthetic.google_static import PATH as STATIC_PATH
from panokit.synthetic.google_static import GoogleStatic
from panokit.synthetic.google_tiles import GoogleTiles
from panokit.synthetic.mapillary import STORAGE_PATH as MAPILLARY_STORAGE_PATH
from panokit.synthetic.mapillary import Mapillary
from panokit.synthetic.panoramax import Panoramax
from panokit.synthetic.pictures import PictureStore, ServedPicture
from panokit.synthetic.polyhaven import STORAGE_PATH as POLYHAVEN_STORAGE_PATH
from panokit.synthetic.polyhaven import PolyHaven
from panokit.synthetic.troubles import TroubleSchedule, spoil

DEFAULT_KEY = "panokit"
DEFAULT_TOKEN = "MLY|panokit"
REPORT_PATH = "/look-alike"
_TRICKLES = 10
_log = logging.getLogger(__name__)


class StreetServer:
    """Serves pictures as five services at once, told apart by their paths.

    Google Map Tiles under /v1, the Street View Static API under /maps/api/streetview, Panoramax
    under /api, Mapillary at /images and /ID, and Poly Haven at /assets, /info and /files. At
    /look-alike it tells, as JSON, how many requests came and which faults they met.

    Args:
        pictures: What to serve.
        faults: What to do wrong.
        key: The only Google API key that is accepted.
        token: The only Mapillary token that is accepted.
        port: To listen on; 0 takes a free one.

    Attributes:
        url: The root of the API host, without a final slash.
        storage_url: The root of the storage host.
    """

    def __init__(
        self,
        pictures: Sequence[ServedPicture],
        *,
        faults: Faults | None = None,
        key: str = DEFAULT_KEY,
        token: str = DEFAULT_TOKEN,
        port: int = 0,
    ) -> None:
        store = PictureStore(pictures)
        self._faults = faults or Faults()
        self._troubles = TroubleSchedule(self._faults)
        self._requests: list[Request] = []
        self._violations: list[str] = []
        self._met: Counter[str] = Counter()
        self._lock = threading.Lock()
        self._listeners = [_listen("api", self._answer, port), _listen("storage", self._answer, 0)]
        self.url, self.storage_url = (
            f"http://127.0.0.1:{listener.server_address[1]}" for listener in self._listeners
        )
        self._google = GoogleTiles(store, key)
        self._static = GoogleStatic(store, key)
        self._panoramax = Panoramax(store, self.url, self.storage_url)
        self._mapillary = Mapillary(store, token, self.storage_url)
        self._polyhaven = PolyHaven(store, self.storage_url)

    def __enter__(self) -> "StreetServer":
        for listener in self._listeners:
            threading.Thread(
                target=listener.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True
            ).start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for listener in self._listeners:
            listener.shutdown()
            listener.server_close()

    @property
    def requests(self) -> list[Request]:
        """Every request so far, in the order of arrival."""
        with self._lock:
            return list(self._requests)

    @property
    def violations(self) -> list[str]:
        """What clients did that they must not do, one line each."""
        with self._lock:
            return list(self._violations)

    @property
    def faults_met(self) -> dict[str, int]:
        """How often each kind of passing fault was met so far."""
        with self._lock:
            return dict(self._met)

    def set_faults(self, faults: Faults) -> None:
        """Do these things wrong from now on."""
        with self._lock:
            self._faults = faults
            self._troubles = TroubleSchedule(faults)

    def _report(self) -> dict[str, Any]:
        asked = self.requests
        return {
            "requests": len(asked),
            "faults_met": self.faults_met,
            "violations": self.violations,
        }

    def _answer(self, request: Request) -> Reply:
        with self._lock:
            if request.path != REPORT_PATH:
                self._requests.append(request)
            if request.port == "storage" and "authorization" in request.headers:
                self._violations.append(f"Authorization was sent to the storage: {request.path}")
            faults, troubles = self._faults, self._troubles
        if request.path == REPORT_PATH:
            return json_reply(self._report())
        trouble = troubles.next_for(request)
        if trouble is not None:
            with self._lock:
                self._met[trouble.kind] += 1
        reply = _with_etag(self._route(request, faults), request)
        return reply if trouble is None else spoil(reply, trouble, request)

    def _route(self, request: Request, faults: Faults) -> Reply:
        path = request.path
        if request.port == "storage":
            return self._stored(request, faults)
        if path.startswith("/v1/"):
            return self._google.answer(request, faults)
        if path.startswith(STATIC_PATH):
            return self._static.answer(request, faults)
        if path.startswith("/api"):
            return self._panoramax.answer(request, faults)
        if path.startswith(("/assets", "/info/", "/files/", "/types")):
            return self._polyhaven.answer(request, faults)
        if path.count("/") == 1 and path != "/":
            return self._mapillary.answer(request, faults)
        return json_reply({"message": "Nothing is served here.", "status_code": 404}, 404)

    def _stored(self, request: Request, faults: Faults) -> Reply:
        if request.path.startswith(MAPILLARY_STORAGE_PATH):
            return self._mapillary.answer_storage(request, faults)
        if request.path.startswith(POLYHAVEN_STORAGE_PATH):
            return self._polyhaven.answer_storage(request, faults)
        return self._panoramax.answer_storage(request, faults)


def _with_etag(reply: Reply, request: Request) -> Reply:
    """Pictures carry an ETag; who has that version already gets a 304 without a body."""
    if reply.status != 200 or not reply.content_type.startswith("image/"):
        return reply
    etag = f'"{hashlib.sha256(reply.body).hexdigest()[:16]}"'
    headers = {**reply.headers, "ETag": etag}
    if request.headers.get("if-none-match") == etag:
        return Reply(status=304, content_type=reply.content_type, headers=headers)
    return replace(reply, headers=headers)


def _listen(port_name: Port, answer: Any, port: int) -> ThreadingHTTPServer:
    class Handler(_Handler):
        pass

    Handler.port_name, Handler.answer = port_name, staticmethod(answer)
    try:
        return ThreadingHTTPServer(("127.0.0.1", port), Handler)
    except OSError as error:
        why = "is in use" if error.errno == errno.EADDRINUSE else f"is denied ({error.strerror})"
        raise UsageError(
            f"Port {port} of 127.0.0.1 {why}. Choose another one with --port, "
            "or --port 0 for any that is free."
        ) from error


class _Handler(BaseHTTPRequestHandler):
    """Turns sockets into `Request` and `Reply`, and nothing else."""

    protocol_version = "HTTP/1.1"
    # Headers and body go out as two writes; with Nagle's algorithm each reply waits 40 ms.
    disable_nagle_algorithm = True
    timeout = 60
    port_name: Port
    answer: Any

    def do_GET(self) -> None:
        self._respond()

    def do_POST(self) -> None:
        self._respond()

    def _respond(self) -> None:
        parts = urlsplit(self.path)
        length = int(self.headers.get("Content-Length") or 0)
        request = Request(
            port=self.port_name,
            method=self.command,
            path=unquote(parts.path),
            query=dict(parse_qsl(parts.query)),
            headers={name.lower(): value for name, value in self.headers.items()},
            body=self.rfile.read(length),
            target=self.path,
        )
        self._send(self.answer(request))

    def _send(self, reply: Reply) -> None:
        if reply.reset:
            self._cut()
            return
        self.send_response(reply.status)
        self.send_header("Content-Type", reply.content_type)
        self.send_header("Content-Length", str(len(reply.body)))
        for name, value in reply.headers.items():
            self.send_header(name, value)
        if reply.truncate:
            self.send_header("Connection", "close")
            self.close_connection = True
        self.end_headers()
        body = reply.body[: len(reply.body) // 2] if reply.truncate else reply.body
        try:
            self._write(body, reply.seconds)
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True

    def _write(self, body: bytes, seconds: float) -> None:
        if not seconds:
            self.wfile.write(body)
            return
        step = -(-len(body) // _TRICKLES) or 1
        for start in range(0, len(body), step):
            self.wfile.write(body[start : start + step])
            time.sleep(seconds / _TRICKLES)

    def _cut(self) -> None:
        # Closing without lingering sends a reset, not an end; the file objects of the handler
        # would hold a socket that is closed by its own method.
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        socket.close(self.connection.detach())
        self.close_connection = True

    def log_message(self, format: str, *args: Any) -> None:
        _log.debug(format, *args)
