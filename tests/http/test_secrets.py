"""Keys reach the server they are meant for, and nobody else."""

import logging
import traceback

import pytest

from panokit.errors import PanokitError, UsageError
from panokit.http import Client, Request
from panokit.http.redact import Redactor
from tests.http.conftest import Answer

KEY = "AIza-s3cret+key/with=signs"


def failing_request(server, quick, answer):
    server.answers = [answer]
    with Client(quick) as client, pytest.raises(PanokitError) as caught:
        client.send(Request(url=server.url + "/tiles", secrets={"key": KEY}))
    return caught.value


@pytest.mark.parametrize(
    "answer",
    [
        Answer(status=403, body=b'{"message": "key AIza-s3cret+key/with=signs is blocked"}'),
        Answer(status=404, body=b'{"message": "/tiles?key=AIza-s3cret%2Bkey%2Fwith%3Dsigns"}'),
        Answer(status=500),
        Answer(body=b"{", promise=40),
    ],
    ids=["echoed", "echoed in an address", "500", "truncated"],
)
def test_a_key_is_in_no_error_and_no_log(server, quick, answer, caplog):
    with caplog.at_level(logging.DEBUG):
        error = failing_request(server, quick, answer)
    assert "key=" in server.paths[0]
    told = "".join(traceback.format_exception(error)) + caplog.text + repr(error.__context__)
    assert server.paths[0] not in told
    for form in (KEY, "AIza-s3cret"):
        assert form not in told


def test_a_key_is_in_no_error_when_nobody_answers(quick, caplog):
    caplog.set_level(logging.DEBUG)
    with Client(quick) as client, pytest.raises(PanokitError) as caught:
        client.send(Request(url="http://127.0.0.1:9/x", secrets={"key": KEY}))
    assert "AIza" not in "".join(traceback.format_exception(caught.value)) + caplog.text
    assert caught.value.__context__ is None


def test_a_request_does_not_show_its_secrets():
    assert KEY not in repr(Request(url="https://example.org", secrets={"key": KEY}))


def test_redirects_to_another_origin_carry_no_credential(server, new_server, quick):
    other = new_server()
    other.answers = [Answer(body=b'{"ok": 1}')]
    location = f"{other.url}/stored?key=abc123456&size=3"
    server.answers = [
        Answer(status=302, headers={"Location": location, "Set-Cookie": "session=abc123456"})
    ]
    with Client(quick) as client:
        client.send(Request(url=server.url + "/hd.jpg", secrets={"key": "abc123456"}))
    assert other.paths == ["/stored?size=3"]
    assert not {"Authorization", "Cookie"} & set(other.headers[0])


def test_a_signed_address_arrives_as_it_was_written(server, new_server, quick):
    other = new_server()
    other.answers = [Answer()]
    server.answers = [
        Answer(status=302, headers={"Location": f"{other.url}/a%2Fb?Signature=x%2By&e=~"})
    ]
    with Client(quick) as client:
        client.send(Request(url=server.url + "/hd.jpg"))
    assert other.paths == ["/a%2Fb?Signature=x%2By&e=~"]


def test_redirects_in_circles_end(server, quick):
    server.answers = [Answer(status=302, headers={"Location": "/again"})]
    with Client(quick) as client, pytest.raises(PanokitError, match="in circles"):
        client.send(Request(url=server.url))
    assert len(server.paths) < 10


def test_a_key_does_not_travel_unencrypted(quick):
    with Client(quick) as client, pytest.raises(UsageError, match="unencrypted"):
        client.send(Request(url="http://tiles.example.org/x", secrets={"key": KEY}))


@pytest.mark.parametrize(
    "text",
    [
        "https://a.org/x?panoId=1&key=AIzaSy123&z=3",
        "session=IgAAAHwLCd&z=1",
        "https://a.org/?signature=chaRF2hT==",
        "access_token=MLY|1234|abcd",
        "Authorization: OAuth MLY|1234|abcd",
    ],
)
def test_what_looks_like_a_credential_is_hidden(text):
    hidden = Redactor().redact(text)
    for secret in ("AIzaSy123", "IgAAAHwLCd", "chaRF2hT", "abcd"):
        assert secret not in hidden
    assert "***" in hidden


def test_the_urllib3_log_is_left_as_it_was(quick):
    logger = logging.getLogger("urllib3.connectionpool")
    before = list(logger.filters)
    with Client(quick):
        assert len(logger.filters) == len(before) + 1
    assert logger.filters == before


def test_an_authorization_header_stays_with_its_origin(server, new_server, quick, caplog):
    other = new_server()
    other.answers = [Answer(status=404)]
    server.answers = [
        Answer(status=302, headers={"Location": "/again"}),
        Answer(status=302, headers={"Location": f"{other.url}/stored"}),
    ]
    caplog.set_level(logging.DEBUG)
    request = Request(url=server.url, authorization="OAuth MLY|123|s3cret")
    with Client(quick) as client, pytest.raises(PanokitError) as caught:
        client.send(request)
    assert [one.get("Authorization") for one in server.headers] == ["OAuth MLY|123|s3cret"] * 2
    assert "Authorization" not in other.headers[0]
    told = repr(request) + caplog.text + "".join(traceback.format_exception(caught.value))
    assert "s3cret" not in told
    with pytest.raises(UsageError, match="unencrypted"):
        Client(quick).send(Request(url="http://a.example", authorization="OAuth x"))
