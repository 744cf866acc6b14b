"""Bracketed exposures of one picture to its radiance.

Each picture tells the radiance where it is neither clipped nor dark: the curve's inverse of
its code over its exposure. The mean of what all tell is weighted with how exactly they can
(one code is a smaller share of the light in a longer exposure). What moved between two
pictures is told by one of them only, the reference and those that agree with it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode
from panokit.errors import ImageError, UsageError

Curve = Literal["srgb", "debevec"]

_DARK_CODE, _CLIPPED_CODE = 3, 253
_NOISY_CODE = 24
# A change by an eighth in the mean over so many pixels is no compression.
_GHOST_LOG, _GHOST_PX = 0.14, 9
_MIDDLE_CODE = 128
_LEAST_FACTOR = 1.05


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MergedBrackets:
    """What bracketed pictures say together.

    Attributes:
        radiance: (H, W, 3) float32, linear; 1.0 is white in the reference picture.
        ghosts: (H, W) bool: something moved here; fewer pictures were used.
        curve: (256, 3) linear light of each code, white 1.
        values: What was found out, as JSON values.
    """

    radiance: NDArray[np.float32]
    ghosts: NDArray[np.bool_]
    curve: NDArray[np.float32]
    values: dict[str, Any] = field(default_factory=dict)


def merge_brackets(
    pictures: Sequence[NDArray[np.uint8]],
    exposures: Sequence[float],
    *,
    curve: Curve | NDArray[np.floating[Any]] = "srgb",
    deghost: bool = True,
) -> MergedBrackets:
    """Merge pictures of one scene, taken from one place with different exposures.

    Args:
        pictures: (H, W, 3) uint8 each, aligned.
        exposures: Of each picture, in any unit that is proportional to the light taken in:
            seconds at one aperture and sensitivity.
        curve: The camera's: "srgb", "debevec" to recover it from the pictures (Debevec and
            Malik 1997, "Recovering high dynamic range radiance maps from photographs"), or
            the linear light of each code, (256,) or (256, 3).
        deghost: Leave out what moved.

    Raises:
        UsageError: If pictures and exposures do not go together.
        ImageError: If there are fewer than two different exposures ("one-exposure").
    """
    _check(pictures, exposures)
    order = np.argsort(exposures)
    shots = [pictures[i] for i in order]
    times = np.asarray([exposures[i] for i in order], np.float64)
    table = _curve(curve, shots, times)
    reference = _reference(shots)
    relative = times / times[reference]
    weights_table = _weights(table)
    total = np.zeros(shots[0].shape, np.float32)
    weight = np.zeros(shots[0].shape, np.float32)
    ghosts = np.zeros(shots[0].shape[:2], np.bool_)
    for index in sorted(range(len(shots)), key=lambda i: (abs(i - reference), i)):
        light = _looked_up(shots[index], table / np.float32(relative[index]))
        trust = _looked_up(shots[index], weights_table * np.float32(relative[index] ** 2))
        # Compression spreads the error of a clipped pixel over those beside it.
        near = cv2.dilate(shots[index].max(axis=-1), np.ones((5, 5), np.uint8)) >= _CLIPPED_CODE
        trust[near] = 0
        if deghost and index != reference:
            moved = _moved(light, trust, total, weight, shots[index])
            trust[moved] = 0
            ghosts |= moved
        total += light * trust
        weight += trust
    radiance = _with_ends(total, weight, shots, table, relative)
    clipped = (shots[0].min(axis=-1) >= _CLIPPED_CODE).mean()
    return MergedBrackets(
        radiance=radiance,
        ghosts=ghosts,
        curve=table,
        values={
            "exposures": times.tolist(),
            "reference": int(order[reference]),
            "reference_exposure": float(times[reference]),
            "ghost_share": round(float(ghosts.mean()), 5),
            "clipped_share": round(float(clipped), 6),
            "curve": curve if isinstance(curve, str) else "given",
        },
    )


def _curve(
    curve: Curve | NDArray[np.floating[Any]],
    shots: Sequence[NDArray[np.uint8]],
    times: NDArray[np.float64],
) -> NDArray[np.float32]:
    srgb = srgb_decode(np.arange(256, dtype=np.float32) / 255)
    if not isinstance(curve, str):
        given = np.asarray(curve, np.float32)
        given = given[:, None].repeat(3, 1) if given.ndim == 1 else given
        rising = given.shape == (256, 3) and bool((np.diff(given, axis=0) >= 0).all())
        if not rising or not np.isfinite(given).all() or float(given[-1].min()) <= 0:
            raise UsageError("A camera's curve is 256 rising values, or 256x3; it ends above 0.")
        return np.asarray(given / given[-1], np.float32)
    if curve == "srgb":
        return np.repeat(srgb[:, None], 3, axis=1)
    if curve != "debevec":
        raise UsageError(f'The curve is "srgb", "debevec" or 256 values, not {curve!r}.')
    calibrate = cv2.createCalibrateDebevec(samples=120, lambda_=20.0, random=False)
    response = np.asarray(calibrate.process(list(shots), times.astype(np.float32)), np.float64)
    response = np.maximum.accumulate(response.reshape(256, 3), axis=0)
    # The ends are hardly seen by it. A middle code is taken as what sRGB says it is.
    scaled = response / response[_MIDDLE_CODE] * srgb[_MIDDLE_CODE]
    return np.asarray(scaled, np.float32)


def _reference(shots: Sequence[NDArray[np.uint8]]) -> int:
    """The picture with the most codes that are neither dark nor clipped."""
    usable = [float(((shot > 20) & (shot < 240)).all(axis=-1).mean()) for shot in shots]
    return int(np.argmax(usable))


def _weights(table: NDArray[np.float32]) -> NDArray[np.float32]:
    """How exactly a code tells its light: one over the square of what a code is worth."""
    codes = np.arange(256, dtype=np.float32)
    hat = np.clip((codes - _DARK_CODE) / 20, 0, 1) * np.clip((_CLIPPED_CODE - codes) / 12, 0, 1)
    step = np.maximum(np.gradient(table, axis=0), 1e-5)
    return np.asarray(hat[:, None] / np.square(step) * 1e-5, np.float32)


def _looked_up(shot: NDArray[np.uint8], table: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(cv2.LUT(shot, np.ascontiguousarray(table, np.float32)[None]))


def _moved(
    light: NDArray[np.float32],
    trust: NDArray[np.float32],
    total: NDArray[np.float32],
    weight: NDArray[np.float32],
    shot: NDArray[np.uint8],
) -> NDArray[np.bool_]:
    """(H, W): where a picture contradicts those before it over more than a few pixels.

    Compression errs by much in single pixels, most of all beside clipped ones, but not in the
    mean over a neighborhood.
    """
    both = ((trust > 0) & (weight > 0)).all(axis=-1) & (shot.min(axis=-1) > _NOISY_CODE)
    known = (total / np.where(weight > 0, weight, 1)).mean(axis=-1)
    size = (_GHOST_PX, _GHOST_PX)
    count = cv2.blur(both.astype(np.float32), size)
    here = cv2.blur(np.where(both, light.mean(axis=-1), 0).astype(np.float32), size)
    there = cv2.blur(np.where(both, known, 0).astype(np.float32), size)
    ratio = np.log(np.maximum(here, 1e-7) / np.maximum(there, 1e-7))
    seed = (np.abs(ratio) > _GHOST_LOG) & (count > 0.3)
    square = np.ones((3, 3), np.uint8)
    seed_bytes = cv2.morphologyEx(seed.astype(np.uint8), cv2.MORPH_OPEN, square)
    grown = cv2.dilate(seed_bytes, np.ones(size, np.uint8)) > 0
    # What no other picture tells stays.
    return np.asarray(grown & (weight > 0).all(axis=-1))


def _with_ends(
    total: NDArray[np.float32],
    weight: NDArray[np.float32],
    shots: Sequence[NDArray[np.uint8]],
    table: NDArray[np.float32],
    relative: NDArray[np.float64],
) -> NDArray[np.float32]:
    """The mean; what is clipped in all pictures is as bright as the shortest can tell."""
    told = weight > 0
    radiance = total / np.where(told, weight, 1)
    brightest = _looked_up(shots[0], table / np.float32(relative[0]))
    darkest = _looked_up(shots[-1], table / np.float32(relative[-1]))
    ends = np.where(shots[0] >= _CLIPPED_CODE, brightest, darkest)
    # Between the two, only ghosts are told by nobody; the shortest is not clipped there.
    untold = ~told & (shots[0] < _CLIPPED_CODE) & (shots[-1] > _DARK_CODE)
    ends = np.where(untold, brightest, ends)
    return np.asarray(np.where(told, radiance, ends), np.float32)


def _check(pictures: Sequence[NDArray[np.uint8]], exposures: Sequence[float]) -> None:
    if len(pictures) != len(exposures):
        raise UsageError(
            f"Each picture needs an exposure: got {len(pictures)} and {len(exposures)}."
        )
    values = np.asarray(exposures, np.float64)
    if not np.all(np.isfinite(values)) or not np.all(values > 0):
        raise UsageError(f"Exposures are finite and above 0, not {list(exposures)}.")
    if len(pictures) < 2 or values.max() < values.min() * _LEAST_FACTOR:
        raise ImageError(
            "Brackets are at least two pictures with different exposures. Check the exposures, "
            "or stitch the picture as it is.",
            reason="one-exposure",
        )
    for picture in pictures:
        if picture.dtype != np.uint8 or picture.ndim != 3 or picture.shape != pictures[0].shape:
            raise ImageError(
                "Brackets are uint8 RGB pictures of one size. Export them alike.",
                reason="wrong-size",
            )
