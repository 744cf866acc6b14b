"""Sphere resampling against general-purpose resamplers, as ratios of CPU time in one run.

make bench
"""

import time
from collections.abc import Callable

import cv2
import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.sphere import (
    energy,
    equirect_directions,
    equirect_pixel,
    irradiance_map,
    resize_radiance,
    rotate_radiance,
)

WIDTH = 2048


def cpu_seconds(work: Callable[[], object], repeats: int = 3) -> float:
    best = np.inf
    for _ in range(repeats):
        started = time.process_time()
        work()
        best = min(best, time.process_time() - started)
    return best


@pytest.fixture(scope="module")
def sunny():
    directions = equirect_directions(WIDTH, WIDTH // 2)
    sun = direction_from_azimuth_elevation(0.3, np.deg2rad(85))
    radiance = np.repeat(0.4 + 0.2 * directions[..., 1:2], 3, axis=2)
    radiance[directions @ sun > np.cos(np.deg2rad(0.2665))] = 6e4
    return radiance.astype(np.float32)


def test_shrinking_a_map(benchmark, sunny):
    benchmark(resize_radiance, sunny, 64)
    ours = cpu_seconds(lambda: resize_radiance(sunny, 64))
    area = cpu_seconds(lambda: cv2.resize(sunny, (64, 32), interpolation=cv2.INTER_AREA))
    plain = cv2.resize(sunny, (64, 32), interpolation=cv2.INTER_AREA)
    benchmark.extra_info["cpu_over_cv2_area"] = round(ours / area, 2)
    benchmark.extra_info["energy_error"] = float(_error(resize_radiance(sunny, 64), sunny))
    benchmark.extra_info["energy_error_of_cv2_area"] = float(_error(plain, sunny))
    assert _error(resize_radiance(sunny, 64), sunny) < 1e-4


def test_rotating_a_map(benchmark, sunny):
    pose = Rotation.from_heading_pitch_roll(0.5, 0.3, 0.2)
    benchmark.pedantic(rotate_radiance, (sunny, pose), rounds=3)
    ours = cpu_seconds(lambda: rotate_radiance(sunny, pose))

    def by_scipy():
        directions = pose.inverse.apply(equirect_directions(WIDTH, WIDTH // 2))
        column, row = equirect_pixel(directions, WIDTH, WIDTH // 2)
        return np.stack(
            [map_coordinates(sunny[..., c], [row, column], order=1, mode="grid-wrap")
             for c in range(3)], axis=-1,
        )  # fmt: skip

    benchmark.extra_info["cpu_over_scipy_linear"] = round(ours / cpu_seconds(by_scipy, 1), 2)
    benchmark.extra_info["energy_error"] = float(_error(rotate_radiance(sunny, pose), sunny))
    benchmark.extra_info["energy_error_of_scipy"] = float(_error(by_scipy(), sunny))
    assert _error(rotate_radiance(sunny, pose), sunny) < 1e-4


def test_irradiance_for_every_normal(benchmark, sunny):
    benchmark.pedantic(irradiance_map, (sunny, 64), rounds=3)
    benchmark.extra_info["cpu_s"] = round(cpu_seconds(lambda: irradiance_map(sunny, 64)), 3)
    usual = resize_radiance(sunny, 1024)
    benchmark.extra_info["cpu_s_of_1024"] = round(cpu_seconds(lambda: irradiance_map(usual)), 3)


def _error(radiance, reference):
    return np.abs(energy(radiance) / energy(reference) - 1).max()
