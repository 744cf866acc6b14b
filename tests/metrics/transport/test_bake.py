"""The shipped tables are what the script makes, and small."""

import lzma

import numpy as np
import pytest

from panokit.metrics.transport import tables
from panokit.metrics.transport.bake import (
    ball_kernel,
    ball_radii,
    changes_along_rows,
    packed,
    visible_share,
)
from panokit.metrics.transport.figure import see
from panokit.metrics.transport.plane import patches
from panokit.metrics.transport.scenes import ROUGH_BALLS


@pytest.mark.parametrize("scene", ROUGH_BALLS)
def test_a_balls_table_is_what_its_reflectance_says(scene):
    ball = ROUGH_BALLS[scene]
    shipped = tables.ball_table(scene)
    assert shipped.shape == (ball.orders, ball.radii, ball.rings)
    chosen = [0, ball.radii // 2, ball.radii - 1]
    kernel = ball_kernel(ball, ball_radii(ball)[chosen])
    # Each ring has its own unit, so that what is dark is as exact as what is bright.
    greatest = np.maximum(np.abs(kernel).max(axis=0), np.abs(shipped).max() / 300 / 2**6)
    assert (np.abs(shipped[:, chosen] - kernel) / greatest).max() < 1 / 180


def test_packing_is_as_exact_in_the_dark_as_in_the_light():
    kernel = np.random.default_rng(0).normal(size=(3, 4, 5)) * np.logspace(-3, 0, 5)
    stored = packed(kernel)
    whole = np.frombuffer(lzma.decompress(stored["whole"].tobytes()), "<i2").reshape(4, 5, 3)
    back = whole.transpose(2, 0, 1) * 2.0 ** stored["exponent"]
    greatest = np.abs(kernel).max(axis=0)
    assert (np.abs(back - kernel) / greatest).max() < 1 / 200


def test_the_bears_table_is_what_the_rays_meet():
    shipped = tables.plane_table()
    hits = see(shipped.size_px, shipped.rays)
    seen = patches(hits)
    assert len(shipped.counts) == len(seen.pixel) * shipped.rows
    chosen = np.arange(5, len(seen.pixel), 151)
    share = visible_share(seen, hits, chosen)
    starts = np.concatenate([[0], np.cumsum(shipped.counts, dtype=np.int64)])
    for patch, expected in zip(chosen, share, strict=True):
        found = np.zeros((shipped.rows, shipped.columns), np.int64)
        for row in range(shipped.rows):
            events = slice(*starts[patch * shipped.rows + row :][:2])
            np.add.at(found[row], shipped.places[events], shipped.changes[events])
        # Other machines may round another way at an edge.
        assert (np.cumsum(found, axis=1) != expected).mean() < 1e-3


def test_changes_along_rows_add_up_to_the_share():
    share = np.zeros((1, 2, 320), np.int8)
    share[0, 0, 3:300] = 16
    share[0, 1, 0:5] = 4
    counts, steps, changes = changes_along_rows(share)
    assert counts.tolist() == [2, 2]
    assert steps.tolist() == [3, 297, 0, 5]
    assert changes.tolist() == [16, -16, 4, -4]


def test_all_tables_together_are_less_than_two_megabytes():
    sizes = [path.stat().st_size for path in tables.FOLDER.iterdir()]
    assert len(sizes) == len(ROUGH_BALLS) + 1
    assert sum(sizes) < 2.75e6
