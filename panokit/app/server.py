"""The application as a server on 127.0.0.1."""

import errno
import os
import socket
import threading
import time
import webbrowser
from collections.abc import Callable
from dataclasses import dataclass

from panokit.app.desks import Desks
from panokit.app.security import Asgi, Guard
from panokit.app.settings import HOST, AppSettings
from panokit.app.work import Work
from panokit.errors import MissingExtraError, StorageError, UsageError

_PORTS_TRIED = 20
# A tab that sleeps for a while comes back to its things.
_RECONNECT_S = 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Application:
    """The server, ready to be run.

    Attributes:
        asgi: The guarded server.
        desks: Its tabs.
        work: Its worker.
    """

    asgi: Asgi
    desks: Desks
    work: Work

    def close(self) -> None:
        """Remove what belongs to tabs, and end the worker."""
        self.work.close()
        self.desks.close_all()


def build(settings: AppSettings, port: int) -> Application:
    """The application for a port; once in a process, since NiceGUI is there once.

    Raises:
        MissingExtraError: If NiceGUI is not installed.
        UsageError: If there is no such expansion method.
    """
    os.environ.setdefault("MATPLOTLIB", "false")  # NiceGUI would import it
    try:
        from fastapi import FastAPI
        from nicegui import ui
    except ImportError as error:
        raise MissingExtraError("nicegui", "app", "The application") from error
    from panokit.app.routes import add_routes
    from panokit.app.shell import add_pages

    _check_model(settings.model)
    desks, work = Desks(settings), Work()
    # Documentation pages of FastAPI would load scripts from elsewhere.
    api = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    add_routes(api, desks, work)
    add_pages(settings, desks, work)
    ui.run_with(
        api,
        title="panokit",
        favicon=_FAVICON,
        dark=None,
        language="en-US",
        tailwind=False,
        reconnect_timeout=_RECONNECT_S,
        show_welcome_message=False,
        binding_refresh_interval=None,
    )
    return Application(asgi=Guard(api, port), desks=desks, work=work)


def serve(settings: AppSettings, say: Callable[[str], None], *, show: bool = True) -> None:
    """Run the application until it is interrupted.

    Args:
        settings: Where it listens, what it takes.
        say: Called with its address once it answers.
        show: Open it in the browser.

    Raises:
        MissingExtraError: If NiceGUI is not installed.
        UsageError: If no port is free, or there is no such expansion method.
    """
    listening = listen(settings.port)
    port = listening.getsockname()[1]
    try:
        application = build(settings, port)
    except BaseException:
        listening.close()
        raise
    import uvicorn

    server = uvicorn.Server(
        uvicorn.Config(
            application.asgi,
            log_level="warning",
            access_log=False,
            # No proxy stands before it, so nobody's word on addresses is taken.
            proxy_headers=False,
            server_header=False,
            timeout_graceful_shutdown=2,
            ws_max_size=4_000_000,
        )
    )
    address = f"http://{HOST}:{port}/"
    threading.Thread(target=_announce, args=(server, address, say, show), daemon=True).start()
    try:
        server.run(sockets=[listening])
    finally:
        application.close()
        listening.close()


def _check_model(model: str) -> None:
    from panokit.app.expanding import expansion_models

    there = expansion_models()
    if model not in there:
        told = ", ".join(there)
        raise UsageError(f"There is no method {model!r} to expand with. Choose from: {told}.")


def listen(port: int) -> socket.socket:
    """A socket on 127.0.0.1 at this port, or at the next that is free.

    Raises:
        UsageError: If none of the next twenty is free.
        StorageError: If this machine lets nobody listen.
    """
    for candidate in range(port, min(port + _PORTS_TRIED, 65536)):
        listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((HOST, candidate))
        except OSError as error:
            listening.close()
            if error.errno in (errno.EADDRINUSE, errno.EACCES):
                continue
            raise StorageError(f"Nothing can listen on {HOST} here ({error.strerror}).") from error
        return listening
    last = min(port + _PORTS_TRIED, 65536) - 1
    raise UsageError(f"The ports {port} to {last} are all in use. Give another: --port N")


def _announce(server: object, address: str, say: Callable[[str], None], show: bool) -> None:
    while not getattr(server, "started", False):
        if getattr(server, "should_exit", False):
            return
        time.sleep(0.05)
    say(address)
    if show:
        webbrowser.open(address)


_FAVICON = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32">'
    '<circle cx="16" cy="16" r="14" fill="#1d5fae"/>'
    '<path d="M3 19c7-5 19-5 26 0a14 14 0 0 1-26 0z" fill="#0d2e57"/>'
    '<circle cx="21" cy="10" r="4" fill="#ffd66b"/></svg>'
)
