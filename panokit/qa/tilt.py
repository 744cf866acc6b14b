"""Whether a map is level, from its own upright lines and from its horizon.

Both are votes over tilts. The image of an upright line lies on a great circle through the
zenith, so the gradient across it is at right angles to up; houses and trunks have many. And
where sky meets a flat land or the sea all around, the boundary is a circle around up. Either
speaks only where it is clear and where two halves of the azimuths, cut like a cake into
alternating pieces, say the same. A landscape of hills and trees says nothing.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.qa.measurements import SMALL_WIDTH_PX, Finding, Measurements, absent, stops_over
from panokit.sphere import equirect_directions

_REACH_DEG = 8.0
_FLOOR_STOPS, _CEILING_STOPS = -6.0, 4.0
# Upright edges: where they are looked for, how strong, how near to upright, how many.
_BAND_DEG, _LEAST_GRADIENT, _ALMOST_UPRIGHT_DEG = 50.0, 0.06, 14.0
_VOTE_DEG = 1.5
_MOST_EDGES, _LEAST_WEIGHT = 12000, 400.0
_LEAST_CONTRAST = 1.12
# The horizon: where it is looked for, the height of the rows compared, and how much of the
# round must agree.
_HORIZON_BAND_DEG, _STEP_ROWS, _LEAST_STEP = 22.0, 4, 0.15
_AZIMUTHS = 64
_HEIGHTS_DEG = np.arange(-3.0, 5.01, 0.5)
_LEAST_AGREEMENT = 0.6
# Each half of the azimuths, alternating in so many pieces, must find the same up to this.
_PIECES, _HALVES_DIFFER_DEG = 16, 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Tilt:
    """By how much a map is off level, and what says so.

    Attributes:
        angle_deg: Between the map's up and the world's.
        evidence: "upright lines" or "the horizon".
    """

    angle_deg: float
    evidence: str


def tilt(measured: Measurements) -> Finding:
    """The angle between the map's up and the world's, in degrees."""
    if measured.small.shape[1] < SMALL_WIDTH_PX:
        return absent(f"narrower than {SMALL_WIDTH_PX} pixels")
    if measured.is_black:
        return absent("the map is black")
    found = find_tilt(measured.small)
    if found is None:
        return absent("neither upright lines nor a flat horizon")
    return Finding(value=found.angle_deg, note=f"by {found.evidence}")


def find_tilt(radiance: NDArray[np.float32]) -> Tilt | None:
    """The tilt of a map (256, 512, 3), or None where nothing tells."""
    light = np.asarray(luminance(radiance), np.float32)
    median = float(np.median(light)) or float(light.mean()) or 1.0
    stops = stops_over(light, median, _FLOOR_STOPS)
    by_lines = _by_lines(np.minimum(stops, np.float32(_CEILING_STOPS)))
    if by_lines is not None:
        return Tilt(angle_deg=by_lines, evidence="upright lines")
    blue, red = (stops_over(radiance[..., c], median, _FLOOR_STOPS) for c in (2, 0))
    by_horizon = _by_horizon(np.minimum(stops, np.float32(_CEILING_STOPS)), blue - red)
    return None if by_horizon is None else Tilt(angle_deg=by_horizon, evidence="the horizon")


def _by_lines(stops: NDArray[np.float32]) -> float | None:
    normals, weights, azimuths = _upright_edges(stops)
    if weights.sum() < _LEAST_WEIGHT:
        return None
    if len(normals) > _MOST_EDGES:
        some = np.linspace(0, len(normals) - 1, _MOST_EDGES).astype(np.int64)
        normals, weights, azimuths = normals[some], weights[some], azimuths[some]
    ups = _tilted_ups(1.0)
    off = (normals @ ups.T) / np.float32(np.sin(np.deg2rad(_VOTE_DEG)))
    each = weights[:, None] / (1 + off * off)
    first_half = (np.floor(azimuths / (2 * np.pi) * _PIECES).astype(np.int64) % 2) == 0
    halves = [each[first_half].sum(axis=0), each[~first_half].sum(axis=0)]
    votes = halves[0] + halves[1]
    best = int(np.argmax(votes))
    if votes[best] < _LEAST_CONTRAST * np.median(votes):
        return None
    up = _refined(ups[best].astype(np.float64), normals, weights)
    for mask, half in ((first_half, halves[0]), (~first_half, halves[1])):
        own = _refined(ups[int(np.argmax(half))].astype(np.float64), normals[mask], weights[mask])
        if own @ up < np.cos(np.deg2rad(_HALVES_DIFFER_DEG)):
            return None
    angle = float(np.degrees(np.arccos(np.clip(up[1], -1, 1))))
    return angle if angle <= _REACH_DEG else None


def _tilted_ups(step_deg: float) -> NDArray[np.float32]:
    """Unit vectors, (n, 3), for all tilts within reach, a step apart."""
    steps = np.tan(np.deg2rad(np.arange(-_REACH_DEG, _REACH_DEG + 0.01, step_deg)))
    x, z = (axis.ravel() for axis in np.meshgrid(steps, steps))
    ups = np.stack([x, np.ones_like(x), z], axis=-1).astype(np.float32)
    return ups / np.linalg.norm(ups, axis=1, keepdims=True)


def _refined(
    up: NDArray[np.float64], normals: NDArray[np.float32], weights: NDArray[np.float32]
) -> NDArray[np.float64]:
    """Up at right angles to the normals that are nearly so already, by weighted least squares."""
    for _ in range(4):
        off = (normals @ up) / np.sin(np.deg2rad(_VOTE_DEG))
        weighted = normals * (weights / (1 + off * off) ** 2)[:, None]
        _, vectors = np.linalg.eigh(weighted.T @ normals)
        up = vectors[:, 0] * (1 if vectors[1, 0] >= 0 else -1)
    return up


def _upright_edges(
    stops: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float64]]:
    """The unit normals of the great circles of near-upright edges, (n, 3), weights, azimuths."""
    height, width = stops.shape
    wide = cv2.GaussianBlur(np.pad(stops, ((0, 0), (8, 8)), mode="wrap"), (0, 0), 1.0)
    directions = equirect_directions(width, height)
    level = np.hypot(directions[..., 0], directions[..., 2])
    across = cv2.Sobel(wide, cv2.CV_32F, 1, 0, scale=1 / 8)[:, 8:-8] / level
    upward = -cv2.Sobel(wide, cv2.CV_32F, 0, 1, scale=1 / 8)[:, 8:-8]
    size = np.hypot(across, upward)
    # The gradient, as a direction on the sphere, rises by the upward part times cos(elevation).
    rise = np.abs(upward * level) <= size * np.sin(np.deg2rad(_ALMOST_UPRIGHT_DEG))
    near = level > np.cos(np.deg2rad(_BAND_DEG))
    rows, columns = np.nonzero(near & rise & (size > _LEAST_GRADIENT))
    d, flat = directions[rows, columns], level[rows, columns]
    east = np.stack([-d[:, 2] / flat, np.zeros_like(flat), d[:, 0] / flat], axis=-1)
    north = np.cross(d, -east)
    gradient = across[rows, columns, None] * east + upward[rows, columns, None] * north
    strength = size[rows, columns]
    normals = gradient / strength[:, None]
    azimuths = (columns + 0.5) / width * (2 * np.pi)
    return normals.astype(np.float32), np.minimum(strength, 0.5) * flat, azimuths


def _by_horizon(stops: NDArray[np.float32], color: NDArray[np.float32]) -> float | None:
    """The tilt of the circle on which sky and ground part, if it is clear all around."""
    height, width = stops.shape
    step_deg = 180 / height
    reach = int(_HORIZON_BAND_DEG / step_deg)
    rows = np.arange(height // 2 - reach, height // 2 + reach + 1)
    parting = np.hypot(_step(stops, rows), _step(color, rows))
    parting[parting < _LEAST_STEP] = 0
    around = parting.reshape(len(rows), _AZIMUTHS, width // _AZIMUTHS).mean(axis=2)
    # Each azimuth speaks with its strongest edge, so that a bright one does not outvote others.
    around = around / np.maximum(around.max(axis=0), 2 * _LEAST_STEP)
    around = cv2.GaussianBlur(around, (1, 5), 0, sigmaY=1.0)
    azimuth = ((np.arange(_AZIMUTHS) + 0.5) / _AZIMUTHS - 0.5) * 2 * np.pi
    steps = np.arange(-_REACH_DEG, _REACH_DEG + 0.01, 0.5)
    x, z = (axis.ravel() for axis in np.meshgrid(steps, steps))
    curves = x[:, None] * np.sin(azimuth) + z[:, None] * np.cos(azimuth)
    halves = np.zeros((2, len(x), len(_HEIGHTS_DEG)))
    first_half = (np.arange(_AZIMUTHS) * _PIECES // _AZIMUTHS) % 2 == 0
    for number, own_height_deg in enumerate(_HEIGHTS_DEG):
        found = np.rint(reach - (curves + own_height_deg) / step_deg).astype(np.int64)
        inside = (found >= 0) & (found < len(rows))
        seen = around[np.clip(found, 0, len(rows) - 1), np.arange(_AZIMUTHS)]
        seen = np.where(inside, seen, 0)
        halves[:, :, number] = seen[:, first_half].mean(axis=1), seen[:, ~first_half].mean(axis=1)
    best = halves.mean(axis=0).max(axis=1)
    chosen = int(np.argmax(best))
    if best[chosen] < _LEAST_AGREEMENT:
        return None
    for half in halves.max(axis=2):
        own = int(np.argmax(half))
        if np.hypot(x[own] - x[chosen], z[own] - z[chosen]) > _HALVES_DIFFER_DEG:
            return None
    # Among tilts that fit as well as the best, the one nearest to level is the fairest guess.
    as_good = best >= best[chosen] - 0.02
    return float(np.hypot(x, z)[as_good].min())


def _step(picture: NDArray[np.float32], rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """The mean of the rows above each row's upper edge less that of the rows below it."""
    sums = np.cumsum(np.pad(picture, ((1, 0), (0, 0))), axis=0, dtype=np.float64)
    above = sums[rows] - sums[rows - _STEP_ROWS]
    below = sums[rows + _STEP_ROWS] - sums[rows]
    return np.asarray((above - below) / _STEP_ROWS, np.float32)
