"""Putting tiles together: panokit against the loop that everybody writes with Pillow.

pytest tests/benchmarks/test_stitch.py --benchmark-columns=min,mean,rounds
"""

import hashlib
import io

import cv2
import numpy as np
import pytest
from PIL import Image

from panokit.capture import TileGrid, local_capture
from panokit.io.captures import StoredCapture
from panokit.stitch.mosaic import mosaic

# The size of an older street panorama one zoom below its full size, with cut edges.
GRID = TileGrid(width_px=6656, height_px=3328, tile_width_px=512, tile_height_px=512)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tiles")
    (folder / "tiles").mkdir()
    rng = np.random.default_rng(0)
    coarse = rng.uniform(30, 220, (104, 208, 3)).astype(np.float32)
    scene = cv2.resize(coarse, (6656, 3584), interpolation=cv2.INTER_CUBIC)
    scene = np.clip(scene + rng.normal(0, 2, scene.shape), 0, 255).astype(np.uint8)
    files = {}
    for column, row in GRID.cells():
        tile = scene[row * 512 : (row + 1) * 512, column * 512 : (column + 1) * 512]
        data = cv2.imencode(".jpg", tile, [cv2.IMWRITE_JPEG_QUALITY, 85])[1].tobytes()
        name = f"tiles/{column}_{row}.jpg"
        (folder / name).write_bytes(data)
        files[name] = hashlib.sha256(data).hexdigest()
    return StoredCapture(folder=folder, capture=local_capture("x"), grid=GRID, files=files)


def with_pillow(stored):
    picture = Image.new("RGB", (GRID.width_px, GRID.height_px))
    for column, row in GRID.cells():
        data = (stored.folder / f"tiles/{column}_{row}.jpg").read_bytes()
        picture.paste(Image.open(io.BytesIO(data)), (column * 512, row * 512))
    return np.asarray(picture)


def decode_and_forget(stored):
    for column, row in GRID.cells():
        data = (stored.folder / f"tiles/{column}_{row}.jpg").read_bytes()
        cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR_RGB)


def test_both_make_the_same_picture(stored):
    ours, theirs = mosaic(stored, GRID, None).pixels, with_pillow(stored)
    assert np.abs(ours.astype(np.int16) - theirs).max() <= 4


@pytest.mark.benchmark(group="mosaic 6656x3328")
def test_panokit(benchmark, stored):
    benchmark.pedantic(mosaic, args=(stored, GRID, None), rounds=5, warmup_rounds=1)


@pytest.mark.benchmark(group="mosaic 6656x3328")
def test_panokit_reduced_to_4096(benchmark, stored):
    benchmark.pedantic(mosaic, args=(stored, GRID, 4096), rounds=3, warmup_rounds=1)


@pytest.mark.benchmark(group="mosaic 6656x3328")
def test_pillow(benchmark, stored):
    benchmark.pedantic(with_pillow, args=(stored,), rounds=5, warmup_rounds=1)


@pytest.mark.benchmark(group="mosaic 6656x3328")
def test_decoding_alone_on_one_thread(benchmark, stored):
    benchmark.pedantic(decode_and_forget, args=(stored,), rounds=5, warmup_rounds=1)
