"""The sparse reflectance map: as one would write it with a loop, and on bodies that are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.color import luminance
from panokit.errors import UsageError
from panokit.reflectance import Rule, hemisphere_normals, sparse_reflectance


def by_loop(picture, normals, mask, width, gate_deg, rule):
    """One cell after the other, one masked search per cell."""
    grid, inside = hemisphere_normals(width)
    colors, own = picture[mask], normals[mask]
    light = luminance(colors.astype(np.float64))
    color, hits = np.zeros((width, width, 3), np.float32), np.zeros((width, width), int)
    for row, column in zip(*np.nonzero(inside), strict=True):
        n = grid[row, column]
        cosine = own[:, 0] * n[0] + own[:, 1] * n[1] + own[:, 2] * n[2]
        near = np.flatnonzero(cosine > np.float32(np.cos(np.deg2rad(gate_deg))))
        hits[row, column] = len(near)
        if len(near) == 0:
            continue
        value = light[near] * (cosine[near] if rule is Rule.WEIGHTED else 1)
        ranked = near[np.argsort(-value, kind="stable")]
        if rule is Rule.TOP:
            color[row, column] = colors[ranked[:5]].mean(axis=0)
        else:
            color[row, column] = colors[ranked[len(near) // 2 if rule is Rule.MEDIAN else 0]]
    return color, hits


def scene(seed, size=24):
    rng = np.random.default_rng(seed)
    normals = rng.normal(0, 1, (size, size, 3)).astype(np.float32)
    normals[..., 2] = np.abs(normals[..., 2])
    # Flat faces: many pixels with one and the same normal.
    normals[: size // 2] = normals[0, :4].repeat(size // 4, axis=0)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    picture = rng.uniform(0, 3, (size, size, 3)).astype(np.float32)
    picture[::3] = picture[0, 0]  # equal pixels: the first counts
    return picture, normals, rng.random((size, size)) < 0.7


@pytest.mark.parametrize("rule", list(Rule))
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10_000), gate=st.sampled_from([2.0, 5.0, 20.0]))
def test_it_is_what_a_loop_gives(rule, seed, gate):
    picture, normals, mask = scene(seed)
    color, hits = by_loop(picture, normals, mask, 16, gate, rule)
    found = sparse_reflectance(picture, normals, mask, width_px=16, gate_deg=gate, rule=rule)
    np.testing.assert_array_equal(found.hits, hits)
    np.testing.assert_allclose(found.color, color, rtol=1e-5, atol=1e-6)


def sphere(size=96):
    normals, inside = hemisphere_normals(size)
    return np.array(normals), np.array(inside)


def test_a_lambertian_ball_gives_its_own_shading():
    normals, mask = sphere()
    toward = np.array([0.5, 0.3, 0.81], np.float32)
    shade = np.maximum(normals @ toward, 0)
    picture = shade[..., None] * np.array([1.0, 0.5, 0.2], np.float32)
    found = sparse_reflectance(picture, normals, mask)
    grid, inside = hemisphere_normals(64)
    truth = np.maximum(grid @ toward, 0)
    away = np.abs(found.color[..., 0] - truth)[inside]
    # Of all within 5 degrees the brightest: never darker than the truth by a cell, never
    # brighter than 5 degrees can make it.
    assert away.max() < np.sin(np.deg2rad(5.0)) + 0.02
    assert (found.color[..., 0] - truth)[inside].min() > -0.05
    assert found.valid[inside].all()
    assert not found.valid[~inside].any()


def test_shadow_on_a_surface_is_left_out_by_the_brightest():
    normals, mask = sphere()
    picture = np.ones((96, 96, 3), np.float32)
    picture[::2] *= 0.1  # every second row lies in shadow
    assert sparse_reflectance(picture, normals, mask).color[32, 32, 0] == 1
    median = sparse_reflectance(picture, normals, mask, rule=Rule.MEDIAN)
    assert np.isclose(median.color[30:34, 30:34, 0], 0.1).any()


def test_one_flat_face_fills_one_spot():
    normals = np.zeros((8, 8, 3), np.float32)
    normals[...] = (0.6, 0.0, 0.8)
    found = sparse_reflectance(np.ones((8, 8, 3)), normals, np.ones((8, 8), bool))
    rows, columns = np.nonzero(found.valid)
    assert abs(columns.mean() - (1.6 * 32 - 0.5)) < 0.5
    assert abs(rows.mean() - 31.5) < 0.5
    assert found.hits.max() == 64


def test_an_empty_mask_gives_an_empty_map():
    found = sparse_reflectance(np.ones((4, 4, 3)), np.ones((4, 4, 3)), np.zeros((4, 4), bool))
    assert not found.valid.any()


@pytest.mark.parametrize("rule", list(Rule))
def test_normals_that_look_away_are_no_error(rule):
    normals = np.zeros((4, 4, 3), np.float32)
    normals[..., 2] = -1
    found = sparse_reflectance(np.ones((4, 4, 3)), normals, np.ones((4, 4), bool), rule=rule)
    assert not found.valid.any()


def test_bad_input_is_named():
    good = np.ones((4, 4, 3))
    mask = np.ones((4, 4), bool)
    with pytest.raises(UsageError, match="go together"):
        sparse_reflectance(good, good[:2], mask)
    with pytest.raises(UsageError, match="gate"):
        sparse_reflectance(good, good, mask, gate_deg=0)
    with pytest.raises(UsageError, match="finite"):
        sparse_reflectance(good * np.nan, good, mask)


def test_normals_that_look_away_count_for_no_cell_that_they_cannot_reach():
    """With a wide gate: not for cells beyond the circle, and not for the corner."""
    rng = np.random.default_rng(0)
    normals = rng.normal(0, 1, (60, 60, 3))
    normals[..., 2] = -np.abs(normals[..., 2])
    normals = (normals / np.linalg.norm(normals, axis=-1, keepdims=True)).astype(np.float32)
    picture, mask = np.ones((60, 60, 3), np.float32), np.ones((60, 60), bool)
    found = sparse_reflectance(picture, normals, mask, width_px=16, gate_deg=30.0)
    _, inside = hemisphere_normals(16)
    assert not found.hits[~inside].any()
    assert found.hits[inside].any()
    backward = np.broadcast_to(np.float32([0, 0, -1]), (4, 4, 3))
    alone = sparse_reflectance(picture[:4, :4], backward, mask[:4, :4], width_px=16)
    assert not alone.hits.any()
