"""One method on one picture: every figure of the table."""

import resource
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, weighted_percentile
from panokit.color.camera import CAMERA_A, CAMERA_B, Camera, photograph
from panokit.errors import ItemError
from panokit.evaluate.predictors import Predictor
from panokit.evaluate.probe_set import ListedProbe
from panokit.metrics import (
    diffuse_ball,
    log_rmse,
    rgb_angular_deg,
    score_expansion,
    sun_energy_stops,
)
from panokit.metrics.expansion import BALL_PX
from panokit.sphere import row_solid_angles

CAMERAS: Mapping[str, Camera] = {"A": CAMERA_A, "B": CAMERA_B}
# Multiples of every stride up to 256 pixels; and rolls that are multiples of no stride.
STRIDE_ROLLS_PX = (256, 512)
OTHER_ROLLS_PX = (1, 37, 211)
# A scene whose brightest point is this many times its 90th percentile has a sun or a bare lamp.
STRONG_RATIO = 1e4
_FIRST_SEED = 1_000_000_000
_LOG_FLOOR = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """A test picture with its truth.

    Attributes:
        probe: What it shows.
        fold: Of the probe.
        camera: "A" or "B".
        pixels: (512, 1024, 3) uint8.
        truth: (512, 1024, 3) float32, in units of the clip level.
    """

    probe: ListedProbe
    fold: int
    camera: str
    pixels: NDArray[np.uint8]
    truth: NDArray[np.float32]

    @property
    def is_strong(self) -> bool:
        """Whether the scene has a strong source; see `STRONG_RATIO`."""
        light = luminance(self.truth)
        weights = row_solid_angles(*light.shape)[:, None]
        bright = weighted_percentile(light, weights, 90)
        return bool(light.max() > STRONG_RATIO * max(bright, 1e-12))


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """What came of one method on one picture.

    Attributes:
        method: The column's heading.
        probe: Its name.
        category: Of the probe.
        camera: "A" or "B".
        fold: Of the probe.
        seen: Whether the method was trained on the probe; None if nobody says.
        strong: Whether the scene has a strong source.
        values: Name -> figure; None where there is none.
        failed: Why there are no figures, or "".
    """

    method: str
    probe: str
    category: str
    camera: str
    fold: int
    seen: bool | None
    strong: bool
    values: Mapping[str, float | None]
    failed: str = ""

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {name: getattr(self, name) for name in self.__slots__} | {
            "values": dict(self.values)
        }


def take_picture(
    probe: ListedProbe, radiance: NDArray[np.float32], camera: str, *, index: int, fold: int
) -> Picture:
    """The test picture of a probe; `index` is its place in the sorted list, and the seed."""
    shot = photograph(radiance, CAMERAS[camera], seed=_FIRST_SEED + index)
    truth = radiance * np.float32(shot.exposure)
    return Picture(probe=probe, fold=fold, camera=camera, pixels=shot.pixels, truth=truth)


def score_picture(method: str, predictor: Predictor, picture: Picture, *, rolled: bool) -> Row:
    """Judge a method on a picture; what it cannot do is a row that says so.

    Args:
        method: Its heading.
        predictor: For the picture's fold.
        picture: To judge on.
        rolled: Whether to see what turning the picture changes, too.
    """
    values: dict[str, float | None] = {}
    failed = ""
    try:
        values = _values(predictor, picture, rolled=rolled)
    except ItemError as error:
        failed = f"{error.reason}: {error}"
    return Row(
        method=method,
        probe=picture.probe.name,
        category=picture.probe.category,
        camera=picture.camera,
        fold=picture.fold,
        seen=predictor.has_seen(picture.probe),
        strong=picture.is_strong,
        values=values,
        failed=failed,
    )


def _values(predictor: Predictor, picture: Picture, *, rolled: bool) -> dict[str, float | None]:
    started = _cpu_seconds()
    light = _checked(predictor.predict(picture.pixels))
    seconds = _cpu_seconds() - started
    values = _figures(light, picture)
    values["cpu_seconds"] = seconds
    if rolled:
        for shift in (*STRIDE_ROLLS_PX, *OTHER_ROLLS_PX):
            turned = _checked(predictor.predict(np.roll(picture.pixels, shift, axis=1)))
            values[f"roll_{shift}"] = change_in_decades(np.roll(turned, -shift, axis=1), light)
    return {
        name: round(value, 6) if value is not None and np.isfinite(value) else None
        for name, value in values.items()
    }


def change_in_decades(light: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """The mean change of log10 luminance between two maps, (H, W, 3), over all pixels.

    Darker than a thousandth of the median luminance counts as that.
    """
    first, second = luminance(light), luminance(other)
    floor = _LOG_FLOOR * max(float(np.median(second)), 1e-12)
    return float(np.abs(np.log10((first + floor) / (second + floor))).mean())


def _figures(light: NDArray[np.float32], picture: Picture) -> dict[str, float | None]:
    score = score_expansion(light, picture.truth, picture.pixels)
    aligned = light * np.float32(score.gain)
    ball, true_ball = diffuse_ball(aligned, BALL_PX), diffuse_ball(picture.truth, BALL_PX)
    shades = luminance(aligned)
    return {
        **score.to_json(),
        "ball_color_deg": rgb_angular_deg(_square(ball), _square(true_ball), weighting="pixel"),
        "log_rmse": log_rmse(aligned, picture.truth, floor=_LOG_FLOOR),
        "sun_stops": sun_energy_stops(aligned, picture.truth),
        "range_decades": float(
            np.log10(max(float(shades.max()), 1e-9) / max(float(np.median(shades)), 1e-9))
        ),
    }


def _square(ball: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.ascontiguousarray(ball[..., :3] * ball[..., 3:])


def _checked(light: NDArray[np.float32]) -> NDArray[np.float32]:
    if not np.isfinite(light).all() or float(light.max()) <= 0:
        raise ItemError("The answer is black or not finite.", reason="no-light")
    return np.asarray(light, np.float32)


def _cpu_seconds() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime
