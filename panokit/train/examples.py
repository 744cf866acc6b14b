"""Training examples: pictures of the probes, pooled once so that a step is cheap.

Exposure, clipping and compression happen at full size; after that a training step never
sees more than the 128x64 grid.
"""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.color.camera import Camera, photograph
from panokit.color.luminance import weighted_percentile
from panokit.engine.interrupts import interrupts_held_back, leave_interrupts_to_driver
from panokit.expand.component_features import COMPONENT_FEATURES, component_features
from panokit.expand.components import (
    MOST_COMPONENTS,
    Components,
    find_components,
    sum_by_component,
)
from panokit.expand.features import GRID_HEIGHT_PX, GRID_WIDTH_PX, grid_features
from panokit.expand.reduce import reduce_panorama
from panokit.frames import Rotation
from panokit.io.files import atomic_write
from panokit.sphere import resize_radiance, rotate_radiance, row_solid_angles
from panokit.train.normals import NORMALS, irradiance_matrix
from panokit.train.probes import FOLDS, TrainingProbe, assign_folds
from panokit.train.recipe import DataRecipe
from panokit.train.sources import NOWHERE, Source, probe_sources

# Wider than the test cameras: half the pictures are sRGB, half have a sigmoid response.
TRAINING_CAMERA = Camera(
    name="training",
    level=(0.4, 1.3),
    sigmoid_share=0.5,
    sigmoid_n=(0.9, 0.12),
    sigmoid_s=(0.6, 0.12),
    jpeg_quality=(80, 98),
)


WIDE_CAMERA = replace(TRAINING_CAMERA, name="wide", level=(0.12, 3.0))
# One mixed picture in so many is taken with the wide camera.
MIXED_PER_WIDE = 4
# How bright the second probe of a mixed picture is beside the first.
MIXED_LIGHT = (0.1, 1.0)
# Where a light many times brighter than the picture shows is the sun and not a lamp.
DAYLIGHT = (
    "outdoor_sunny",
    "outdoor_sunrise_sunset",
    "outdoor_overcast",
    "semi_outdoor",
    "sky_only",
)
SUN_GAIN, SUN_SHARE = 8.0, 0.1
# Of the brightest value of a clipped map; from here on it may have been brighter.
CEILING = 0.98


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Examples:
    """N pictures with their truth; radiances in units of the clip level.

    Attributes:
        probe: (N,) int, the index of the probe whose place it shows, or `NOWHERE`.
        grid: (N, 16, 64, 128) float16, the gain network's input.
        clear: (N, 3, 64, 128) float16, log of the true radiance where nothing is burnt out.
        burnt: (N, 3, 64, 128) float16, log of the true radiance of what is burnt out.
        features: (N, K, 60) float32, the component network's input; zeros are padding.
        ldr_energy: (N, K) float32, luminance energy of each component in the picture.
        energy: (N, K) float32, its true energy.
        spread: (N, K, 64) float32, irradiance on 64 normals for an energy of 1.
        vector: (N, K, 3) float32, light vector for an energy of 1.
        rest: (N, 68) float32, of all other light: irradiance (64), light vector (3), energy.
        sun: (N, K) float32, 1 where a component is the sun: in a daylight scene the one with
            the most light, if the picture shows less than an eighth of it and it is a tenth
            of all.
        ceiling: (N, 64, 128) float16, how much of a cell is at the ceiling of a map whose
            brightest light is clipped: its true light is a lower bound there. 0 elsewhere.
        lower: (N, K) float32, 1 where a component's true energy is a lower bound for that reason.
        weight: (N,) float32, how often a picture is drawn beside the others.
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
    sun: NDArray[np.float32]
    ceiling: NDArray[np.float16]
    lower: NDArray[np.float32]
    weight: NDArray[np.float32]

    def of_probes(self, probes: NDArray[np.int64]) -> "Examples":
        """Only the pictures of these probes' places, and those of no place."""
        return self.at(np.flatnonzero(np.isin(self.probe, probes) | (self.probe == NOWHERE)))

    def at(self, numbers: NDArray[np.int64]) -> "Examples":
        """Only the pictures with these numbers."""
        return Examples(**{name: getattr(self, name)[numbers] for name in self.__slots__})

    def draw(self, count: int, random: np.random.Generator) -> NDArray[np.int64]:
        """The numbers of `count` pictures, drawn by weight, with repetition."""
        if self.weight.min() == self.weight.max():
            return random.integers(len(self.weight), size=count)
        odds = self.weight.astype(np.float64)
        return random.choice(len(odds), size=count, p=odds / odds.sum())


