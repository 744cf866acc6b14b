"""The graph cut against trying everything."""

from itertools import product

import numpy as np
import pytest

from panokit.inpaint.labeling import Copies, best_labels, visible


def small(seed, labels=3, shape=(2, 3)):
    rng = np.random.default_rng(seed)
    pixels = shape[0] * shape[1]
    costs = rng.uniform(0, 8, (labels, pixels)).astype(np.float32)
    costs[0, 0] = np.inf
    return Copies(
        number=np.arange(pixels).reshape(shape),
        values=rng.uniform(0, 6, (labels, pixels, 2)).astype(np.float32),
        costs=costs,
        seam=1.0,
        noise=1e-6,
    )


def energy(labels, copies):
    total = sum(copies.costs[label, pixel] for pixel, label in enumerate(labels))
    number = copies.number
    for a, b in [*zip(number[:, :-1].ravel(), number[:, 1:].ravel(), strict=True),
                 *zip(number[:-1].ravel(), number[1:].ravel(), strict=True)]:  # fmt: skip
        if labels[a] != labels[b]:
            first, second = copies.values[labels[a]], copies.values[labels[b]]
            total += copies.seam + sum(np.linalg.norm(first[p] - second[p]) for p in (a, b))
    return total


@pytest.mark.parametrize("seed", range(12))
def test_two_shifts_are_cut_as_well_as_can_be(seed):
    copies = small(seed, labels=2)
    best = min(energy(each, copies) for each in product(range(2), repeat=6))
    assert energy(best_labels(copies), copies) == pytest.approx(best, abs=0.8)


@pytest.mark.parametrize("seed", range(8))
def test_three_shifts_are_cut_nearly_so(seed):
    copies = small(seed)
    every = sorted(energy(each, copies) for each in product(range(3), repeat=6))
    assert energy(best_labels(copies), copies) <= 1.1 * every[0] + 0.8


def test_a_pixel_that_no_shift_can_serve_is_left():
    copies = small(0)
    copies.costs[:, 3] = np.inf
    labels = best_labels(copies)
    assert labels[3] == -1
    assert (labels[[0, 1, 2, 4, 5]] >= 0).all()


def test_differences_drown_in_noise():
    difference = np.array([[3.0, 4.0], [0.3, 0.4]], np.float32)
    assert visible(difference, 1e-6) == pytest.approx([5, 0.5], rel=1e-4)
    assert visible(difference, 5.0) == pytest.approx([2.5, 0.25 / 5.5], rel=1e-4)
