"""qa() with a reference set and with truths, from the call to the report and the command line."""

import json
import re

import numpy as np
import pytest

from panokit.cli.main import main
from panokit.envmap import EnvironmentMap
from panokit.frames import direction_from_azimuth_elevation
from panokit.io import write_environment_map
from panokit.qa import QaSettings, find_items, qa, write_report
from panokit.sphere import equirect_directions


def street(seed, sun):
    random = np.random.default_rng(seed)
    directions = equirect_directions(128, 64)
    sky = np.where(directions[..., 1:2] > 0, [0.4, 0.5, 0.8], [0.2, 0.18, 0.15])
    blocks = random.uniform(0.5, 1.5, (8, 16, 1)).repeat(8, 0).repeat(8, 1)
    toward = direction_from_azimuth_elevation(random.uniform(-3, 3), random.uniform(0.5, 1))
    glow = np.exp((directions @ toward - 1) * 1500)[..., None]
    return np.asarray(sky * blocks + glow * sun, np.float32)


@pytest.fixture
def folders(tmp_path):
    """Eight references, five maps without suns of whose scenes four are among them."""
    for seed in range(8):
        truth = EnvironmentMap(radiance=street(seed, 800))
        write_environment_map(truth, tmp_path / f"reference/place-{seed}.exr")
    for seed in (0, 1, 2, 3, 40):
        estimate = EnvironmentMap(radiance=street(seed, 2))
        write_environment_map(estimate, tmp_path / f"maps/place-{seed}.exr")
    return tmp_path


def test_a_reference_makes_a_set_and_truths(folders):
    result = qa(
        find_items([folders / "maps"]),
        QaSettings(reference_count_min=8),
        reference=folders / "reference",
        out=folders / "out",
    )
    assert (len(result.sets.augmented), len(result.sets.reference), result.sets.paired) == (5, 8, 4)
    assert [score.name for score in result.pairs.scores] == [f"place-{i}" for i in range(4)]
    # Of a reference set most are no truth of anything, which is as it should be.
    assert result.pairs.unused == () and result.pairs.without_truth == ()
    assert (folders / "out/descriptions.jsonl").is_file()
    assert (folders / "out/pairs/place-2.jpg").is_file()
    assert result.maps[0].comparison.reference == "place-0.exr"


def test_truths_are_told_of_apart_from_references(folders):
    result = qa(find_items([folders / "maps"]), truth=folders / "reference")
    assert result.sets is None
    assert result.pairs.without_truth == ("place-40",)
    assert result.pairs.unused == tuple(f"place-{i}.exr" for i in (4, 5, 6, 7))
    assert result.maps[4].comparison is None


def test_few_references_make_no_set_and_maps_alone_no_pairs(folders):
    few = qa(find_items([folders / "maps"]), QaSettings(reference_count_min=9),
             reference=folders / "reference")  # fmt: skip
    assert few.sets is None and few.pairs is not None
    alone = qa(find_items([folders / "maps"]))
    assert alone.sets is None and alone.pairs is None
    assert alone.to_json()["sets"] is alone.to_json()["pairs"] is None


def test_broken_maps_do_not_cost_the_comparison(folders):
    (folders / "maps/broken.exr").write_bytes(b"no map")
    result = qa(
        find_items([folders / "maps"]),
        QaSettings(reference_count_min=8),
        reference=folders / "reference",
    )
    assert len(result.unreadable) == 1 and len(result.sets.augmented) == 5


def test_the_report_shows_sets_and_pairs(folders):
    result = qa(
        find_items([folders / "maps"]),
        QaSettings(reference_count_min=8),
        reference=folders / "reference",
        out=folders / "out",
    )
    html = write_report(result, folders / "out").read_text()
    text = re.sub(r"<[^>]+>", " ", html)
    for said in (
        "Set against reference", "What is added and what is distorted", "Precision and recall",
        "Coverage", "Near-duplicates", "Nearest references", "Against the truth",
        "Relit scenes", "irradiance-sh2", "Every protocol", "needs the published scene",
    ):  # fmt: skip
        assert said in text, said
    assert html.count("A matte, a glossy and a mirror ball") == 4
    assert str(folders) not in html
    record = json.loads((folders / "out/qa.json").read_text())
    assert record["sets"]["schema"] == "panokit.sets/1"
    assert record["pairs"]["schema"] == "panokit.pairs/1"
    assert record["pairs"]["pairs"][0]["picture"] == "pairs/place-0.jpg"


def test_lost_pictures_do_not_cost_the_report(folders):
    result = qa(find_items([folders / "maps"]), truth=folders / "reference", out=folders / "out")
    for picture in (folders / "out/pairs").iterdir():
        picture.unlink()
    text = write_report(result, folders / "out").read_text()
    assert "Against the truth" in text and "A matte, a glossy" not in text


def test_the_command_takes_truths_and_references(folders, capsys):
    code = main(["qa", str(folders / "maps"), "--truth", str(folders / "reference"),
                 "--reference", str(folders / "reference"), "--reference-count-min", "8",
                 "--out", str(folders / "report")])  # fmt: skip
    told = capsys.readouterr().out
    assert code in (0, None)
    assert "Pairs: 4 compared, 1 maps without truth, 4 truths without a map" in told
    assert "Set of 5 against 8, figure by figure:" in told
    first = (folders / "report/qa.json").read_bytes()
    main(["qa", str(folders / "maps"), "--truth", str(folders / "reference"),
          "--reference", str(folders / "reference"), "--reference-count-min", "8",
          "--out", str(folders / "report")])  # fmt: skip
    assert (folders / "report/qa.json").read_bytes() == first
