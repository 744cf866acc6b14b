import hashlib

import cv2
import numpy as np
import pytest

from panokit.capture import TileGrid, local_capture
from panokit.io.captures import StoredCapture


def smooth_scene(width_px, seed=0):
    """A picture with detail, smooth enough for JPEG and never black."""
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(60, 220, (width_px // 32, width_px // 16, 3)).astype(np.float32)
    scene = cv2.resize(coarse, (width_px, width_px // 2), interpolation=cv2.INTER_CUBIC)
    return np.clip(scene, 40, 250).astype(np.uint8)


def encode(pixels, suffix=".jpg"):
    _, data = cv2.imencode(suffix, pixels[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 97])
    return data.tobytes()


class TileStore:
    """Cuts a picture into tiles on disk, as a service would send them."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self, scene, tile_px=64, *, missing=(), suffix=".jpg", replace=None, **known):
        """`replace` maps (column, row) to a function of the padded tile's pixels -> bytes."""
        height, width = scene.shape[:2]
        grid = TileGrid(
            width_px=width,
            height_px=height,
            tile_width_px=tile_px,
            tile_height_px=tile_px,
            missing=tuple(missing),
        )
        padded = np.zeros((grid.rows * tile_px, grid.columns * tile_px, 3), np.uint8)
        padded[:height, :width] = scene
        bodies = {}
        for column, row in grid.cells():
            if (column, row) in missing:
                continue
            tile = padded[row * tile_px :, column * tile_px :][:tile_px, :tile_px]
            make = (replace or {}).get((column, row), lambda tile: encode(tile, suffix))
            bodies[f"tiles/{column}_{row}{suffix}"] = make(tile)
        return self.store(bodies, grid, **known)

    def store(self, bodies, grid=None, **known):
        files = {}
        for name, data in bodies.items():
            path = self.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
            files[name] = hashlib.sha256(data).hexdigest()
        capture = local_capture("street", **known)
        return StoredCapture(folder=self.folder, capture=capture, grid=grid, files=files)


@pytest.fixture
def tile_store(tmp_path):
    return TileStore(tmp_path)


@pytest.fixture
def scene():
    return smooth_scene
