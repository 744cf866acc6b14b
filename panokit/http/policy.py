"""How patient and how polite a client is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Policy:
    """How patient and how polite a client is.

    Attributes:
        connect_timeout_s: For a connection to stand.
        read_timeout_s: Between two pieces of a body.
        total_timeout_s: For one whole attempt; a trickle of bytes is no progress.
        attempts: For one request, the first included.
        first_delay_s: Before the second attempt; doubled before each further one.
        max_delay_s: The longest wait before an attempt. A server that asks for more ends the
            run with a `QuotaError`.
        quota_patience_s: A host that says "too many requests" for so long, and nothing else, has
            a quota that is used up for the day.
        failures_in_a_row: So many passing failures of one host, and it is left alone for a while.
        pages_in_a_row: So many web pages in place of data, likewise.
        outage_pauses_s: How long it is left alone, each time; then the run ends.
        rate_per_s: Requests a second and host, in the long run.
        burst: Requests that may go at once after a quiet time.
        max_body_bytes: A larger body is an error.
        seed: Of the jitter, so that tests repeat.
    """

    connect_timeout_s: float = 10.0
    read_timeout_s: float = 30.0
    total_timeout_s: float = 300.0
    attempts: int = 7
    first_delay_s: float = 0.5
    max_delay_s: float = 120.0
    quota_patience_s: float = 90.0
    failures_in_a_row: int = 25
    pages_in_a_row: int = 5
    outage_pauses_s: tuple[float, ...] = (30.0, 120.0, 300.0)
    rate_per_s: float = 50.0
    burst: int = 10
    max_body_bytes: int = 1 << 29
    seed: int = 0
