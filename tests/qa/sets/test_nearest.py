"""Turned copies fit exactly, and each map finds the reference it is most like."""

import numpy as np
import pytest

from panokit.qa.sets.nearest import align, nearest_references


def smooth(seed, width=64):
    random = np.random.default_rng(seed)
    rows, columns = np.mgrid[: width // 2, :width]
    picture = sum(
        random.normal() * np.cos(2 * np.pi * (k * columns / width) + random.uniform(0, 6))
        * np.sin(np.pi * (rows + 0.5) / (width // 2)) ** k
        for k in range(1, 6)
    )  # fmt: skip
    return np.asarray(picture, np.float32)


def test_a_turned_map_is_found_at_its_yaw():
    here = smooth(1)
    fit = align(np.roll(here, 11, axis=1)[None], here[None])
    assert fit.correlation[0, 0] == pytest.approx(1, abs=1e-6)
    assert fit.residual_stops[0, 0] == pytest.approx(0, abs=1e-3)
    assert np.degrees(fit.yaw[0, 0]) == pytest.approx(11 / 64 * 360)


def test_between_pixels_maps_are_interpolated():
    fine = smooth(2, 256)
    turned = np.roll(fine, 5, axis=1)[::4, ::4]
    fit = align(turned[None], fine[::4, ::4][None], 512)
    assert np.degrees(fit.yaw[0, 0]) == pytest.approx(5 / 256 * 360, abs=0.36)
    assert fit.correlation[0, 0] > 0.999


def test_other_maps_do_not_fit():
    fit = align(np.stack([smooth(3)]), np.stack([smooth(4), smooth(3)]))
    assert fit.correlation[0, 0] < 0.9 < fit.correlation[0, 1]


def test_every_map_finds_its_like_by_both_measures():
    maps = np.stack([smooth(seed) for seed in range(300)])
    power = np.exp2(np.random.default_rng(5).normal(size=(300, 17)))
    names = [f"m{i}" for i in range(300)]
    turned = np.roll(maps, 20, axis=2)
    found = nearest_references((power, turned), (power, maps), (names, names))
    assert len(found) == 300
    for name, near in zip(names, found, strict=True):
        assert near.by_look == near.by_spectrum == name
        assert near.own_rank == 1 and near.look_stops < 1e-3
        assert near.yaw_deg == pytest.approx(20 / 64 * 360)
    stranger = nearest_references((power[:1], maps[:1]), (power[1:], maps[1:]), (["x"], names[1:]))
    assert stranger[0].own_rank is None and stranger[0].by_look != "m0"
