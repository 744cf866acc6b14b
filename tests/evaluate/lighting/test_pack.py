"""The figure pack: complete, from its folder alone, the same every time."""

import csv
import io
import json
import shutil

import numpy as np
import pytest

from panokit.errors import StorageError
from panokit.evaluate.lighting.figures.sheets import shared_tone
from panokit.evaluate.lighting.figures.sweeps import crossing, noise_curve
from panokit.evaluate.lighting.lighting_report import write_pack
from panokit.evaluate.lighting.outcome import Outcome
from tests.evaluate.lighting.made_up import make_up

FIGURES = {
    *(f"F5.{n}" for n in range(1, 10)), "F5.10a", "F5.10b", "F5.10c", "F5.8 sheet", "F5.9 sheet",
    "F5.10 sheet", "F-C", "F-Da", "F-Db", "F-E", "F-F", "F-I", "F-J", "T-K elevation",
    "T-K directedness",
}  # fmt: skip
TABLES = {
    "V", "V-2", "T-1", "T-2", "T-3", "T-4", "T-A", "T-A2", "T-B", "T-R", "T-K", "F5.8", "F5.9",
    "F5.10", "F5-curves", "F5-ratios", "F-E", "F-F", "T-G-spheres-compat", "T-G-spheres-fixed",
    "T-G-array-compat", "T-G-array-fixed",
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory, samples):
    place = make_up(tmp_path_factory.mktemp("pack"), kept=samples[:4],
                    unfinished=("pyramid-two-core-s1",))  # fmt: skip
    write_pack(place)
    return place


def files_of(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.suffix in {".png", ".pdf", ".csv", ".html", ".md", ".json"}
    }


def test_every_figure_and_table_is_there(folder):
    summary = json.loads((folder / "summary.json").read_text())
    assert set(summary["figures"]) >= FIGURES
    assert set(summary["tables"]) >= TABLES
    assert (folder / "figures" / "f5-1.png").read_bytes().startswith(b"\x89PNG")
    assert (folder / "figures" / "f5-1.pdf").read_bytes().startswith(b"%PDF")


def test_rebuilt_figures_are_equal(folder, tmp_path):
    again = tmp_path / "again"
    for name in ("results.jsonl", "history.jsonl", "models.jsonl", "dataset.json"):
        again.mkdir(exist_ok=True)
        shutil.copy(folder / name, again / name)
    shutil.copytree(folder / "kept", again / "kept")
    write_pack(again)
    one, two = files_of(folder), files_of(again)
    assert one.keys() == two.keys()
    assert [name for name in one if one[name] != two[name]] == []


def test_the_page_says_what_counts(folder):
    page = (folder / "report.html").read_text()
    text = (folder / "report.md").read_text()
    for said in (page, text):
        assert "5.4: the background helps" in said
        assert "2 of 3 pairs of seeds count; not converged" in said
        assert "1134.83" in said
    assert text.count("![") == len(json.loads((folder / "summary.json").read_text())["figures"])


def test_tables_hold_what_the_scores_say(folder):
    text = (folder / "tables" / "f5-8.csv").read_text()
    rows = list(csv.DictReader(io.StringIO(text)))
    outcome = Outcome(folder)
    values = outcome.scores(outcome.entrant("panokit"), "thesis-mse")
    row = next(row for row in rows if row["entrant"] == "panokit")
    assert float(row["p50"]) == pytest.approx(np.median(values), rel=5e-3)
    assert float(row["max"]) == pytest.approx(values.max(), rel=5e-3)
    assert row["n"] == "60"


def test_the_noise_curve_crosses_where_the_effects_do(folder):
    curve = noise_curve(Outcome(folder), "dematerial", "background-branch", "code-ssd")
    # -0.25 at 10 degrees, -0.15 at 20, and the rival at -0.2.
    assert curve.crossing_deg == pytest.approx(15, abs=1.5)
    assert curve.crossing_interval[0] <= curve.crossing_deg <= curve.crossing_interval[1]
    np.testing.assert_allclose(curve.untrained[1:], [0.1 / 0.7, 0.2 / 0.7, 0.3 / 0.7], atol=0.04)


def test_crossings_are_linear_between_levels():
    levels = (0.0, 10.0, 20.0)
    assert crossing(levels, np.array([0, 1.0, 3.0]), 2.0) == 15
    assert crossing(levels, np.array([0, 1.0, 3.0]), -1.0) == 0
    assert crossing(levels, np.array([0, 1.0, 3.0]), 4.0) == float("inf")


def test_a_dark_prediction_looks_dark(samples):
    truth = samples[0].truth
    assert shared_tone(truth / 4, truth).mean() < 0.8 * shared_tone(truth, truth).mean()


def test_a_small_evaluation_has_a_small_pack(tmp_path):
    effects = {"concat-shared": 0.0, "dot-product": 0.0}
    summary = write_pack(make_up(tmp_path, seeds=1, effects=effects))
    assert {"F5.3", "F5.7"} <= set(summary["figures"])
    assert "F5.1" not in summary["figures"]
    # Of one seed there is no interval.
    assert [one["low"] for one in summary["findings"] if one["figure"] == "epochs"] == [None]
    assert "F-C" not in summary["figures"]


def test_a_folder_without_results_says_how_to_make_them(tmp_path):
    with pytest.raises(StorageError, match=r"no results.jsonl.*panokit evaluate"):
        write_pack(tmp_path)
