"""Training examples: pictures of the probes, pooled once so that a step is cheap.

Exposure, clipping and compression happen at full size; after that a training step never
sees more than the 128x64 grid.
"""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.color.camera import Camera, photograph
from panokit.expand.component_features import COMPONENT_FEATURES, component_features
from panokit.expand.components import MOST_COMPONENTS, find_components, sum_by_component
from panokit.expand.features import GRID_WIDTH_PX, grid_features
from panokit.expand.reduce import reduce_panorama
from panokit.io.files import atomic_write
from panokit.sphere import equirect_directions, resize_radiance, row_solid_angles
from panokit.train.normals import sphere_normals
from panokit.train.probes import TrainingProbe
from panokit.train.recipe import DataRecipe

# Wider than the test cameras: half the pictures are sRGB, half have a sigmoid response.
TRAINING_CAMERA = Camera(
    name="training",
    level=(0.4, 1.3),
    sigmoid_share=0.5,
    sigmoid_n=(0.9, 0.12),
    sigmoid_s=(0.6, 0.12),
    jpeg_quality=(80, 98),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Examples:
    """N pictures with their truth; radiances in units of the clip level.

    Attributes:
        probe: (N,) int, the index of the probe.
        grid: (N, 16, 64, 128) float16, the gain network's input.
        clear: (N, 3, 64, 128) float16, log of the true radiance where nothing is burnt out.
        burnt: (N, 3, 64, 128) float16, log of the true radiance of what is burnt out.
        features: (N, K, 60) float32, the component network's input; zeros are padding.
        ldr_energy: (N, K) float32, luminance energy of each component in the picture.
        energy: (N, K) float32, its true energy.
        spread: (N, K, 64) float32, irradiance on 64 normals for an energy of 1.
        vector: (N, K, 3) float32, light vector for an energy of 1.
        rest: (N, 68) float32, of all other light: irradiance (64), light vector (3), energy.
    """

    probe: NDArray[np.int64]
    grid: NDArray[np.float16]
    clear: NDArray[np.float16]
    burnt: NDArray[np.float16]
    features: NDArray[np.float32]
    ldr_energy: NDArray[np.float32]
    energy: NDArray[np.float32]
    spread: NDArray[np.float32]
    vector: NDArray[np.float32]
    rest: NDArray[np.float32]

    def of_probes(self, probes: NDArray[np.int64]) -> "Examples":
        """Only the pictures of these probes."""
        keep = np.isin(self.probe, probes)
        return Examples(**{name: getattr(self, name)[keep] for name in self.__slots__})


def make_examples(
    probes: Sequence[TrainingProbe], recipe: DataRecipe, *, processes: int = 1
) -> Examples:
    """Photograph every probe; the same recipe gives the same examples."""
    work = partial(_examples_of_probe, recipe=recipe)
    if processes == 1:
        parts = [work(item) for item in enumerate(probes)]
    else:
        with ProcessPoolExecutor(processes) as pool:
            parts = list(pool.map(work, enumerate(probes)))
    names = Examples.__slots__
    return Examples(**{name: np.concatenate([part[name] for part in parts]) for name in names})


def save_examples(examples: Examples, path: Path) -> None:
    """Write the examples as one .npz."""
    with atomic_write(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **{name: getattr(examples, name) for name in Examples.__slots__})


def load_examples(path: Path) -> Examples:
    """Read what `save_examples` wrote."""
    with np.load(path) as arrays:
        return Examples(**{name: arrays[name] for name in Examples.__slots__})


def _examples_of_probe(item: tuple[int, TrainingProbe], recipe: DataRecipe) -> dict[str, NDArray]:
    cv2.setNumThreads(1)
    index, probe = item
    radiance = probe.radiance()
    rows = [
        _example(radiance, seed=(recipe.seed * 1000 + index) * 1000 + shot)
        for shot in range(recipe.shots_per_probe)
    ]
    arrays = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    return {"probe": np.full(len(rows), index), **arrays}


def _example(radiance: NDArray[np.float32], seed: int) -> dict[str, NDArray]:
    shot = photograph(radiance, TRAINING_CAMERA, seed=seed)
    truth = radiance * np.float32(shot.exposure)
    reduced = reduce_panorama(shot.pixels, radiance.shape[1])
    grid = grid_features(reduced)
    components = find_components(reduced)
    features = component_features(reduced, components, grid)
    true_burnt = truth * reduced.share[..., None]
    pooled = resize_radiance(np.dstack([truth - true_burnt, true_burnt]), GRID_WIDTH_PX)
    logs = np.log(np.maximum(pooled, 1e-6)).transpose(2, 0, 1).astype(np.float16)

    height, width = reduced.share.shape
    area = row_solid_angles(height, width)[:, None]
    directions = equirect_directions(width, height)
    light = (luminance(truth) * area).astype(np.float32)
    shown = (luminance(reduced.burnt) * area).astype(np.float32)
    count = len(components)
    energy = sum_by_component(light, components)
    received = np.zeros((MOST_COMPONENTS, 64), np.float32)
    vector = np.zeros((MOST_COMPONENTS, 3), np.float32)
    normals = sphere_normals(64)
    for k in range(count):
        inside = components.labels == k + 1
        share = shown[inside] / max(float(components.energy[k]), 1e-9)
        facing = directions[inside]
        received[k] = np.maximum(facing @ normals.T, 0).T @ share
        vector[k] = share @ facing
    outside = components.labels == 0
    rest_light, facing = light[outside], directions[outside]
    rest = np.concatenate(
        [np.maximum(facing @ normals.T, 0).T @ rest_light, rest_light @ facing, [rest_light.sum()]]
    )
    return {
        "grid": grid.astype(np.float16),
        "clear": logs[:3],
        "burnt": logs[3:],
        "features": _padded(features, (MOST_COMPONENTS, COMPONENT_FEATURES)),
        "ldr_energy": _padded(components.energy, (MOST_COMPONENTS,)),
        "energy": _padded(energy, (MOST_COMPONENTS,)),
        "spread": received,
        "vector": vector,
        "rest": rest.astype(np.float32),
    }


def _padded(values: NDArray[np.floating], shape: tuple[int, ...]) -> NDArray[np.float32]:
    full = np.zeros(shape, np.float32)
    full[: len(values)] = values
    return full
