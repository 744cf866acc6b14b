"""The main job end to end, over real HTTP, on two pictures of the embedded city."""

import json
import re
import shutil

import numpy as np
import pytest

from panokit import synthetic
from panokit.io import read_environment_map, write_environment_map
from panokit.pipeline import demo
from panokit.probes import Library
from panokit.synthetic import embedded_city, embedded_truth

_EXTERNAL = re.compile(r"""(?:src|href)\s*=\s*["'](?:https?:)?//""")


@pytest.fixture
def two_pictures(monkeypatch):
    pictures = list(embedded_city())[:2]
    monkeypatch.setattr(synthetic, "embedded_city", lambda: pictures)
    return pictures


def test_the_demo_ends_with_probes_and_a_report_that_opens_from_disk(
    two_pictures, tmp_path, console
):
    result = demo.run_demo(tmp_path / "demo", console)
    assert not result.rejections
    with Library.open(tmp_path / "demo" / "library") as library:
        entries = library.list()
        assert {entry.place for entry in entries} == {p.capture.place for p in two_pictures}
        for entry in entries:
            assert np.isfinite(library.read(entry.id).radiance).all()
            assert entry.license == "CC0-1.0"
    page = result.report.read_text(encoding="utf-8")
    assert "synthetic" in page
    assert not _EXTERNAL.search(page)
    judged = json.loads((tmp_path / "demo" / "qa" / "qa.json").read_text())["maps"]
    assert all(one["comparison"]["reference"] for one in judged)
    assert demo.run_demo(tmp_path / "demo", console).nothing_to_do


@pytest.mark.usefixtures("two_pictures")
def test_the_truth_is_read_by_the_judge_alone(tmp_path, console, monkeypatch):
    def probes(name, truth):
        monkeypatch.setattr(demo, "embedded_truth", lambda: truth)
        run = demo.run_demo(tmp_path / name, console).run
        return [path.read_bytes() for path in sorted(run.probes.glob("*.exr"))], (
            run.qa / "qa.json"
        ).read_bytes()

    other = tmp_path / "other-truth"
    shutil.copytree(embedded_truth(), other)
    for path in other.glob("*.exr"):
        truth = read_environment_map(path)
        write_environment_map(truth.with_changes(radiance=truth.radiance * 5), path)
    maps, verdict = probes("a", embedded_truth())
    same_maps, other_verdict = probes("b", other)
    assert maps == same_maps
    assert verdict != other_verdict
