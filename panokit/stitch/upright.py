"""Which way is up, from the picture itself: the lines of houses and poles that stand upright.

The image of a straight line lies on a great circle. The circles of all upright lines meet in
the zenith, so their normals are at right angles to up. Segments are found in pinhole views
around the horizon, and up is the direction that is at right angles to as much of their length
as possible: a vote over all tilts within reach, then weighted least squares.

(The idea of one vanishing point for all uprights is that of Coughlan and Yuille 1999,
"Manhattan World: compass direction from a single image by Bayesian inference".)
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.sphere import perspective_view

_VIEWS, _FOV_DEG, _SIZE_PX, _PITCHES_DEG = 6, 75.0, 400, (-12.0, 22.0)
_LEAST_LENGTH_PX = 14.0
_REACH_DEG = 25.0
_COARSE_DEG, _VOTE_DEG, _FINE_DEG = 1.0, 1.2, 0.5
# Upright within this of the guess is worth looking at, else it is some other line.
_LEAST_SEGMENTS = 12
_FULL_LENGTH = 6.0  # radians of upright lines at which there are surely enough


@dataclass(frozen=True, slots=True, kw_only=True)
class Upright:
    """What a picture says about how its camera stood.

    Attributes:
        pitch_deg: Of the camera, positive looking up.
        roll_deg: Of the camera, positive leaning to its right.
        confidence: 0 to 1; below a half the lines say little.
        segments: How many lines agree.
    """

    pitch_deg: float
    roll_deg: float
    confidence: float
    segments: int

    @property
    def level_from_camera(self) -> Rotation:
        """The rotation that makes the picture level, as far as the lines tell."""
        pitch, roll = np.deg2rad([self.pitch_deg, self.roll_deg]).tolist()
        return Rotation.from_heading_pitch_roll(0.0, pitch, roll)


def find_upright(pixels: NDArray[np.uint8]) -> Upright:
    """Pitch and roll of the camera of a panorama, from upright lines.

    Args:
        pixels: (H, W, 3) uint8, equirectangular, within 25 degrees of level.
    """
    normals, lengths = _segments(pixels)
    if len(normals) < _LEAST_SEGMENTS:
        return Upright(pitch_deg=0.0, roll_deg=0.0, confidence=0.0, segments=0)
    up, contrast = _vote(normals, lengths)
    for width_deg in (2 * _FINE_DEG, _FINE_DEG, _FINE_DEG):
        up = _improved(up, normals, lengths, width_deg)
    off = np.abs(np.rad2deg(np.arcsin(np.clip(normals @ up, -1, 1))))
    agree = off < 2 * _FINE_DEG
    length = float(lengths[agree].sum())
    spread = _spread(normals[agree])
    confidence = min(1.0, length / _FULL_LENGTH) * min(1.0, contrast) * min(1.0, 4 * spread)
    pitch, roll = _pitch_roll(up)
    return Upright(
        pitch_deg=pitch,
        roll_deg=roll,
        confidence=round(confidence, 3),
        segments=int(agree.sum()),
    )


def _segments(pixels: NDArray[np.uint8]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Normals (n, 3) of the great circles of straight segments, and their lengths in radians."""
    gray = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY)
    limit = 2048
    if gray.shape[1] > 1.5 * limit:
        gray = cv2.resize(gray, (limit, limit // 2), interpolation=cv2.INTER_AREA)
    detector = cv2.createLineSegmentDetector(cv2.LSD_REFINE_STD)
    half = np.tan(np.deg2rad(_FOV_DEG) / 2)
    normals, lengths = [], []
    for pitch_deg in _PITCHES_DEG:
        for number in range(_VIEWS):
            pose = Rotation.from_heading_pitch_roll(
                number * 2 * np.pi / _VIEWS, np.deg2rad(pitch_deg)
            )
            view = np.asarray(perspective_view(gray, _SIZE_PX, _SIZE_PX, _FOV_DEG, pose))
            found = detector.detect(view)[0]
            if found is None:
                continue
            ends = np.asarray(found, np.float64).reshape(-1, 2, 2)
            long = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=-1) >= _LEAST_LENGTH_PX
            plane = (ends[long] + 0.5) / _SIZE_PX * 2 - 1
            rays = np.stack(
                [plane[..., 0] * half, -plane[..., 1] * half, -np.ones(plane.shape[:2])], axis=-1
            )
            rays = pose.apply(rays / np.linalg.norm(rays, axis=-1, keepdims=True))
            across = np.cross(rays[:, 0], rays[:, 1])
            sine = np.linalg.norm(across, axis=-1)
            normals.append(across / sine[:, None])
            lengths.append(np.arcsin(np.clip(sine, 0, 1)))
    if not normals:
        return np.zeros((0, 3)), np.zeros(0)
    all_normals, all_lengths = np.concatenate(normals), np.concatenate(lengths)
    # Lines that could be upright at all, within reach of level.
    steep = np.abs(all_normals[:, 1]) < np.sin(np.deg2rad(_REACH_DEG + 2))
    return all_normals[steep], all_lengths[steep]


def _vote(
    normals: NDArray[np.float64], lengths: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """The tilt with the most upright length, and by how much it beats all others (1: clearly)."""
    steps = np.arange(-_REACH_DEG, _REACH_DEG + 1e-6, _COARSE_DEG)
    x, z = np.meshgrid(np.tan(np.deg2rad(steps)), np.tan(np.deg2rad(steps)))
    inside = np.hypot(x, z) <= np.tan(np.deg2rad(_REACH_DEG))
    ups = np.stack([x[inside], np.ones(inside.sum()), z[inside]], axis=-1)
    ups /= np.linalg.norm(ups, axis=-1, keepdims=True)
    votes = np.zeros(len(ups))
    for start in range(0, len(normals), 512):
        part = slice(start, start + 512)
        off = np.rad2deg(ups @ normals[part].T) / _VOTE_DEG
        votes += np.exp(-0.5 * off * off) @ lengths[part]
    best = int(np.argmax(votes))
    far = ups @ ups[best] < np.cos(np.deg2rad(5))
    rival = float(votes[far].max()) if far.any() else 0.0
    return ups[best], float((votes[best] / max(rival, 1e-9) - 1) / 0.5)


def _improved(
    up: NDArray[np.float64],
    normals: NDArray[np.float64],
    lengths: NDArray[np.float64],
    width_deg: float,
) -> NDArray[np.float64]:
    """Up at right angles to the normals that are nearly so already, by least squares."""
    off = np.rad2deg(np.arcsin(np.clip(normals @ up, -1, 1))) / width_deg
    weight = lengths / np.square(1 + np.square(off)) * (np.abs(off) < 4)
    matrix = (normals * weight[:, None]).T @ normals
    values, vectors = np.linalg.eigh(matrix)
    if values[1] <= 1e-12:
        return up
    better = vectors[:, 0] * np.sign(vectors[:, 0] @ up)
    return better if better @ up > np.cos(np.deg2rad(5)) else up


def _spread(normals: NDArray[np.float64]) -> float:
    """How evenly upright lines stand around, 0 to 0.5: lines in one direction tell one angle."""
    if len(normals) < 2:
        return 0.0
    flat = normals[:, [0, 2]]
    values = np.linalg.eigvalsh(flat.T @ flat)
    return float(values[0] / max(values.sum(), 1e-12))


def _pitch_roll(up: NDArray[np.float64]) -> tuple[float, float]:
    """Pitch and roll of a camera in whose frame the world's up is this direction."""
    # The second row of world_from_camera is up as the camera sees it:
    # (-cos pitch sin roll ..., see Rotation.heading_pitch_roll).
    pitch = np.arcsin(np.clip(-up[2], -1, 1))
    roll = np.arctan2(-up[0], up[1])
    return float(np.rad2deg(pitch)), float(np.rad2deg(roll))


def tilt_between(a: Rotation, b: Rotation) -> float:
    """The angle in degrees between where two rotations put up."""
    up = direction_from_azimuth_elevation(0.0, np.pi / 2)
    cosine = float(a.inverse.apply(up) @ b.inverse.apply(up))
    return float(np.rad2deg(np.arccos(np.clip(cosine, -1, 1))))
