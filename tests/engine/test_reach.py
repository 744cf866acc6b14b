import socket
import threading
import time

import pytest

from panokit.engine.reach import knock
from panokit.errors import NetworkError


@pytest.fixture
def port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def test_who_listens_is_found_and_who_does_not_is_waited_for(port):
    started = time.monotonic()
    with pytest.raises(NetworkError, match=rf"no Dask scheduler at tcp://127.0.0.1:{port}"):
        knock(f"tcp://127.0.0.1:{port}", 1.0)
    assert time.monotonic() - started >= 0.5
    with pytest.raises(NetworkError, match="and its certificates"):
        knock(f"tls://127.0.0.1:{port}", 0.1)
    with socket.create_server(("127.0.0.1", port)):
        knock(f"tcp://127.0.0.1:{port}", 5.0)


def test_a_scheduler_that_comes_a_little_later_is_found(port):
    servers = []
    late = threading.Timer(0.8, lambda: servers.append(socket.create_server(("127.0.0.1", port))))
    late.start()
    try:
        knock(f"tcp://127.0.0.1:{port}", 20.0)
    finally:
        late.join()
        for server in servers:
            server.close()
