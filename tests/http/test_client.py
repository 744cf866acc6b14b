"""The client against a real server: what it retries, what it gives up, what it spends."""

import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime

import pytest

from panokit.errors import (
    AuthError,
    ItemError,
    NetworkError,
    OutageError,
    QuotaError,
    UsageError,
)
from panokit.http import Budget, Client, Policy, Reply, Request
from panokit.http.client import _body_failure
from panokit.http.redact import Redactor
from panokit.http.transport import Transport
from panokit.synthetic import StreetServer, embedded_city, parse_faults
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
    assert 1.0 <= time.monotonic() - start_s < 20


def test_the_wait_may_be_given_as_a_date(server, quick):
    server.answers = [Answer(status=429, headers={"Retry-After": in_one_second()}), GOOD]
    start_s = time.monotonic()
    ask(server, quick)
    # Rounded to whole seconds by both dates: anything up to one second is right.
    assert time.monotonic() - start_s < 20
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
        (Answer(status=403), ItemError, "forbidden"),
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


def test_a_403_to_who_sent_a_key_is_about_the_key(server, quick):
    server.answers = [Answer(status=403)]
    for credentials in ({"secrets": {"key": "abc"}}, {"authorization": "OAuth abc"}):
        with pytest.raises(AuthError, match="Check the API key"):
            ask(server, quick, **credentials)


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


@pytest.mark.parametrize(
    ("faults", "reason"),
    [
        ("slow 100% seconds=60", "slow"),
        ("truncated 100%", "truncated"),
        ("reset 100%", "reset"),
        ("empty 100%", "wrong-body"),
    ],
)
def test_each_kind_of_breaking_off_has_its_reason(faults, reason, quick):
    faults = parse_faults(faults)
    with StreetServer(embedded_city(), faults=faults) as street:
        transport = Transport(replace(quick, total_timeout_s=0.5), Redactor(), "test")
        start_s = time.monotonic()
        outcome = transport.exchange(Request(url=f"{street.url}/api/configuration"))
        if isinstance(outcome, Reply):
            outcome = _body_failure(Request(url=""), outcome.headers, outcome.body)
    assert outcome.reason == reason
    assert time.monotonic() - start_s < 10, "a trickle got past the deadline"


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


PAGE = Answer(body=b"<!DOCTYPE html><html>Sign in</html>", content_type="text/html")


def test_one_web_page_is_a_hiccup_and_several_are_an_outage(server, quick):
    server.answers = [PAGE, GOOD]
    ask(server, quick)
    server.answers = [PAGE]
    impatient = replace(quick, pages_in_a_row=3, outage_pauses_s=(0.2, 0.3), attempts=50)
    start_s = time.monotonic()
    with pytest.raises(OutageError, match="in a browser"):
        ask(server, impatient)
    assert time.monotonic() - start_s >= 0.5
    assert len(server.paths) == 2 + 3 * 3


def test_an_outage_is_waited_for_and_its_attempts_do_not_count(server, quick):
    server.answers = [*[Answer(status=503)] * 7, GOOD]
    patient = replace(quick, failures_in_a_row=3, outage_pauses_s=(0.05,) * 10, attempts=4)
    assert ask(server, patient).json() == {"ok": True}
    assert len(server.paths) == 8


def test_who_is_given_up_is_asked_no_more(server, quick):
    server.answers = [Answer(status=500)]
    policy = replace(quick, failures_in_a_row=2, outage_pauses_s=())
    with Client(policy) as client:
        for _ in range(3):
            with pytest.raises(OutageError, match="run again later"):
                client.send(Request(url=server.url))
    assert len(server.paths) == 2


def test_a_days_quota_ends_the_run_at_once(server, quick):
    body = GOOGLE_429.replace(b"Quota exceeded.", b"Quota exceeded for tiles per day.")
    server.answers = [Answer(status=429, body=body.replace(b"retryDelay", b"other")), GOOD]
    with pytest.raises(QuotaError, match="per day"):
        ask(server, quick)
    assert len(server.paths) == 1


def test_too_many_requests_for_minutes_are_a_quota_that_is_used_up(server, quick):
    server.answers = [Answer(status=429, headers={"Retry-After": "1"})]
    with pytest.raises(QuotaError):
        ask(server, replace(quick, quota_patience_s=1.5, attempts=50))
    assert len(server.paths) == 3


def test_a_delay_of_nothing_is_not_believed_for_ever(server, quick):
    server.answers = [Answer(status=429, headers={"Retry-After": "0"})]
    start_s = time.monotonic()
    with pytest.raises(QuotaError):
        ask(server, replace(quick, first_delay_s=0.01, attempts=6))
    # Three at once, then two waits of at least 0.01 x 4 x 2^3 x 0.75 and twice that.
    assert time.monotonic() - start_s >= 0.7


def test_long_waits_are_told(server, quick, caplog):
    with Client(quick) as client:
        client._limiter.pause = lambda *_: None
        client._pause("a.example", 41.0, "asks to wait")
        client._pause("a.example", 0.2, "asks to wait")
    (told,) = [record for record in caplog.records if record.levelname == "WARNING"]
    assert told.getMessage() == "a.example asks to wait: waiting for 41 s"


def test_what_servers_say_is_kept_without_the_key(server, quick):
    server.answers = [GOOD]
    with Client(quick) as client:
        client.send(Request(url=server.url, secrets={"key": "a+secret"}))
        echoed = {"link": ["https://a.example/?key=a%2Bsecret", 1], "a+secret": None}
        assert client.redact_json(echoed) == {
            "link": ["https://a.example/?key=***", 1],
            "***": None,
        }
