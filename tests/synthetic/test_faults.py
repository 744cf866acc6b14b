"""Faults: in words, and as a client meets them."""

import time
from email.utils import parsedate_to_datetime

import cv2
import numpy as np
import pytest
import requests

from panokit.errors import UsageError
from panokit.synthetic import Faults, StreetServer, Trouble, parse_faults
from panokit.synthetic.exchange import Request
from panokit.synthetic.troubles import TroubleSchedule

THUMB = "/api/pictures/here/thumb.jpg"


def test_words_become_values():
    faults = parse_faults(
        "429 10% delay=0.5 at=/tiles/, 500 0.05 first=2, html x3,slow 1% seconds=2, "
        "session-uses=300, edge-tiles=cropped, missing-tiles=3/1/2+3/0/0, thinned, seed=7"
    )
    assert faults == Faults(
        troubles=(
            Trouble(kind="429-any", path="/tiles/", rate=0.1, retry_after_s=0.5),
            Trouble(kind="500", rate=0.05, attempts=2),
            Trouble(kind="html", times=3),
            Trouble(kind="slow", rate=0.01, slow_s=2.0),
        ),
        seed=7,
        session_uses=300,
        edge_tiles="cropped",
        missing_tiles=frozenset({(3, 1, 2), (3, 0, 0)}),
        thinned=True,
    )
    assert parse_faults("") == Faults()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("5oo 10%", "switches are"),
        ("500 often", "a rate"),
        ("500 5% until=noon", "a rate"),
        ("500 120%", "0 to 1"),
        ("500 60%, html 60%", "more than 100%"),
        ("thinned=yes", "takes no value"),
        ("session-uses", "needs a value"),
        ("edge-tiles=round", "no value"),
        ("missing-tiles=3/1", "no value"),
    ],
)
def test_words_that_are_not_understood(words, says):
    with pytest.raises(UsageError, match=says):
        parse_faults(words)


def fates(faults, paths, attempts=1, **query):
    schedule = TroubleSchedule(faults)
    met = {}
    for path in paths:
        for attempt in range(attempts):
            trouble = schedule.next_for(
                Request(port="api", method="GET", path=path, query={"q": "1", **query})
            )
            met[path, attempt] = trouble and trouble.kind
    return met


def test_rates_are_kept_and_depend_on_seed_address_and_attempt_alone():
    faults = parse_faults("500 10%, html 5%, seed=3")
    paths = [f"/{n}" for n in range(4000)]
    first = fates(faults, paths)
    assert list(first.values()).count("500") == pytest.approx(400, abs=60)
    assert list(first.values()).count("html") == pytest.approx(200, abs=45)
    # In another order and with other credentials, the same; with another seed, another.
    assert fates(faults, paths[::-1], key="other", session="new") == first
    assert fates(parse_faults("500 10%, html 5%, seed=4"), paths) != first
    again = fates(faults, paths, attempts=2)
    assert {again[path, 0] for path in paths} == {None, "500", "html"}
    assert [again[path, 0] for path in paths] != [again[path, 1] for path in paths]


def test_only_the_first_attempts_fail():
    met = fates(parse_faults("500 100% first=2"), ["/a", "/b"], attempts=4)
    assert [met["/a", n] for n in range(4)] == ["500", "500", None, None]
    assert [met["/b", n] for n in range(4)] == ["500", "500", None, None]


def test_the_three_ways_to_state_a_delay(server, http):
    server.set_faults(parse_faults("429 100% delay=2"))
    seen = set()
    for n in range(24):
        reply = http.get(f"{server.url}/api/{n}", timeout=5)
        assert reply.status_code == 429
        until = reply.headers.get("Retry-After")
        if until is None:
            assert reply.json()["error"]["details"][1]["retryDelay"] == "2s"
            seen.add("body")
        elif until.isdecimal():
            assert until == "2"
            seen.add("seconds")
        else:
            ahead = parsedate_to_datetime(until) - parsedate_to_datetime(reply.headers["Date"])
            assert 1 <= ahead.total_seconds() <= 3
            seen.add("date")
    assert seen == {"body", "seconds", "date"}


def test_a_fraction_of_a_second_is_right_on_average(server, http):
    server.set_faults(parse_faults("429-seconds 100% delay=0.25"))
    delays = [
        int(http.get(f"{server.url}/api/{n}", timeout=5).headers["Retry-After"]) for n in range(80)
    ]
    assert set(delays) == {0, 1}
    assert sum(delays) == pytest.approx(20, abs=12)


