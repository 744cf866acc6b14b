"""A server that answers from a script, over real sockets."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from panokit.http import Policy


@dataclass
class Answer:
    """One scripted reply; `promise` is the Content-Length if it is to be a lie."""

    status: int = 200
    body: bytes = b"{}"
    headers: dict[str, str] = field(default_factory=dict)
    content_type: str = "application/json"
    promise: int | None = None


class ScriptedServer:
    """Gives the answers in turn, the last one for ever, and keeps what it was asked."""

    def __init__(self) -> None:
        self.answers: list[Answer] = []
        self.paths: list[str] = []
        self.headers: list[dict[str, str]] = []
        self._lock = threading.Lock()
        self._listener = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self.url = f"http://127.0.0.1:{self._listener.server_address[1]}"
        threading.Thread(target=self._listener.serve_forever, args=(0.02,), daemon=True).start()

    def close(self) -> None:
        self._listener.shutdown()
        self._listener.server_close()

    def _next(self, path: str, headers: dict[str, str]) -> Answer:
        with self._lock:
            self.paths.append(path)
            self.headers.append(headers)
            return self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self) -> None:
                self.rfile.read(int(self.headers.get("Content-Length") or 0))
                answer = server._next(self.path, dict(self.headers.items()))
                self.send_response(answer.status)
                self.send_header("Content-Type", answer.content_type)
                promised = len(answer.body) if answer.promise is None else answer.promise
                self.send_header("Content-Length", str(promised))
                for name, value in answer.headers.items():
                    self.send_header(name, value)
                self.end_headers()
                self.wfile.write(answer.body)
                self.close_connection = answer.promise is not None

            def do_POST(self) -> None:
                self.do_GET()

            def log_message(self, *_: object) -> None:
                """Quiet."""

        return Handler


@pytest.fixture
def new_server() -> Iterator[Callable[[], ScriptedServer]]:
    servers: list[ScriptedServer] = []

    def start() -> ScriptedServer:
        servers.append(ScriptedServer())
        return servers[-1]

    yield start
    for server in servers:
        server.close()


@pytest.fixture
def server(new_server: Callable[[], ScriptedServer]) -> ScriptedServer:
    return new_server()


@pytest.fixture
def quick() -> Policy:
    """The usual patience, in milliseconds."""
    return Policy(first_delay_s=0.01, max_delay_s=5.0, rate_per_s=1000, burst=100, attempts=4)
