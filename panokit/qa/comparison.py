"""A map against the map it should be: both in one frame, at one size, on one scale."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError
from panokit.metrics.balls import (
    ball_error,
    ball_error_scale_invariant,
    diffuse_ball,
    mirror_ball,
)
from panokit.metrics.lighting import (
    beyond_clip_ratio,
    energy_ratio,
    irradiance_errors,
    light_vector_error_deg,
    peak_error_deg,
)
from panokit.metrics.pu21 import pu21_crf_psnr, pu21_psnr
from panokit.qa.pairs.aligning import align_pair
from panokit.qa.settings import QaSettings

_BALL_PX = 64
# Equal maps have an infinite PSNR, which JSON cannot hold.
_HIGHEST_PSNR_DB = 100.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """One figure of the difference between a map and its truth.

    Attributes:
        name: A short stable name.
        label: For people.
        value: The figure.
        unit: Of value.
        meaning: What the figure says, in one plain sentence.
    """

    name: str
    label: str
    value: float
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """How a map differs from its truth.

    Attributes:
        reference: The file name of the truth.
        path: Where the truth lies, for pictures of it.
        obstacle: Why they cannot be compared, "" if they can.
        gain: What the map was multiplied by before, because its scale is relative; 1 if not.
        differences: The figures; empty where there is an obstacle.
    """

    reference: str
    path: Path | None = None
    obstacle: str = ""
    gain: float = 1.0
    differences: tuple[Difference, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "reference": self.reference,
            "obstacle": self.obstacle,
            "gain": self.gain,
            "differences": {d.name: d.value for d in self.differences},
        }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pair:
    """Two maps ready to be compared, in units of the camera's white, and balls lit by them.

    Attributes:
        estimate: (H, W, 3), linear.
        truth: (H, W, 3), linear.
        diffuse: The balls of the estimate and of the truth.
        mirror: The balls of the estimate and of the truth.
    """

    estimate: NDArray[np.float32]
    truth: NDArray[np.float32]
    diffuse: tuple[NDArray[np.float32], NDArray[np.float32]]
    mirror: tuple[NDArray[np.float32], NDArray[np.float32]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """How one difference is measured."""

    name: str
    label: str
    unit: str
    meaning: str
    of: Callable[[Pair], float]


MEASURES: tuple[Measure, ...] = (
    Measure(
        name="energy-ratio",
        label="Energy ratio",
        unit="×",
        meaning="All light of the map over that of the reference; 1 is right.",
        of=lambda pair: energy_ratio(pair.estimate, pair.truth),
    ),
    Measure(
        name="source-energy-ratio",
        label="Source energy ratio",
        unit="×",
        meaning="The same where the reference is brighter than the camera's white.",
        of=lambda pair: beyond_clip_ratio(pair.estimate, pair.truth),
    ),
    Measure(
        name="irradiance-error",
        label="Irradiance error",
        unit="%",
        meaning="Mean relative error of the light on surfaces facing the six axes.",
        of=lambda pair: 100 * float(irradiance_errors(pair.estimate, pair.truth).mean()),
    ),
    Measure(
        name="irradiance-error-max",
        label="Worst irradiance error",
        unit="%",
        meaning="The largest of the six.",
        of=lambda pair: 100 * float(irradiance_errors(pair.estimate, pair.truth).max()),
    ),
    Measure(
        name="light-direction",
        label="Light direction",
        unit="°",
        meaning="The angle between the light vectors, where light comes from on the whole.",
        of=lambda pair: light_vector_error_deg(pair.estimate, pair.truth),
    ),
    Measure(
        name="peak-direction",
        label="Peak direction",
        unit="°",
        meaning="The angle between the brightest spots.",
        of=lambda pair: peak_error_deg(pair.estimate, pair.truth),
    ),
    Measure(
        name="diffuse-ball",
        label="Diffuse ball error",
        unit="%",
        meaning="Relative RMSE of a white ball lit by the map.",
        of=lambda pair: 100 * ball_error(*pair.diffuse),
    ),
    Measure(
        name="diffuse-ball-shading",
        label="Diffuse ball shading",
        unit="%",
        meaning="The same after the best gain: direction and contrast of the light alone.",
        of=lambda pair: 100 * ball_error_scale_invariant(*pair.diffuse),
    ),
    Measure(
        name="mirror-ball",
        label="Mirror ball error",
        unit="%",
        meaning="Relative RMSE of a mirror ball; a small sun decides it almost alone.",
        of=lambda pair: 100 * ball_error(*pair.mirror),
    ),
    Measure(
        name="pu21-psnr",
        label="PU21-PSNR",
        unit="dB",
        meaning="Pixel by pixel, as the eye weighs it, with white at 100 cd/m²; 100 is equal.",
        of=lambda pair: min(pu21_psnr(pair.estimate, pair.truth), _HIGHEST_PSNR_DB),
    ),
    Measure(
        name="pu21-psnr-toned",
        label="PU21-PSNR, tone fitted",
        unit="dB",
        meaning="The same after a tone and color curve is fitted: a wrong camera curve is free.",
        of=lambda pair: min(pu21_crf_psnr(pair.estimate, pair.truth), _HIGHEST_PSNR_DB),
    ),
)


def compare(
    envmap: EnvironmentMap,
    truth: EnvironmentMap,
    settings: QaSettings | None = None,
    *,
    path: Path | None = None,
) -> Comparison:
    """Measure how a map differs from its truth.

    Where the scales are not one and the same absolute scale, the map is first multiplied by
    the gain that fits it to the truth in the pixels that a camera would not clip.

    Args:
        envmap: The map.
        truth: The map it should be.
        settings: The size at which they are compared.
        path: Where the truth was read from.
    """
    settings = settings or QaSettings()
    reference = path.name if path else ""
    try:
        aligned = align_pair(envmap, truth, settings.comparison_width_px)
    except ItemError as error:
        return Comparison(reference=reference, path=path, obstacle=str(error))
    pair = _pair(aligned.estimate, aligned.truth)
    measured = [(measure, measure.of(pair)) for measure in MEASURES]
    return Comparison(
        reference=reference,
        path=path,
        gain=aligned.gain,
        differences=tuple(
            Difference(
                name=measure.name,
                label=measure.label,
                value=value,
                unit=measure.unit,
                meaning=measure.meaning,
            )
            for measure, value in measured
            if np.isfinite(value)
        ),
    )


def _pair(estimate: NDArray[np.float32], truth: NDArray[np.float32]) -> Pair:
    return Pair(
        estimate=estimate,
        truth=truth,
        diffuse=(diffuse_ball(estimate, _BALL_PX), diffuse_ball(truth, _BALL_PX)),
        mirror=(mirror_ball(estimate, _BALL_PX), mirror_ball(truth, _BALL_PX)),
    )