def test_bodies_that_are_not_what_they_should_be(server, http):
    good = http.get(server.url + THUMB, timeout=5)

    def met(kind):
        server.set_faults(Faults(troubles=[Trouble(kind=kind, slow_s=0.3)]))
        return http.get(server.url + THUMB, timeout=5)

    def pixels(reply):
        return cv2.imdecode(np.frombuffer(reply.content, np.uint8), cv2.IMREAD_COLOR_RGB)

    assert met("wrong-type").headers["Content-Type"] == "text/plain"
    assert met("empty").content == b""
    assert pixels(met("small")).shape == (125, 250, 3)
    assert pixels(met("black")).max() == 0
    start_s = time.monotonic()
    assert met("slow").content == good.content
    assert time.monotonic() - start_s >= 0.25


def test_a_reset_cuts_the_connection(server):
    server.set_faults(Faults(troubles=[Trouble(kind="reset")]))
    with pytest.raises(requests.exceptions.ConnectionError, match=r"(?i)reset"):
        requests.get(server.url + THUMB, timeout=5)
    assert requests.get(server.url + THUMB, timeout=5).status_code == 200
    assert server.faults_met == {"reset": 1}


@pytest.mark.parametrize(
    ("path", "says"),
    [("/v1/x", "Internal error"), ("/api/x", "Internal Server"), ("/images", "temporarily")],
)
def test_each_service_words_its_own_trouble(server, http, path, says):
    server.set_faults(Faults(troubles=[Trouble(kind="503")]))
    reply = http.get(server.url + path, timeout=5)
    assert (reply.status_code, says in reply.text) == (503, True)


def test_who_has_a_picture_already_gets_a_304(server, http):
    first = http.get(server.url + THUMB, timeout=5)
    assert first.headers["Cache-Control"].startswith("private, max-age")
    known = {"If-None-Match": first.headers["ETag"]}
    again = http.get(server.url + THUMB, headers=known, timeout=5)
    assert (again.status_code, again.content) == (304, b"")
    assert http.get(server.url + THUMB, headers={"If-None-Match": '"x"'}, timeout=5).content


def test_the_report_for_other_programs(server, http):
    server.set_faults(parse_faults("500 x1"))
    for _ in range(2):
        http.get(server.url + THUMB, timeout=5)
    report = http.get(server.url + "/look-alike", timeout=5).json()
    assert report == {"requests": 2, "faults_met": {"500": 1}, "violations": []}


def google(server, http, tile, session):
    return http.get(
        f"{server.url}/v1/streetview/tiles/0/{tile}/0",
        params={"key": "panokit", "session": session, "panoId": "far"},
        timeout=5,
    )


def open_session(server, http):
    url = f"{server.url}/v1/createSession"
    reply = http.post(url, params={"key": "panokit"}, json={"mapType": "streetview"}, timeout=5)
    return reply.json()["session"]


def test_google_counts_tiles_by_minute_and_day(server, http):
    session = open_session(server, http)
    server.set_faults(Faults(quota_per_minute=2))
    assert [google(server, http, 0, session).status_code for _ in range(3)] == [200, 200, 429]
    details = google(server, http, 0, session).json()["error"]["details"]
    assert 50 < float(details[1]["retryDelay"].rstrip("s")) <= 60
    server.set_faults(Faults(quota_per_day=2))
    day = google(server, http, 0, session)
    assert "per day" in day.json()["error"]["message"]
    assert len(day.json()["error"]["details"]) == 1, "a day's quota names no delay"


def test_a_session_is_used_up(server, http):
    server.set_faults(Faults(session_uses=2))
    session = open_session(server, http)
    assert [google(server, http, 0, session).status_code for _ in range(3)] == [200, 200, 400]
    assert google(server, http, 0, open_session(server, http)).status_code == 200


def test_thumbnails(server, http):
    session = open_session(server, http)
    url = f"{server.url}/v1/streetview/thumbnail"
    query = {"key": "panokit", "session": session, "panoId": "here", "width": 300, "height": 200}
    reply = http.get(url, params=query, timeout=5)
    shape = cv2.imdecode(np.frombuffer(reply.content, np.uint8), cv2.IMREAD_COLOR).shape
    assert shape == (200, 300, 3)
    assert http.get(url, params=query | {"height": 400}, timeout=5).status_code == 400


def test_two_servers_with_equal_faults_treat_equal_runs_alike(pictures, http):
    faults = parse_faults("500 30%, seed=5")

    def run():
        with StreetServer(pictures, faults=faults) as one:
            return [
                http.get(f"{one.url}/api/pictures/{name}", timeout=5).status_code
                for name in ("here", "north", "far", "here", "north", "far", "here")
            ]

    assert run() == run()
    assert {200, 500} == set(run())
