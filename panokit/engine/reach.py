"""Whether a scheduler can be reached, found out with nothing but a socket."""

import socket
import time
from urllib.parse import urlsplit

from panokit.errors import NetworkError

_PAUSE_S = 0.5


def knock(address: str, patience_s: float) -> None:
    """Find out whether anything listens at a scheduler's address.

    Args:
        address: "tcp://HOST:PORT" or "tls://HOST:PORT", as `check_engine_name` lets it pass.
        patience_s: How long to wait for it.

    Raises:
        NetworkError: If nothing does.
    """
    parts = urlsplit(address)
    deadline = time.monotonic() + patience_s
    while True:
        left_s = max(deadline - time.monotonic(), _PAUSE_S)
        try:
            socket.create_connection((parts.hostname, parts.port), timeout=left_s).close()
        except OSError as error:
            if time.monotonic() + _PAUSE_S > deadline:
                raise no_scheduler(address, patience_s) from error
            time.sleep(_PAUSE_S)
        else:
            return


def no_scheduler(address: str, waited_s: float) -> NetworkError:
    """The error for a scheduler that is not there."""
    hint = " and its certificates" if address.startswith("tls:") else ", or its tls:// address"
    return NetworkError(
        f"There is no Dask scheduler at {address} (waited {waited_s:g} s). Start one there with "
        f"`dask scheduler`, or check the address{hint}; --engine local needs none."
    )
