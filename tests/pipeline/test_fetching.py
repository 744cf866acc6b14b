"""The fetch stage of a run: what counts as asked for before, and what is told on the way."""

import pytest

from panokit.console import Console
from panokit.errors import QuotaError, Rejection
from panokit.pipeline.fetching import fetch_batch, fetch_into, recorded_captures
from panokit.pipeline.settings import QuotaSettings
from panokit.records import RunFolder
from tests.fetch.conftest import panoramax, pictures, server  # noqa: F401 (fixtures)


@pytest.fixture
def run(tmp_path):
    return RunFolder(tmp_path / "run").create()


def quiet():
    return Console(quiet=True)


def items(batch):
    return sorted(receipt.item for receipt in batch.receipts)


def test_a_list_that_has_changed_is_asked_for_again(server, run, tmp_path):  # noqa: F811
    ids = tmp_path / "ids.txt"
    ids.write_text("pano-3328\n")
    settings = panoramax(server, places=(), picture_list=ids)
    assert items(fetch_batch(settings, run, quiet())) == ["panoramax-pano-3328"]
    asked = len(server.requests)
    fetch_batch(settings, run, quiet())
    assert len(server.requests) == asked
    ids.write_text("pano-3328\npano-5376\n")
    assert items(fetch_batch(settings, run, quiet())) == [
        "panoramax-pano-3328",
        "panoramax-pano-5376",
    ]


def test_pace_and_budget_do_not_decide_what_is_fetched(server, run):  # noqa: F811
    end = {"name": "End", "latitude_deg": 48.503, "longitude_deg": 7.7, "radius_m": 50}
    settings = panoramax(server, places=(end,), count=1)
    fetch_batch(settings, run, quiet())
    asked = len(server.requests)
    slower = settings.model_copy(update={"max_requests": 500, "concurrency": 1})
    fetch_batch(slower, run, quiet())
    assert len(server.requests) == asked


def test_progress_counts_what_is_there_before(server, run, capsys):  # noqa: F811
    settings = panoramax(server, places=(), pictures=("pano-3328", "pano-5376"))
    fetch_into(settings, run, Console())
    fetch_into(settings, run, Console())
    assert capsys.readouterr().err.count("fetch: 2 of 2") == 2


def test_the_credits_are_those_of_all_pictures_of_the_run(server, run):  # noqa: F811
    for name in ("pano-3328", "pano-5376"):
        fetch_into(panoramax(server, places=(), pictures=(name,)), run, quiet())
    sheet = (run.root / "ATTRIBUTION.md").read_text()
    assert "panoramax-pano-3328, panoramax-pano-5376" in sheet


def test_progress_does_not_count_what_another_picture_took_the_place_of(
    server,  # noqa: F811
    run,
    capsys,
    monkeypatch,
):
    """A picture that cannot be had is replaced: it is no step toward the number that is wanted."""
    from panokit.fetch.transfer import Transfer

    outcomes = Transfer.outcomes
    refused = Rejection(item="panoramax-x", stage="fetch", reason="retired", message="gone")

    def with_a_bad_one(self, candidates, missing):
        yield refused
        yield from outcomes(self, candidates, missing)

    monkeypatch.setattr(Transfer, "outcomes", with_a_bad_one)
    end = {"name": "End", "latitude_deg": 48.503, "longitude_deg": 7.7, "radius_m": 50}
    result = fetch_into(panoramax(server, places=(end,), count=1), run, Console())
    assert len(result.stored) == 1
    assert [one.reason for one in result.rejections] == ["retired"]
    told = capsys.readouterr().err
    assert "fetch: 1 of 1" in told
    assert "2 of 1" not in told


def test_areas_share_one_quota(server, run):  # noqa: F811
    end = {"name": "End", "latitude_deg": 48.503, "longitude_deg": 7.7, "radius_m": 50}
    one = panoramax(server, places=(end,), count=1)
    other = panoramax(server, places=(), pictures=("pano-3328", "pano-5376"))
    with pytest.raises(QuotaError, match="budget"):
        fetch_batch((one, other), run, quiet(), quota=QuotaSettings(max_requests=2))
    assert recorded_captures(run) is None
    batch = fetch_batch((one, other), run, quiet(), quota=QuotaSettings(max_requests=20))
    assert len(batch.receipts) >= 2
    asked = len(server.requests)
    assert not any(r.fresh for r in fetch_batch((one, other), run, quiet()).receipts)
    assert len(server.requests) == asked


def test_pictures_of_other_licenses_are_passed_over(server, run):  # noqa: F811
    end = {"name": "End", "latitude_deg": 48.503, "longitude_deg": 7.7, "radius_m": 50}
    none = panoramax(server, places=(end,), count=2, licenses=("MIT",))
    nothing = fetch_into(none, run, quiet())
    assert nothing.stored == ()
    assert nothing.passed_over["other-license"] > 0
