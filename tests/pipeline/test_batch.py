import pytest

from panokit.errors import StorageError, UsageError
from panokit.expand.settings import ExpandSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.io import read_environment_map, read_panorama
from panokit.io.images import encode_png
from panokit.pipeline.batch import run_batch
from panokit.pipeline.inputs import map_paths, stage_tasks

SETTINGS = ExpandSettings(model="srgb", width_px=64)


def test_plain_pictures_through_one_stage(pictures, console, tmp_path):
    tasks = stage_tasks("expand", [pictures], SETTINGS, tmp_path / "out")
    result = run_batch("expand", tasks, console)
    assert result.fresh == 3
    assert [(r.item, r.reason) for r in result.rejections] == [("broken", "truncated")]
    assert read_environment_map(tmp_path / "out" / "street1.exr").width_px == 64
    again = run_batch("expand", tasks, console)
    assert (again.fresh, again.found) == (0, 3)
    assert "3 complete already, 1 rejected" in again.summary()
    assert [p.name for p in map_paths([tmp_path / "out"])] == [
        "street0.exr", "street1.exr", "street2.exr"
    ]  # fmt: skip


def test_another_input_under_the_same_name_is_done_again(pictures, console, tmp_path):
    tasks = stage_tasks("expand", [pictures / "street0.jpg"], SETTINGS, tmp_path / "out")
    run_batch("expand", tasks, console)
    (pictures / "street0.jpg").write_bytes((pictures / "street1.jpg").read_bytes())
    assert run_batch("expand", tasks, console).fresh == 1


def test_a_mask_says_what_to_fill(pictures, console, tmp_path):
    source = pictures / "street0.jpg"
    before = read_panorama(source).pixels
    mask = before[..., 0] * 0
    mask[100:110, 20:40] = 255
    (tmp_path / "mask.png").write_bytes(encode_png(mask))
    tasks = stage_tasks(
        "inpaint", [source], InpaintSettings(), tmp_path / "out", tmp_path / "mask.png"
    )
    assert run_batch("inpaint", tasks, console).fresh == 1
    step = read_panorama(tmp_path / "out" / "street0.jpg").provenance.steps[-1]
    assert len(step.input_digests) == 2
    (tmp_path / "mask.png").write_bytes(encode_png(mask[:64]))
    rejected = run_batch("inpaint", tasks, console).rejections
    assert [rejection.reason for rejection in rejected] == ["wrong-mask"]
    for nothing in (b"", b"hello"):
        (tmp_path / "mask.png").write_bytes(nothing)
        rejected = run_batch("inpaint", tasks, console).rejections
        assert [rejection.reason for rejection in rejected] == ["not-an-image"]


def test_wrong_calls_are_said_before_anything_is_done(pictures, tmp_path):
    with pytest.raises(UsageError, match="--out"):
        stage_tasks("expand", [pictures], SETTINGS)
    with pytest.raises(StorageError, match="nowhere"):
        stage_tasks("expand", [tmp_path / "nowhere"], SETTINGS, tmp_path)
    with pytest.raises(UsageError, match="overwrite itself"):
        stage_tasks("inpaint", [pictures / "street0.jpg"], InpaintSettings(), pictures)
    (pictures / "street0.png").write_bytes(b"")
    with pytest.raises(UsageError, match="both become"):
        stage_tasks("expand", [pictures], SETTINGS, tmp_path / "out")