def make_examples(
    probes: Sequence[TrainingProbe],
    recipe: DataRecipe,
    *,
    others: Sequence[Source] = (),
    processes: int = 1,
) -> Examples:
    """Photograph every map; the same recipe gives the same examples.

    Args:
        probes: To learn from, and to judge on in other folds.
        recipe: Which pictures to take.
        others: Of `panokit.train.sources.other_sources`.
        processes: To work in.
    """
    sources = [*probe_sources(probes), *others]
    work = partial(_examples_of, sources=sources, probes=list(probes), recipe=recipe)
    if processes == 1:
        parts = [work(index) for index in range(len(sources))]
    else:
        with ProcessPoolExecutor(processes, initializer=leave_interrupts_to_driver) as pool:
            with interrupts_held_back():  # the workers are started here
                coming = pool.map(work, range(len(sources)))
            parts = list(coming)
    synthetic = sum(len(p["probe"]) for p, s in zip(parts, sources, strict=True)
                    if s.kind == "synthetic")  # fmt: skip
    captured = sum(len(part["probe"]) for part in parts) - synthetic
    for part, source in zip(parts, sources, strict=True):
        weight = 1.0
        if source.kind == "synthetic" and recipe.synthetic is not None:
            share = recipe.synthetic.share
            weight = share / (1 - share) * captured / synthetic
        part["weight"] = np.full(len(part["probe"]), weight, np.float32)
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


def _examples_of(
    index: int, sources: list[Source], probes: list[TrainingProbe], recipe: DataRecipe
) -> dict[str, NDArray]:
    cv2.setNumThreads(1)
    source = sources[index]
    radiance = source.radiance()
    ceiling = _at_ceiling(radiance) if source.kind == "bound" else None
    first = (recipe.seed * 1000 + index) * 1000
    shots, wide, mixed = recipe.shots_per_probe, recipe.wide_per_probe, recipe.mixed_per_probe
    if source.kind == "synthetic" and recipe.synthetic is not None:
        shots, wide, mixed = recipe.synthetic.shots_per_map, 0, 0
    rows = []
    for k in range(shots + wide):
        camera = TRAINING_CAMERA if k < shots else WIDE_CAMERA
        turn = _tilt(recipe.tilt_deg, first + k)
        light = rotate_radiance(radiance, turn) if turn else radiance
        limit = rotate_radiance(ceiling, turn) if turn and ceiling is not None else ceiling
        rows.append(_example(light, camera, first + k, limit))
    for k in range(mixed if source.kind == "probe" else 0):
        camera = WIDE_CAMERA if k % MIXED_PER_WIDE == MIXED_PER_WIDE - 1 else TRAINING_CAMERA
        rows.append(_example(_mixed(index, probes, k), camera, 500_000 + first + k))
    arrays = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    if source.map.category not in DAYLIGHT:
        arrays["sun"][:] = 0
    return {"probe": np.full(len(rows), source.place), **arrays}


