"""Many maps: references of the same name are truth, others a distribution, a bad map is data."""

import pytest

from panokit.errors import UsageError
from panokit.io import write_environment_map
from panokit.qa import QaItem, QaSettings, Verdict, find_items, qa


@pytest.fixture
def folder(tmp_path, make_map):
    for name, sun in (("noon", 3e4), ("haze", 300)):
        write_environment_map(make_map(128, sun=sun), tmp_path / "maps" / f"{name}.exr")
    return tmp_path / "maps"


def test_each_map_is_judged_alone(folder):
    result = qa(find_items([folder]))
    assert [(j.item.name, j.verdict) for j in result.maps] == [
        ("haze", Verdict.PASS), ("noon", Verdict.PASS),
    ]  # fmt: skip
    assert all(j.comparison is None and j.standings == () for j in result.maps)
    assert result.maps[0].capture.license.id == "CC-BY-SA-4.0"


def test_a_map_that_cannot_be_read_is_a_rejection_and_the_rest_goes_on(folder):
    (folder / "broken.exr").write_bytes(b"no map")
    seen = []
    result = qa(find_items([folder]), on_judged=lambda judged: seen.append(judged.item.name))
    assert seen == ["broken", "haze", "noon"]
    (broken,) = result.unreadable
    assert (broken.rejection.item, broken.rejection.reason) == ("broken", "not-an-image")
    assert str(folder) not in broken.rejection.message
    assert (len(result.passed), len(result.failed)) == (2, 0)


def test_a_reference_of_the_same_name_is_the_truth(folder, tmp_path, make_map):
    write_environment_map(make_map(128), tmp_path / "truth/noon.exr")
    haze, noon = qa(find_items([folder]), reference=tmp_path / "truth").maps
    assert haze.comparison is None
    assert noon.comparison.reference == "noon.exr"
    assert {d.name: d.value for d in noon.comparison.differences}["energy-ratio"] == (
        pytest.approx(1, rel=1e-6)
    )


def test_a_truth_given_with_the_item_goes_before_the_folder(folder, tmp_path, make_map):
    write_environment_map(make_map(128, sun=3e3), tmp_path / "other.exr")
    item = QaItem(name="noon", map_path=folder / "noon.exr", truth_path=tmp_path / "other.exr")
    (judged,) = qa([item]).maps
    assert judged.comparison.reference == "other.exr"


def test_a_truth_that_cannot_be_read_is_an_obstacle(folder, tmp_path):
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth/noon.exr").write_bytes(b"no map")
    noon = qa(find_items([folder / "noon.exr"]), reference=tmp_path / "truth").maps[0]
    assert "not an OpenEXR file" in noon.comparison.obstacle
    assert noon.verdict is Verdict.PASS


def test_enough_references_of_other_names_make_a_distribution(folder, tmp_path, make_map):
    for number in range(5):
        write_environment_map(make_map(64, sun=10.0**number), tmp_path / f"set/r{number}.hdr")
    (tmp_path / "set/broken.hdr").write_bytes(b"no map")
    few = qa(find_items([folder]), reference=tmp_path / "set")
    assert few.reference_names == ()
    settings = QaSettings(reference_count_min=5)
    result = qa(find_items([folder]), settings, reference=tmp_path / "set")
    assert result.reference_names == ("r0", "r1", "r2", "r3", "r4")
    assert [skipped.item for skipped in result.skipped_references] == ["broken"]
    haze, noon = ({s.name: s.percentile for s in j.standings} for j in result.maps)
    assert haze["top-share"] < noon["top-share"]


def test_a_folder_without_references_says_so(folder, tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(UsageError, match="to compare with"):
        qa(find_items([folder]), reference=tmp_path / "empty")
    with pytest.raises(UsageError, match="There is no folder"):
        qa(find_items([folder]), reference=tmp_path / "nowhere")
    with pytest.raises(UsageError, match="nothing to judge"):
        qa([])
