"""`panokit probes` as a user meets it: 80 columns, JSON, exit codes, remedies."""

import json

import numpy as np
import pytest

from panokit.capture import Capture, license_from_spdx
from panokit.cli.main import main
from panokit.envmap import EnvironmentMap
from panokit.frames import Frame
from panokit.io import write_environment_map
from panokit.provenance import Provenance, Step
from tests.conftest import sun_radiance


@pytest.fixture
def hdris(tmp_path):
    """Four maps, one with a long name and a long place, one sunny, in a folder of their own."""
    folder = tmp_path / "hdris"
    names = ("panoramax-0123456789abcdef0123456789abcdef", "meadow", "hall", "cellar")
    for number, name in enumerate(names):
        radiance = np.full((32, 64, 3), 0.3 + number / 10, np.float32)
        radiance[5 + number, 20] = 80
        if name == "meadow":
            radiance = sun_radiance(64, 40, diameter_deg=6)
        capture = Capture(
            provider="panoramax",
            id=name,
            license=license_from_spdx("CC-BY-SA-4.0", "A mapper of a very long name " * 4),
            place="Saint-Remy-en-Bouzemont-Saint-Genest-et-Isson, FR",
            details={"scene": "outdoor_sunrise_sunset_with_clouds"},
        )
        steps = (Step(stage="stitch", version="1", values={"tiles": 91, "coverage": 0.99}),)
        envmap = EnvironmentMap(
            radiance=radiance,
            frame=Frame.WORLD,
            capture=capture,
            provenance=Provenance(steps),
        )
        write_environment_map(envmap, folder / f"{name}.exr")
    return folder


@pytest.fixture
def library(tmp_path, hdris, capsys):
    folder = str(tmp_path / "lib")
    assert main(["probes", "add", folder, str(hdris), "--category", "long_category_name"]) == 0
    capsys.readouterr()
    return folder


def widest(text):
    return max(map(len, text.splitlines()))


def test_everything_fits_80_columns(library, tmp_path, capsys, monkeypatch):
    # A path is not cut: it would be no use.
    monkeypatch.chdir(tmp_path)
    library = "lib"
    assert main(["probes", "list", library]) == 0
    listed = capsys.readouterr().out
    assert main(["probes", "show", library, "meadow"]) == 0
    shown = capsys.readouterr().out
    assert main(["probes", "select", library, "--count", "2"]) == 0
    assert max(widest(listed), widest(shown), widest(capsys.readouterr().out)) <= 80
    assert "panorama…89abcdef" in listed
    assert "how it was made" in shown
    assert "stitch" in shown
    assert "CC-BY-SA-4.0, permits store, derive, train" in shown


@pytest.mark.parametrize("command", ["add", "list", "select", "export", "pull"])
def test_help_fits_80_columns(command, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert main(["probes", command, "--help"]) == 0
    assert widest(capsys.readouterr().out) <= 80


def test_a_list_is_filtered_and_counted(library, capsys):
    assert main(["probes", "list", library, "--has-sun", "--json"]) == 0
    assert [one["name"] for one in json.loads(capsys.readouterr().out)] == ["meadow"]
    assert main(["probes", "list", library, "--has-sun"]) == 0
    assert "1 of 4 probes" in capsys.readouterr().err
    assert main(["probes", "list", library, "--kind", "lifted"]) == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "None of the 4 probes passes" in captured.err


def test_in_place_is_told(tmp_path, hdris, capsys):
    folder = str(tmp_path / "lib")
    assert main(["probes", "add", folder, str(hdris), "--in-place", "--tag", "x"]) == 0
    assert capsys.readouterr().out.count("added in place") == 4
    assert main(["probes", "show", folder, "hall"]) == 0
    shown = capsys.readouterr().out
    assert "(used in place)" in shown
    (hdris / "hall.exr").write_bytes(b"changed")
    assert main(["probes", "verify", folder]) == 1
    captured = capsys.readouterr()
    assert "hall.exr (hall) has changed since it was added. Restore it" in captured.out
    assert "4 probes, 1 damaged" in captured.out


def test_a_selection_is_input_of_an_export(library, tmp_path, capsys):
    chosen, out = tmp_path / "chosen.json", tmp_path / "out"
    assert main(["probes", "select", library, "--count", "2", "--out", str(chosen)]) == 0
    ids = json.loads(chosen.read_text())["ids"]
    capsys.readouterr()
    arguments = ["probes", "export", library, "--to", "harmonics", "--selection", str(chosen)]
    assert main([*arguments, "--out", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [one["id"] for one in told["exported"]] == ids
    assert len(list(out.glob("*.harmonics.json"))) == 2
    assert (out / "ATTRIBUTION.md").exists()


def test_exports_by_what_probes_are(library, tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["probes", "export", library, "--to", "usd", "--out", str(out)]
    assert main([*arguments, "--has-sun", "--sun", "apart"]) == 0
    captured = capsys.readouterr()
    assert "meadow.usda" in captured.out
    assert "1 of 1 have a sun that is now a light of its own" in captured.err
    assert "credits in" in captured.err
    parquet = ["probes", "export", library, "--to", "parquet", "--out", str(out)]
    assert main(parquet) == 0
    assert "4 probes" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (["show", "{lib}", "medow"], 2, "Did you mean "),
        (["show", "{lib}", "zzzzzz"], 2, "See those there with: panokit probes list"),
        (["export", "{lib}", "--to", "usd", "--out", "o"], 2, "--id, --selection, --all"),
        (["export", "{lib}", "--to", "usd", "--out", "o", "--id", "hal", "--all"], 2, "not both"),
        (["export", "{lib}", "--to", "usd", "--out", "o", "--kind", "lifted"], 2, "No probe"),
        (["export", "{lib}", "--to", "fbx", "--out", "o"], 2, "--to"),
        (["export", "{lib}", "--to", "usd", "--out", "o", "--selection", "x"], 3, "no record x"),
        (["select", "{lib}", "--count", "0"], 2, "--count 0"),
        (["select", "{lib}", "--count", "2", "--kind", "lifted"], 2, "nothing to select"),
        (["list", "{lib}", "--bbox", "0", "9", "1", "5"], 2, "west, south, east, north"),
        (["list", "{lib}", "--catgory", "x"], 2, "--category"),
        (["list", "nowhere"], 2, "panokit probes add nowhere"),
        (["add", "{lib}", "nothing-there"], 4, "Check the path"),
        (["add", "{lib}", "hdris", "--in-place", "--repair"], 2, "add a copy"),
    ],
)
def test_errors_are_one_line_with_a_remedy(
    library, arguments, code, text, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert main(["probes", *(one.format(lib=library) for one in arguments)]) == code
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert line.startswith("panokit: ")
    assert text in line


def test_an_empty_library_says_how_to_fill_it(tmp_path, capsys):
    (tmp_path / "lib" / "probes").mkdir(parents=True)
    assert main(["probes", "list", str(tmp_path / "lib")]) == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "is empty. Add maps with: panokit probes add" in captured.err


def test_a_library_that_cannot_be_written_is_told(tmp_path, hdris, capsys):
    (tmp_path / "lib").write_text("a file where the folder should be")
    assert main(["probes", "add", str(tmp_path / "lib"), str(hdris)]) == 4
    line = capsys.readouterr().err.strip().splitlines()[-1]
    assert line.startswith("panokit: Cannot make")
    assert "choose another path" in line or "Check" in line
