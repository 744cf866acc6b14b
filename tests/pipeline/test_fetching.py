"""The fetch stage of a run: what counts as asked for before, and what is told on the way."""

import pytest

from panokit.console import Console
from panokit.pipeline.fetching import fetch_batch, fetch_into
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
