"""A run among faults brings what a calm one brings: nothing lost, nothing doubled, all alike."""

import logging
import time

import pytest

from panokit.fetch import fetch
from panokit.http import Client, Policy
from panokit.synthetic import StreetServer, parse_faults
from tests.fetch.conftest import KEY
from tests.fetch.town import TILES_AT_ZOOM_3, contents, tiles_asked, town, wanted

FAULTS = (
    "429 10% delay=0.05, 500 5%, truncated 1%, html 1%, reset 1%, slow 1% seconds=4, small 1%, "
    "session-uses={uses}, seed={seed}"
)
KINDS = {"429", "429-date", "429-body", "500", "truncated", "html", "reset", "slow", "small"}
# As patient as usual, but with the pauses of a test; a slow body outlasts an attempt.
POLICY = Policy(first_delay_s=0.05, total_timeout_s=2.0, rate_per_s=5000, burst=8)


def compared(folder, monkeypatch, count: int, seed: int, **changes):
    """The figures of a run among faults, once it is seen to have brought the same."""
    monkeypatch.setenv("GOOGLE_MAPS_API_KEY", KEY)
    (folder / "served").mkdir()
    with StreetServer(town(folder / "served", count), key=KEY) as server:
        settings = wanted(server.url, count, **changes)
        calm = fetch(settings, folder / "calm")
        ideal = tiles_asked(server.requests)
        assert set(ideal.values()) == {1}
        calm_requests = len(server.requests)
        # A session for seven tenths of the calm run ends once in one with a quarter more requests.
        faults = FAULTS.format(uses=calm_requests * 7 // 10, seed=seed)
        server.set_faults(parse_faults(faults))
        start_s = time.monotonic()
        with Client(POLICY) as client:
            rough = fetch(settings, folder / "rough", client=client)
        seconds = time.monotonic() - start_s
        met, asked = server.faults_met, tiles_asked(server.requests[calm_requests:])
        sessions = sum("createSession" in one.path for one in server.requests[calm_requests:])
    assert len(calm.stored) == count
    assert (rough.rejections, rough.short) == ((), {})
    keys = [one.capture.key for one in rough.stored]
    assert keys == [one.capture.key for one in calm.stored]
    assert len(set(keys)) == count
    assert contents(folder / "rough") == contents(folder / "calm")
    assert set(asked) == set(ideal)
    return {
        "ideal": sum(ideal.values()),
        "asked": sum(asked.values()),
        "met": met,
        "sessions": sessions,
        "seconds": seconds,
    }


def test_twelve_panoramas_among_faults(tmp_path, monkeypatch):
    # At zoom 2: a third of the tiles, the same code.
    figures = compared(tmp_path, monkeypatch, 12, seed=5, zoom=2)
    assert figures["sessions"] >= 2
    assert {"429", "429-body", "500"} <= set(figures["met"])
    assert figures["asked"] <= 1.4 * figures["ideal"], figures


@pytest.mark.slow
def test_two_hundred_panoramas_among_faults(tmp_path, monkeypatch):
    figures = compared(tmp_path, monkeypatch, 200, seed=1)
    logging.getLogger(__name__).info("%s", figures)
    assert figures["ideal"] == 50 * sum(TILES_AT_ZOOM_3.values())
    assert set(figures["met"]) == KINDS
    assert figures["sessions"] == 2
    assert figures["asked"] <= 1.3 * figures["ideal"], figures