def _at_ceiling(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """1 where a map is as bright as it can be, in whatever channel, (H, W, 1) float32."""
    highest = radiance.max(axis=2, keepdims=True)
    return (highest >= CEILING * highest.max()).astype(np.float32)


def _tilt(limit_deg: float, seed: int) -> Rotation | None:
    """A tilt about a random level axis; None where none is asked for."""
    if limit_deg <= 0:
        return None
    random = np.random.default_rng([seed, 0x74696C74])
    azimuth = random.uniform(-np.pi, np.pi)
    axis = [np.cos(azimuth), 0.0, np.sin(azimuth)]
    return Rotation.about_axis(axis, np.radians(random.uniform(-limit_deg, limit_deg)))


def _mixed(index: int, probes: list[TrainingProbe], number: int) -> NDArray[np.float32]:
    """A probe in its own light and that of another one of its fold, turned and dimmed."""
    random = np.random.default_rng([index, number, 77])
    folds = assign_folds(probes, FOLDS)
    others = [i for i in np.flatnonzero(folds == folds[index]).tolist() if i != index] or [index]
    other = _leveled(probes[int(random.choice(others))].radiance())
    if random.random() < 0.5:
        other = other[:, ::-1]
    other = np.roll(other, int(random.integers(other.shape[1])), axis=1)
    share = np.float32(np.exp(random.uniform(*np.log(MIXED_LIGHT))))
    return np.ascontiguousarray(_leveled(probes[index].radiance()) + share * other)


def _leveled(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """With the 90th percentile of luminance at 1."""
    light = luminance(radiance)
    area = np.broadcast_to(row_solid_angles(*light.shape)[:, None], light.shape)
    return radiance / np.float32(weighted_percentile(light, area, 90))


def _example(
    radiance: NDArray[np.float32],
    camera: Camera,
    seed: int,
    ceiling: NDArray[np.float32] | None = None,
) -> dict[str, NDArray]:
    shot = photograph(radiance, camera, seed=seed)
    truth = radiance * np.float32(shot.exposure)
    reduced = reduce_panorama(shot.pixels, radiance.shape[1])
    grid = grid_features(reduced)
    components = find_components(reduced)
    features = component_features(reduced, components, grid)
    true_burnt = truth * reduced.share[..., None]
    pooled = resize_radiance(np.dstack([truth - true_burnt, true_burnt]), GRID_WIDTH_PX)
    logs = np.log(np.maximum(pooled, 1e-6)).transpose(2, 0, 1).astype(np.float16)
    light = _light_of_regions(luminance(truth), components)
    shown = _light_of_regions(luminance(reduced.burnt), components)[1:]
    energy, ldr_energy = light[1:, -1], shown[:, -1]
    unit = shown / np.maximum(ldr_energy[:, None], 1e-9)
    strongest = energy == energy.max()
    sun = strongest & (energy > SUN_GAIN * ldr_energy) & (energy > SUN_SHARE * light[:, -1].sum())
    bound = np.zeros((GRID_HEIGHT_PX, GRID_WIDTH_PX), np.float16)
    lower = np.zeros(MOST_COMPONENTS, np.float32)
    if ceiling is not None:
        bound = resize_radiance(ceiling, GRID_WIDTH_PX)[..., 0].astype(np.float16)
        reached = sum_by_component(ceiling[..., 0], components)
        lower[: len(reached)] = reached > 0.5
    return {
        "grid": grid.astype(np.float16),
        "clear": logs[:3],
        "burnt": logs[3:],
        "features": _padded(features, (MOST_COMPONENTS, COMPONENT_FEATURES)),
        "ldr_energy": ldr_energy,
        "energy": energy,
        "spread": unit[:, :NORMALS],
        "vector": unit[:, NORMALS : NORMALS + 3],
        "rest": light[0],
        "sun": (sun & (ldr_energy > 0)).astype(np.float32),
        "ceiling": bound,
        "lower": lower,
    }


def _light_of_regions(light: NDArray[np.float32], components: Components) -> NDArray[np.float32]:
    """Irradiance on 64 normals, light vector and energy of all outside the components and of
    each one, (1 + `MOST_COMPONENTS`, 68) float32, as the grid's cells give them.
    """  # noqa: D205
    height, width = light.shape
    row = np.arange(height) * GRID_HEIGHT_PX // height
    column = np.arange(width) * GRID_WIDTH_PX // width
    cell = row[:, None] * GRID_WIDTH_PX + column[None, :]
    cells, regions = GRID_HEIGHT_PX * GRID_WIDTH_PX, 1 + MOST_COMPONENTS
    weighted = light * row_solid_angles(height, width)[:, None]
    place = components.labels * cells + cell
    sums = np.bincount(place.ravel(), weighted.ravel(), regions * cells).reshape(regions, cells)
    area = np.repeat(row_solid_angles(GRID_HEIGHT_PX, GRID_WIDTH_PX), GRID_WIDTH_PX)
    matrix = irradiance_matrix(GRID_WIDTH_PX, NORMALS) / area
    return np.asarray(sums @ matrix.T, np.float32)


def _padded(values: NDArray[np.floating], shape: tuple[int, ...]) -> NDArray[np.float32]:
    full = np.zeros(shape, np.float32)
    full[: len(values)] = values
    return full
