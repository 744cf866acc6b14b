"""How replies are judged, from stored bodies."""

from datetime import UTC, datetime, timedelta

import pytest

from panokit.http.failures import FailureKind, error_of_failure, failure_of_reply, retry_after_s

NOW = datetime(2026, 3, 1, 12, 0, tzinfo=UTC)


def judged(status: int, body: str = "", **headers: str):
    return failure_of_reply(status, headers, body.encode(), NOW)


def test_good_replies_are_no_failures():
    assert judged(200) is None
    assert judged(204) is None


@pytest.mark.parametrize(
    ("status", "body", "kind"),
    [
        (429, "", FailureKind.QUOTA),
        (403, '{"error": {"errors": [{"reason": "rateLimitExceeded"}]}}', FailureKind.QUOTA),
        (403, '{"error": {"errors": [{"reason": "forbidden"}]}}', FailureKind.AUTH),
        (400, '{"error": {"details": [{"reason": "API_KEY_INVALID"}]}}', FailureKind.AUTH),
        (400, '{"error": {"message": "Invalid location"}}', FailureKind.PERMANENT),
        (404, "not json", FailureKind.PERMANENT),
        (502, "<html>", FailureKind.TRANSIENT),
        (408, "[]", FailureKind.TRANSIENT),
        # Mapillary's statuses do not fit its errors.
        (
            500,
            '{"error": {"message": "Invalid OAuth 2.0 Access Token", "code": 190}}',
            FailureKind.AUTH,
        ),
        (
            400,
            '{"error": {"message": "Error validating application", "code": 190}}',
            FailureKind.AUTH,
        ),
        (
            400,
            '{"error": {"message": "Application request limit reached", "code": 4}}',
            FailureKind.QUOTA,
        ),
        (
            500,
            '{"error": {"message": "Service temporarily unavailable", "code": 2}}',
            FailureKind.TRANSIENT,
        ),
        (500, '{"error": {"message": "An unknown error", "code": [1]}}', FailureKind.TRANSIENT),
    ],
)
def test_the_class_of_a_failure(status, body, kind):
    failure = judged(status, body)
    assert failure.kind is kind
    assert failure.status == status


def test_a_box_that_holds_too_much_is_not_asked_for_again():
    body = '{"error": {"code": 1, "message": "Please reduce the amount of data"}}'
    failure = judged(500, body)
    assert (failure.kind, failure.reason) == (FailureKind.PERMANENT, "too-much")


def test_mapillary_s_unknown_ids_are_not_found_though_their_status_is_400():
    body = '{"error": {"code": 100, "error_subcode": 33, "message": "does not exist"}}'
    failure = judged(400, body)
    assert (failure.kind, failure.reason) == (FailureKind.PERMANENT, "not-found")
    assert judged(400, '{"error": {"code": 100, "message": "bbox"}}').reason == "bad-request"


def test_what_the_server_said_is_told():
    assert (
        "bbox must be" in judged(400, '{"message": "bbox must be ...", "status_code": 400}').message
    )


@pytest.mark.parametrize("status", [400, 401, 429, 500])
def test_a_sentence_of_the_server_ends_once(status):
    failure = judged(status, '{"error": {"message": "It is so."}}')
    for attempts in (1, 3):
        assert ".." not in str(error_of_failure(failure, "https://a.example", attempts))


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ("7", 7.0),
        ("Sun, 01 Mar 2026 12:00:30 GMT", 30.0),
        ("Sun, 01 Mar 2026 11:00:00 GMT", 0.0),
        ("soon", None),
        ("", None),
    ],
)
def test_retry_after(header, expected):
    assert retry_after_s({"Retry-After": header}, NOW) == expected


def test_a_date_is_measured_by_the_clock_of_the_server():
    headers = {
        "Retry-After": "Sun, 01 Mar 2026 12:00:30 GMT",
        "Date": "Sun, 01 Mar 2026 12:00:20 GMT",
    }
    assert retry_after_s(headers, NOW + timedelta(hours=5)) == 10.0


@pytest.mark.parametrize(("text", "expected"), [("41s", 41.0), ("1.5s", 1.5), ("later", None)])
def test_the_delay_in_a_google_body(text, expected):
    body = f'{{"error": {{"details": [{{"retryDelay": "{text}"}}]}}}}'
    assert judged(429, body).delay_s == expected


def test_a_header_outranks_the_body():
    body = '{"error": {"details": [{"retryDelay": "41s"}]}}'
    assert judged(429, body, **{"Retry-After": "3"}).delay_s == 3.0
