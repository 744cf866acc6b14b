"""The client against a real server: what it retries, what it gives up, what it spends."""

import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime

import pytest

from panokit.errors import AuthError, ItemError, NetworkError, QuotaError, UsageError
from panokit.http import Budget, Client, Policy, Request
from tests.http.conftest import Answer

GOOD = Answer(body=b'{"ok": true}')
GOOGLE_429 = (
    b'{"error": {"code": 429, "message": "Quota exceeded.", "status": "RESOURCE_EXHAUSTED",'
    b'"details": [{"@type": "type.googleapis.com/google.rpc.RetryInfo", "retryDelay": "1s"}]}}'
)


def in_one_second() -> str:
    # HTTP dates have whole seconds; the server's own Date is given along with it.
    return format_datetime(datetime.now(UTC) + timedelta(seconds=1), usegmt=True)


def ask(server, policy, **request):
    with Client(policy, budget=request.pop("budget", None)) as client:
        return client.send(Request(url=server.url + "/thing", **request))


def test_a_good_answer_costs_one_request(server, quick):
    server.answers = [GOOD]
    assert ask(server, quick).json() == {"ok": True}
    assert len(server.paths) == 1


@pytest.mark.parametrize(
    "trouble",
    [
        Answer(status=500, body=b"oops"),
        Answer(status=503),
        Answer(body=b"<html>Are you a robot?</html>", content_type="text/html"),
        Answer(body=b'{"ok"', promise=12),
        Answer(status=429, headers={"Retry-After": "0"}),
    ],
    ids=["500", "503", "html with 200", "truncated", "429"],
)
def test_passing_troubles_are_retried(server, quick, trouble):
    server.answers = [trouble, trouble, GOOD]
    assert ask(server, quick).json() == {"ok": True}
    assert len(server.paths) == 3


@pytest.mark.parametrize(
    "busy",
    [
        Answer(status=429, headers={"Retry-After": "1"}),
        Answer(status=503, headers={"Retry-After": "1"}),
        Answer(status=429, body=GOOGLE_429),
    ],
    ids=["seconds", "seconds with 503", "google body"],
)
def test_the_wait_that_a_server_asks_for_is_kept(server, quick, busy):
    server.answers = [busy, GOOD]
    start_s = time.monotonic()
    ask(server, quick)
    assert 1.0 <= time.monotonic() - start_s < 3.0


def test_the_wait_may_be_given_as_a_date(server, quick):
    server.answers = [Answer(status=429, headers={"Retry-After": in_one_second()}), GOOD]
    start_s = time.monotonic()
    ask(server, quick)
    # Rounded to whole seconds by both dates: anything up to one second is right.
    assert time.monotonic() - start_s < 2.5
    assert len(server.paths) == 2


def test_a_server_that_asks_for_hours_ends_the_run(server, quick):
    server.answers = [Answer(status=429, headers={"Retry-After": "21600"}), GOOD]
    with pytest.raises(QuotaError, match="run again later"):
        ask(server, quick)
    assert len(server.paths) == 1


def test_a_pause_holds_every_request_to_the_host(server, quick):
    server.answers = [Answer(status=429, headers={"Retry-After": "1"}), GOOD]
    with Client(quick) as client:
        client.send(Request(url=server.url + "/first"))
        client._limiter.pause(server.url.removeprefix("http://"), 0.4)
        start_s = time.monotonic()
        client.send(Request(url=server.url + "/second"))
    assert time.monotonic() - start_s >= 0.4


def test_lasting_troubles_end_in_the_error_of_their_class(server, quick):
    server.answers = [Answer(status=500)]
    with pytest.raises(NetworkError, match="after 4 attempts"):
        ask(server, quick)
    server.answers = [Answer(status=429, body=GOOGLE_429.replace(b'"1s"', b'"0s"'))]
    with pytest.raises(QuotaError, match="Quota exceeded"):
        ask(server, quick)
    assert len(server.paths) == 8


