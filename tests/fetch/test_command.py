"""`panokit fetch` as it is typed: exit codes, and what it says."""

import json

from panokit.cli.main import main
from tests.fetch.conftest import KEY

BOX = ["--bbox", "7.69", "48.49", "7.71", "48.51"]


def typed(server, out, *more: str) -> int:
    google = ["--source", "google-tiles", "--accept-terms", "google", "--zoom", "1"]
    return main(["fetch", "--endpoint", server.url, *google, "--out", str(out), *more])


def test_all_that_was_wanted_is_there(server, tmp_path, capsys):
    assert typed(server, tmp_path, *BOX, "--count", "2") == 0
    assert typed(server, tmp_path, *BOX, "--count", "2") == 0
    output = capsys.readouterr()
    assert "0 stored, 2 there already, 0 rejected, 0 requests" in output.out
    assert output.err.count("fetch: 2 of 2") == 2


def test_the_credits_come_with_the_run(server, tmp_path):
    assert typed(server, tmp_path, *BOX, "--count", "2") == 0
    sheet = (tmp_path / "ATTRIBUTION.md").read_text()
    assert "google-maps-platform" in sheet
    assert "may not be kept, changed or used for training" in sheet
    assert (tmp_path / "ATTRIBUTION.csv").read_text().count("\n") == 3


def test_a_shortage_is_told_and_ends_with_1(server, tmp_path, capsys):
    assert typed(server, tmp_path, *BOX, "--count", "5", "--json") == 1
    ((place, counts),) = json.loads(capsys.readouterr().out)["short"].items()
    assert (place.startswith("7.69"), counts) == (True, {"found": 4, "wanted": 5})


def test_nothing_found_is_no_rejected_panorama(server, tmp_path, capsys):
    where = ["--city", "Bristol, GB"]
    assert main(["fetch", "--endpoint", server.url, *where, "--out", str(tmp_path)]) == 1
    output = capsys.readouterr()
    assert "0 rejected, 1 request; none found in Bristol, GB\n" in output.out
    line = next(line for line in output.err.splitlines() if "panoramas found" in line)
    assert line.count("Bristol") == 1
    assert "a larger radius" in line


def test_a_dry_run_says_what_it_would_take(server, tmp_path, capsys):
    table = tmp_path / "prices.toml"
    table.write_text(
        '[google-tiles]\nunit = "tile"\nusd_per_1000 = 500.0\nfree_per_month = 4\nper_day = 3\n'
    )
    out = tmp_path / "run"
    assert typed(server, out, *BOX, "--count", "4", "--dry-run", "--prices", str(table)) == 0
    assert capsys.readouterr().out.splitlines() == [
        "Fetching from google-tiles would take:",
        "  panoramas       4",
        "  tiles           8",
        "  requests        8, and 7 already made to search",
        "  daily quota     266.7% of the usual one",
        "  time at quota   3 days",
        "  download        about 216.3 kB",
        "  cost            4.00 USD by list price; 2.00 USD if this month's",
        "                  4 free tiles are still there",
    ]
    assert not out.exists()


def test_a_table_of_prices_that_is_none_is_told_before_anything_is_asked(server, tmp_path, capsys):
    table = tmp_path / "prices.toml"
    table.write_text("[google-tiles")
    assert typed(server, tmp_path / "run", *BOX, "--prices", str(table)) == 2
    assert "prices.toml is not a TOML table" in capsys.readouterr().err
    assert server.requests == []


def test_settings_that_contradict_each_other_are_told_in_plain_words(tmp_path, capsys):
    command = ["fetch", "--source", "folder", "--folder", str(tmp_path), "--picture", "x"]
    assert main([*command, "--out", str(tmp_path / "run")]) == 2
    assert capsys.readouterr().err == "panokit: a folder has no pictures by id.\n"


def test_what_costs_nothing_says_so(server, tmp_path, capsys):
    command = ["fetch", "--endpoint", server.url, *BOX, "--count", "4", "--dry-run"]
    assert main([*command, "--out", str(tmp_path / "run")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == "  cost            nothing"
    assert not [line for line in lines if "quota" in line or "tiles" in line]


def test_a_wrong_key_is_told_in_whole_sentences(server, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("GOOGLE_MAPS_API_KEY", KEY + "-wrong")
    assert typed(server, tmp_path, *BOX) == 8
    assert "valid API key. Check" in capsys.readouterr().err


def test_what_cannot_be_typed_is_not_offered(tmp_path, capsys):
    assert main(["fetch", "--help"]) == 0
    text = capsys.readouterr().out
    assert not [word for word in ("--places", "--no-", "radius_m", "width_px") if word in text]
    assert "--dry-run" in text
    assert main(["fetch", "--places", "x", "--out", str(tmp_path)]) == 2
