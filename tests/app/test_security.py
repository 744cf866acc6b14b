"""Who may talk to the application: pages of its own, on this machine, and nobody else."""

import asyncio

import pytest

from panokit.app.security import Guard, own_hosts, refusal

PORT = 8710
OWN = (b"host", b"127.0.0.1:8710")


def ask(headers, kind="http", inner=None):
    """What a guarded server answers: the messages, and what reached the server behind."""
    sent, reached = [], []

    async def server(scope, receive, send):
        reached.append(scope)
        headers = inner or []
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": b"page"})

    async def receive():
        return {"type": "websocket.connect"}

    async def send(message):
        sent.append(message)

    asyncio.run(Guard(server, PORT)({"type": kind, "headers": headers}, receive, send))
    return sent, reached


@pytest.mark.parametrize("host", ["127.0.0.1:8710", "localhost:8710", "[::1]:8710"])
def test_its_own_names_are_answered(host):
    assert refusal([(b"host", host.encode())], PORT) is None


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "evil.example:8710",
        "127.0.0.1",
        "127.0.0.1:80",
        "127.0.0.1.evil.example:8710",
        "localhost:8711",
        "",
        "127.0.0.1:8710@evil.example",
        "0.0.0.0:8710",
        "192.168.1.7:8710",
    ],
)
def test_foreign_hosts_are_refused(host):
    assert refusal([(b"host", host.encode())], PORT)


def test_no_host_and_two_hosts_are_refused():
    assert refusal([], PORT)
    assert refusal([OWN, (b"host", b"evil.example")], PORT)
    assert refusal([OWN, OWN], PORT)


@pytest.mark.parametrize("origin", ["http://127.0.0.1:8710", "http://localhost:8710"])
def test_its_own_pages_may_ask(origin):
    assert refusal([OWN, (b"origin", origin.encode())], PORT) is None


@pytest.mark.parametrize(
    "origin",
    ["http://evil.example", "null", "https://127.0.0.1:8710", "http://127.0.0.1:8711",
     "http://127.0.0.1", "http://127.0.0.1:8710.evil.example", "file://"],
)  # fmt: skip
def test_foreign_pages_are_refused(origin):
    assert refusal([OWN, (b"origin", origin.encode())], PORT)
    assert refusal([OWN, (b"origin", b"http://localhost:8710"), (b"Origin", origin.encode())], PORT)


def test_what_a_foreign_page_embeds_is_refused_but_a_link_may_be_followed():
    embedded = [OWN, (b"sec-fetch-site", b"cross-site"), (b"sec-fetch-mode", b"no-cors")]
    followed = [OWN, (b"sec-fetch-site", b"cross-site"), (b"sec-fetch-mode", b"navigate")]
    assert refusal(embedded, PORT)
    assert refusal(followed, PORT) is None
    assert refusal([OWN, (b"sec-fetch-site", b"same-origin")], PORT) is None


def test_a_refused_request_gets_403_and_goes_no_further():
    sent, reached = ask([(b"host", b"evil.example")])
    assert sent[0]["status"] == 403
    assert b"127.0.0.1" in sent[1]["body"]
    assert not reached


def test_a_refused_websocket_is_closed_before_it_is_accepted():
    sent, reached = ask([OWN, (b"origin", b"http://evil.example")], kind="websocket")
    assert [message["type"] for message in sent] == ["websocket.close"]
    assert not reached


def test_what_is_sent_may_load_nothing_from_elsewhere():
    sent, _ = ask([OWN])
    headers = dict(sent[0]["headers"])
    policy = headers[b"content-security-policy"].decode()
    assert "default-src 'self'" in policy
    assert "frame-ancestors 'self'" in policy
    assert "https:" not in policy
    assert "*" not in policy
    assert headers[b"x-content-type-options"] == b"nosniff"


def test_a_stricter_policy_is_kept():
    sent, _ = ask([OWN], inner=[(b"content-security-policy", b"default-src 'none'")])
    policies = [value for name, value in sent[0]["headers"] if name == b"content-security-policy"]
    assert policies == [b"default-src 'none'"]


def test_what_a_proxy_would_say_is_dropped():
    _, reached = ask([OWN, (b"x-forwarded-prefix", b"/evil"), (b"accept", b"*/*")])
    assert [name for name, _ in reached[0]["headers"]] == [b"host", b"accept"]


def test_starting_up_is_not_asked_for_its_host():
    _, reached = ask([], kind="lifespan")
    assert reached


def test_the_port_is_part_of_a_host():
    assert own_hosts(1) != own_hosts(2)
