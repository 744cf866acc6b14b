"""The running server: it answers its own pages, refuses the others, and asks nothing of anybody."""

import re
import socket
import subprocess
import sys
import urllib.error
import urllib.request
from contextlib import closing

import pytest

from panokit.app.server import listen
from panokit.app.settings import HOST
from panokit.cli.main import main

nicegui = pytest.importorskip("nicegui", reason="needs the app extra")


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("server")
    run = subprocess.Popen(
        [sys.executable, "-m", "panokit", "app", "--no-show", "--port", "18710",
         "--largest-picture-mb", "1"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder,
    )  # fmt: skip
    try:
        said = run.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/", said)
        assert found, said + run.stdout.read()
        yield int(found[1])
    finally:
        run.terminate()
        run.communicate(timeout=60)
    assert not list(folder.iterdir())


def fetch(port, path="/", headers=None, data=None, method=None):
    request = urllib.request.Request(
        f"http://127.0.0.1:{port}{path}", data=data, headers=headers or {}, method=method
    )
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.status, answer.read().decode(), answer.headers
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode(), error.headers


def handshake(port, origin):
    """The status that a WebSocket gets."""
    lines = [
        "GET /_nicegui_ws/socket.io/?EIO=4&transport=websocket HTTP/1.1",
        f"Host: 127.0.0.1:{port}", f"Origin: {origin}", "Connection: Upgrade",
        "Upgrade: websocket", "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==", "", "",
    ]  # fmt: skip
    with closing(socket.create_connection((HOST, port), timeout=60)) as wire:
        wire.sendall("\r\n".join(lines).encode())
        return int(wire.recv(64).split()[1])


def token_of(page):
    return re.search(r"/desk/([\w-]{20,})/upload", page)[1]


def test_foreign_hosts_and_origins_get_403(server):
    assert fetch(server)[0] == 200
    assert fetch(server, headers={"Host": f"localhost:{server}"})[0] == 200
    assert fetch(server, headers={"Host": "evil.example"})[0] == 403
    assert fetch(server, headers={"Host": f"evil.example:{server}"})[0] == 403
    assert fetch(server, headers={"Origin": "http://evil.example"})[0] == 403
    assert fetch(server, headers={"Origin": "null"})[0] == 403


def test_foreign_websockets_get_403(server):
    assert handshake(server, f"http://127.0.0.1:{server}") == 101
    assert handshake(server, "http://evil.example") == 403


@pytest.mark.parametrize("path", ["/", "/lighting", "/expand", "/probes"])
def test_pages_name_nothing_outside_this_machine(server, path):
    status, page, headers = fetch(server, path)
    assert status == 200
    # Names of XML's vocabularies are no addresses that anything is asked of.
    named = set(re.findall(r"https?://[\w.-]+", page)) - {"http://www.w3.org", "https://www.w3.org"}
    assert not named
    assert "default-src 'self'" in headers["content-security-policy"]


def test_a_proxy_that_is_not_there_writes_nothing_into_pages(server):
    assert "evil" not in fetch(server, headers={"X-Forwarded-Prefix": "/evil"})[1]


@pytest.mark.parametrize(
    "path", ["/docs", "/redoc", "/openapi.json", "/etc/passwd", "/..%2f..%2fetc/passwd"]
)
def test_nothing_else_is_served(server, path):
    assert fetch(server, path)[0] in (403, 404)


def test_uploads_stay_in_their_folder_and_under_their_limit(server):
    address = f"/desk/{token_of(fetch(server, '/expand')[1])}/upload/picture"
    status, said, _ = fetch(server, f"{address}?name=..%2F..%2Fa.jpg", data=b"x", method="PUT")
    assert (status, said) == (200, '{"file":"alone/a.jpg"}')
    for name, data, told in (
        ("evil.sh", b"x", "cannot be used"),
        ("large.jpg", bytes(1_000_001), "larger than 1 MB"),
        ("empty.jpg", b"", "empty"),
    ):
        status, said, _ = fetch(server, f"{address}?name={name}", data=data, method="PUT")
        assert status == 400
        assert told in said


def test_a_tab_that_is_not_there_takes_and_gives_nothing(server):
    for path in ("/desk/none/upload/picture?name=a.jpg", "/desk/none/upload/secrets?name=a.jpg"):
        assert fetch(server, path, data=b"x", method="PUT")[0] == 404
    assert fetch(server, "/desk/none/thing/x")[0] == 404
    token = token_of(fetch(server, "/expand")[1])
    for path in (
        "thing/x",
        "picture/film1/0",
        "picture/preview/..%2f..",
        "thing/..%2f..%2fetc%2fpasswd",
    ):
        assert fetch(server, f"/desk/{token}/{path}")[0] == 404


def test_two_tabs_have_two_desks(server):
    assert token_of(fetch(server, "/expand")[1]) != token_of(fetch(server, "/expand")[1])


def test_a_method_that_is_not_there_is_refused_at_the_start(capsys):
    assert main(["app", "--no-show", "--port", "18770", "--model", "expand-99"]) == 2
    assert (
        "There is no method 'expand-99' to expand with. Choose from: expand-2"
        in capsys.readouterr().err
    )


def test_the_next_port_is_taken_where_one_is_in_use():
    with closing(listen(18760)) as first:
        first.listen()
        with closing(listen(first.getsockname()[1])) as second:
            assert second.getsockname()[0] == HOST
            assert second.getsockname()[1] == first.getsockname()[1] + 1