@pytest.mark.parametrize(
    ("answer", "error", "reason"),
    [
        (Answer(status=404, body=b'{"message": "No such item"}'), ItemError, "not-found"),
        (Answer(status=410), ItemError, "gone"),
        (Answer(status=400, body=b'{"message": "bad bbox"}'), ItemError, "bad-request"),
        (Answer(status=401), AuthError, None),
        (Answer(status=403), AuthError, None),
        (
            Answer(
                status=400,
                body=b'{"error": {"message": "API key not valid.", "details":'
                b' [{"reason": "API_KEY_INVALID"}]}}',
            ),
            AuthError,
            None,
        ),
    ],
)
def test_verdicts_are_not_retried(server, quick, answer, error, reason):
    server.answers = [answer]
    with pytest.raises(error) as caught:
        ask(server, quick)
    assert getattr(caught.value, "reason", None) == reason
    assert len(server.paths) == 1


def test_a_body_that_never_passes_its_check_raises_the_verdict_of_the_check(server, quick):
    def refuse(_: bytes) -> None:
        raise ItemError("It is half a picture.", reason="truncated")

    server.answers = [Answer(body=b"\xff\xd8", content_type="image/jpeg")]
    with pytest.raises(ItemError, match="half a picture"):
        ask(server, quick, expect="image", check=refuse)
    assert len(server.paths) == quick.attempts


def test_a_body_that_is_text_is_no_picture(server, quick):
    server.answers = [Answer(body=b"{}"), Answer(body=b"\xff\xd8..", content_type="image/jpeg")]
    assert ask(server, quick, expect="image").body == b"\xff\xd8.."


def test_nobody_there(quick):
    with Client(quick) as client, pytest.raises(NetworkError, match="no connection"):
        client.send(Request(url="http://127.0.0.1:9/thing"))


def test_who_never_answered_is_given_up_soon_and_who_did_is_not(new_server, quick):
    with Client(replace(quick, attempts=6)) as client:
        with pytest.raises(NetworkError, match="after 3 attempts"):
            client.send(Request(url="http://127.0.0.1:9/thing"))
        server = new_server()
        server.answers = [Answer(headers={"Connection": "close"})]
        client.send(Request(url=server.url))
        server.close()
        with pytest.raises(NetworkError, match="after 6 attempts"):
            client.send(Request(url=server.url))


def test_a_slow_server_is_a_passing_trouble(new_server):
    server = new_server()
    server.answers = [Answer(body=b"{", promise=50), GOOD]
    policy = Policy(read_timeout_s=0.2, first_delay_s=0.01)
    with Client(policy) as client:
        assert client.send(Request(url=server.url)).json() == {"ok": True}


def test_what_is_no_address_is_a_usage_error(quick):
    with Client(quick) as client, pytest.raises(UsageError, match="not a web address"):
        client.send(Request(url="example.org/api"))


def test_every_attempt_counts_against_the_budget(server, quick):
    budget = Budget(max_requests=2)
    server.answers = [Answer(status=500)]
    with pytest.raises(QuotaError, match="2 requests"):
        ask(server, quick, budget=budget)
    assert (budget.requests, len(server.paths)) == (2, 2)


def test_money_is_a_budget_too(server, quick):
    budget = Budget(max_cost_usd=0.004)
    server.answers = [GOOD]
    with Client(quick, budget=budget) as client:
        request = Request(url=server.url, cost_usd=0.002)
        client.send(request)
        client.send(request)
        with pytest.raises(QuotaError, match="USD"):
            client.send(request)
    assert budget.cost_usd == pytest.approx(0.004)


def test_a_stopped_client_wakes_up_and_asks_nobody(server, quick):
    server.answers = [GOOD]
    with Client(quick) as client:
        client.stop()
        with pytest.raises(NetworkError, match="stopped"):
            client.send(Request(url=server.url))
    assert server.paths == []
