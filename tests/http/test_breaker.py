"""When a service counts as down, in a clock of its own."""

import pytest

from panokit.errors import OutageError
from panokit.http.breaker import Breaker
from panokit.http.failures import WEB_PAGE, Failure, FailureKind
from panokit.http.policy import Policy


def failure(kind=FailureKind.TRANSIENT, reason="http-500"):
    return Failure(kind=kind, message="HTTP 500", reason=reason)


@pytest.fixture
def now():
    return [100.0]


@pytest.fixture
def breaker(now):
    policy = Policy(failures_in_a_row=10, pages_in_a_row=3, outage_pauses_s=(30.0, 120.0))
    return Breaker(policy, lambda: now[0])


def pauses(breaker, now, count, **kind):
    return [breaker.failed("a", failure(**kind), now[0]) for _ in range(count)]


def test_many_failures_in_a_row_make_a_pause(breaker, now):
    assert pauses(breaker, now, 10) == [None] * 9 + [30.0]


def test_one_success_in_between_makes_none(breaker, now):
    pauses(breaker, now, 9)
    breaker.succeeded("a")
    assert pauses(breaker, now, 9) == [None] * 9


def test_hosts_are_judged_apart(breaker, now):
    pauses(breaker, now, 9)
    assert breaker.failed("b", failure(), now[0]) is None


def test_web_pages_weigh_more(breaker, now):
    assert pauses(breaker, now, 3, reason=WEB_PAGE) == [None, None, 30.0]


@pytest.mark.parametrize("kind", [FailureKind.QUOTA, FailureKind.PERMANENT, FailureKind.AUTH])
def test_other_failures_are_no_outage(breaker, now, kind):
    assert pauses(breaker, now, 20, kind=kind) == [None] * 20


def test_what_was_under_way_at_the_pause_does_not_count(breaker, now):
    pauses(breaker, now, 9)
    began_s = now[0]
    now[0] += 1
    assert pauses(breaker, now, 1) == [30.0]
    assert [breaker.failed("a", failure(), began_s) for _ in range(8)] == [None] * 8


def test_after_the_last_pause_the_host_is_given_up(breaker, now):
    pauses(breaker, now, 10)
    now[0] += 31
    assert pauses(breaker, now, 2) == [None, 120.0]
    now[0] += 121
    breaker.check("a")
    assert pauses(breaker, now, 1) == [None]
    with pytest.raises(OutageError, match="pauses of 150 s"):
        pauses(breaker, now, 1)
    with pytest.raises(OutageError, match="HTTP 500"):
        breaker.check("a")
    breaker.check("b")
