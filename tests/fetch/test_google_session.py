"""Session tokens: made when needed, shared, renewed in time and when refused."""

import json
import threading
import time
from pathlib import Path

import pytest

from panokit.errors import AuthError, ItemError, NetworkError
from panokit.fetch.google_session import GoogleSession, parse_session
from panokit.http import Client, Policy, Request
from panokit.synthetic.faults import Faults
from tests.fetch.conftest import KEY

BODY = (Path(__file__).parent / "data" / "google_session.json").read_bytes()


@pytest.fixture
def client():
    with Client(Policy(rate_per_s=1000, burst=100, first_delay_s=0.01)) as client:
        yield client


def metadata(server) -> Request:
    return Request(url=server.url + "/v1/streetview/metadata", params={"panoId": "pano-3328"})


def sessions_made(server) -> int:
    return sum(request.path == "/v1/createSession" for request in server.requests)


def test_the_expiry_is_a_string():
    assert parse_session(BODY, 1789999000.0) == ("IgAAAHwLCd", 1000.0)


@pytest.mark.parametrize("body", [b"{}", b"[]", b'{"session": "x", "expiry": "soon"}'])
def test_a_reply_without_a_session(body):
    with pytest.raises(NetworkError, match="createSession"):
        parse_session(body, 0.0)


def test_many_threads_share_one_session(server, client):
    session = GoogleSession(server.url, KEY, client)
    threads = [threading.Thread(target=session.send, args=(metadata(server),)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sessions_made(server) == 1


def test_a_session_is_renewed_before_it_ends(server, client):
    now = [time.time()]
    session = GoogleSession(server.url, KEY, client, clock=lambda: now[0])
    session.send(metadata(server))
    now[0] += 14 * 24 * 3600 - 30
    session.send(metadata(server))
    assert sessions_made(server) == 2


def test_a_refused_session_is_renewed_once(server, client):
    server.set_faults(Faults(session_lifetime_s=0.0))
    # The clock stands still, so that only the refusal tells that the session has ended.
    session = GoogleSession(server.url, KEY, client, clock=lambda: 0.0)
    with pytest.raises(ItemError):
        session.send(metadata(server))
    assert sessions_made(server) == 2
    server.set_faults(Faults())
    assert json.loads(session.send(metadata(server)).body)["panoId"] == "pano-3328"
    assert sessions_made(server) == 3


def test_a_wrong_key_and_a_disabled_service(server, client):
    with pytest.raises(AuthError, match="API key not valid"):
        GoogleSession(server.url, "wrong", client).send(metadata(server))
    server.set_faults(Faults(api_disabled=True))
    with pytest.raises(AuthError, match="disabled"):
        GoogleSession(server.url, KEY, client).send(metadata(server))
