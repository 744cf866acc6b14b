"""The token bucket, in a clock of its own."""

import threading
import time

import pytest

from panokit.errors import NetworkError
from panokit.http.limiter import RateLimiter


def turns(limiter: RateLimiter, host: str, count: int) -> list[float]:
    return [limiter._reserve(host) for _ in range(count)]


def test_a_burst_goes_at_once_and_then_the_rate_holds():
    limiter = RateLimiter(10.0, 3, clock=lambda: 100.0)
    waits = [max(turn - 100.0, 0.0) for turn in turns(limiter, "a", 6)]
    assert waits == pytest.approx([0, 0, 0, 0.1, 0.2, 0.3])


def test_hosts_do_not_wait_for_each_other():
    limiter = RateLimiter(1.0, 1, clock=lambda: 0.0)
    turns(limiter, "a", 5)
    assert turns(limiter, "b", 1) == [0.0]


def test_quiet_time_fills_the_bucket_but_no_more_than_full():
    now = [0.0]
    limiter = RateLimiter(10.0, 2, clock=lambda: now[0])
    turns(limiter, "a", 10)
    now[0] = 1000.0
    assert [turn <= 1000.0 for turn in turns(limiter, "a", 3)] == [True, True, False]


def test_many_threads_together_keep_the_rate():
    limiter = RateLimiter(200.0, 1)
    start_s = time.monotonic()
    threads = [
        threading.Thread(target=lambda: [limiter.wait("a") for _ in range(10)]) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert time.monotonic() - start_s >= 39 / 200


def test_a_pause_holds_threads_that_are_waiting_already():
    limiter = RateLimiter(5.0, 1)
    limiter.wait("a")
    threading.Timer(0.05, limiter.pause, ("a", 0.5)).start()
    start_s = time.monotonic()
    limiter.wait("a")
    assert time.monotonic() - start_s >= 0.5


def test_stop_wakes_the_waiting():
    limiter = RateLimiter(0.01, 1)
    limiter.wait("a")
    threading.Timer(0.05, limiter.stop).start()
    with pytest.raises(NetworkError, match="stopped"):
        limiter.wait("a")
