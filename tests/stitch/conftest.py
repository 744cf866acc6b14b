import hashlib
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from panokit.capture import TileGrid, View, local_capture
from panokit.color import srgb_decode_u8, srgb_encode_u8
from panokit.io.captures import StoredCapture
from panokit.sphere import perspective_view


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


def detailed_scene(width_px, seed=0):
    """Patches and lines at many scales, so that overlaps have something to align."""
    rng = np.random.default_rng(seed)
    scene = np.full((width_px // 2, width_px, 3), 110, np.float32)
    for cells in (8, 32, 128):
        coarse = rng.normal(0, 28, (cells // 2, cells, 3)).astype(np.float32)
        wrapped = np.concatenate([coarse[:, -2:], coarse, coarse[:, :2]], axis=1)
        cell = width_px // cells
        size = (width_px + 4 * cell, width_px // 2)
        wide = cv2.resize(wrapped, size, interpolation=cv2.INTER_CUBIC)
        scene += wide[:, 2 * cell : 2 * cell + width_px]
    # The poles are one place each.
    rows = np.abs(np.linspace(-1, 1, width_px // 2))
    calm = np.clip((1 - rows) / 0.15, 0, 1)[:, None, None]
    return np.clip(110 + (scene - 110) * calm, 20, 235).astype(np.uint8)


def ring_of_views(size_px=120, fov_deg=90.0):
    """22 views around the sphere: eight on the horizon, six above and below, two poles."""
    poses = [(45.0 * i, 0.0) for i in range(8)]
    poses += [(60.0 * i + 15, pitch) for pitch in (45.0, -45.0) for i in range(6)]
    poses += [(0.0, 90.0), (0.0, -90.0)]
    return [
        View(
            name=f"{number:02}.png",
            heading_deg=heading,
            pitch_deg=pitch,
            fov_deg=fov_deg,
            width_px=size_px,
            height_px=size_px,
        )
        for number, (heading, pitch) in enumerate(poses)
    ]


def shoot(scene, views, gains=None, vignette=0.0):
    """What cameras with these poses show of a scene; gains and vignetting in linear light."""
    pictures = []
    for number, view in enumerate(views):
        picture = perspective_view(
            scene, view.width_px, view.height_px, view.fov_deg, view.world_from_view
        )
        if gains is None and not vignette:
            pictures.append(picture)
            continue
        x = (np.arange(view.width_px) + 0.5) / view.width_px * 2 - 1
        y = (np.arange(view.height_px) + 0.5) / view.height_px * 2 - 1
        falloff = 1 - vignette * (y[:, None] ** 2 + x[None] ** 2) / 2
        gain = 1.0 if gains is None else gains[number]
        linear = srgb_decode_u8(picture) if picture.dtype == np.uint8 else picture
        exposed = (linear * gain * falloff[..., None]).astype(np.float32)
        pictures.append(srgb_encode_u8(exposed) if picture.dtype == np.uint8 else exposed)
    return pictures


def psnr(a, b):
    """Over the sphere, after the best common gain."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    rows = np.sin((np.arange(len(a)) + 0.5) / len(a) * np.pi)[:, None, None]
    gain = (rows * a * b).sum() / (rows * a * a).sum()
    error = (rows * (gain * a - b) ** 2).sum() / (rows * np.ones_like(a)).sum()
    return 10 * np.log10(255**2 / error)


@pytest.fixture
def sphere_views():
    """Functions to make overlapping views of a scene."""
    return SimpleNamespace(scene=detailed_scene, ring=ring_of_views, shoot=shoot, psnr=psnr)
