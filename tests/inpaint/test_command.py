"""`panokit inpaint` on files: HDR maps, nothing to fill, masks that do not fit."""

import json

import numpy as np
import pytest

from panokit.cli.main import main
from panokit.envmap import EnvironmentMap
from panokit.io import read_environment_map, write_bytes, write_environment_map
from panokit.io.images import encode_jpeg, encode_png
from panokit.io.pictures import record_path

WIDTH = 512


@pytest.fixture
def street(textured, tmp_path):
    path = tmp_path / "street.jpg"
    write_bytes(path, encode_jpeg(textured(WIDTH), quality=80))
    return path


@pytest.fixture
def mask(cap_around, tmp_path):
    path = tmp_path / "mask.png"
    write_bytes(path, encode_png(cap_around(WIDTH, (0, -1, 0), 12).astype(np.uint8) * 255))
    return path


def test_where_nothing_is_filled_the_file_is_the_same_byte_for_byte(street, tmp_path):
    out = tmp_path / "out"
    assert main(["inpaint", str(street), "--out", str(out)]) == 0
    assert (out / "street.jpg").read_bytes() == street.read_bytes()
    record = json.loads(record_path(out / "street.jpg").read_text())
    assert record["provenance"][-1]["values"]["fillings"] == []


def test_a_mask_is_filled_in_an_hdr_map(textured, cap_around, mask, tmp_path):
    radiance = (textured(WIDTH) / 255.0).astype(np.float32) ** 2
    hole = cap_around(WIDTH, (0, -1, 0), 12)
    truth = radiance[hole].mean()
    radiance[hole] = 90
    write_environment_map(EnvironmentMap(radiance=radiance), tmp_path / "map.exr")
    out = tmp_path / "out"
    arguments = ["inpaint", str(tmp_path / "map.exr"), "--mask", str(mask), "--out", str(out)]
    assert main(arguments) == 0
    filled = read_environment_map(out / "map.exr")
    assert filled.radiance[hole].mean() == pytest.approx(truth, rel=0.4)
    assert filled.radiance[hole].max() < 2
    assert filled.provenance.steps[-1].values["holes"][0]["kind"] == "given"


@pytest.mark.parametrize(
    ("white", "reason"), [((4, 8), "wrong-mask"), ((WIDTH // 2, WIDTH), "all-hole")]
)
def test_a_mask_that_cannot_be_used_is_a_rejection_in_one_line(
    street, tmp_path, capsys, white, reason
):
    write_bytes(tmp_path / "bad.png", encode_png(np.full(white, 255, np.uint8)))
    out = tmp_path / "out"
    code = main(["inpaint", str(street), "--mask", str(tmp_path / "bad.png"), "--out", str(out)])
    captured = capsys.readouterr()
    assert code == 1
    assert f"({reason})" in captured.err
    assert "Traceback" not in captured.err
    assert not (out / "street.jpg").exists()
