"""Sizes, curves and random numbers that the makers of objects share."""

from collections.abc import Sequence
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator

Floats = NDArray[np.floating[Any]]


def generator_of(name: str) -> np.random.Generator:
    """The random numbers that belong to a name: the same in every process and release."""
    digest = blake2b(name.encode(), digest_size=16).digest()
    return np.random.default_rng(int.from_bytes(digest, "little"))


def centered(points: Floats) -> Floats:
    """Points (N, 3) moved so that their bounding box is centered, its longest side 1."""
    low, high = points.min(axis=0), points.max(axis=0)
    longest = float((high - low).max())
    return (points - (low + high) / 2) / (longest if longest > 0 else 1.0)


def curve(knots: Sequence[tuple[float, float]], steps: int) -> Floats:
    """A smooth curve (radius, height) through points of growing height."""
    radius, height = np.array(knots, np.float64).T
    along = np.concatenate([[0], np.cumsum(np.hypot(np.diff(radius), np.diff(height)))])
    at = np.union1d(np.linspace(0, along[-1], steps), along)
    # The radius bends evenly, so that no ring shows in a highlight; the height never turns back.
    out = np.clip(CubicSpline(along, radius, bc_type="natural")(at), 0.6 * radius.min(), None)
    out[0], out[-1] = radius[0], radius[-1]
    return np.stack([out, PchipInterpolator(along, height)(at)], axis=1)


def bend(
    start: Sequence[float], middle: Sequence[float], end: Sequence[float], steps: int
) -> Floats:
    """A quadratic Bezier curve (steps, 3)."""
    t = np.linspace(0, 1, steps)[:, None]
    a, b, c = (np.asarray(point, np.float64) for point in (start, middle, end))
    return (1 - t) ** 2 * a + 2 * t * (1 - t) * b + t**2 * c


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A number drawn evenly between two."""
    return float(rng.uniform(low, high))


def chance(rng: np.random.Generator, share: float) -> bool:
    """True in this share of the cases."""
    return bool(rng.random() < share)
