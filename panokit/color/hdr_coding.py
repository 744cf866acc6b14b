"""Radiance as numbers that a network can learn, and back.

The 2018 thesis takes the log of radiance, shifted by one, scales it to [0, 1] and stores it as
L*a*b*. The scale is a constant of the dataset and the model, never of the picture: a map that is
twice as bright gets other numbers. What lies beyond the scale is coded beyond 1, not clipped.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.lab import LabScheme, lab_from_rgb, rgb_from_lab
from panokit.errors import UsageError

# L* in [0, 100] becomes [-1, 1]; a* and b* of Rec.709 colors stay within 110.
_LAB_SCALE = np.array([50.0, 110.0, 110.0])
_LAB_SHIFT = np.array([1.0, 0.0, 0.0])


class ColorCode(StrEnum):
    """What becomes of the scaled logs of red, green and blue.

    RGB: 2 v - 1. LAB: L*a*b* with an exact inverse. PIX2PIX: L*a*b* with the rounded matrices
    of earlier networks, whose way back clips to [0, 1].
    """

    RGB = "rgb"
    LAB = "lab"
    PIX2PIX = "pix2pix"


@dataclass(frozen=True, slots=True, kw_only=True)
class HdrCoding:
    """How radiance is coded; kept with every dataset and model.

    Attributes:
        brightest: The radiance that is coded as 1.
        color: See `ColorCode`.
    """

    brightest: float = 1e4
    color: ColorCode = ColorCode.LAB

    def __post_init__(self) -> None:
        if not (np.isfinite(self.brightest) and self.brightest > 0):
            raise UsageError(f"The brightest radiance is positive, not {self.brightest}.")

    @property
    def log_max(self) -> float:
        """The log that becomes 1: ln(1 + brightest)."""
        return float(np.log1p(self.brightest))

    def encode(self, radiance: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """Radiance (..., 3) >= 0 as code values, about -1 to 1, float32."""
        logs = np.asarray(np.log1p(np.asarray(radiance, np.float64)) / self.log_max)
        if self.color is ColorCode.RGB:
            return np.asarray(2 * logs - 1, np.float32)
        lab = lab_from_rgb(logs, self._scheme)
        return np.asarray(lab / _LAB_SCALE - _LAB_SHIFT, np.float32)

    def decode(self, code: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """Code values (..., 3) as radiance >= 0, float32."""
        values = np.asarray(code, np.float64)
        logs: NDArray[np.floating[Any]] = (values + 1) / 2
        if self.color is not ColorCode.RGB:
            logs = rgb_from_lab((values + _LAB_SHIFT) * _LAB_SCALE, self._scheme)
        if self.color is ColorCode.PIX2PIX:
            logs = np.clip(logs, 0, 1)
        return np.asarray(np.expm1(np.maximum(logs, 0) * self.log_max), np.float32)

    def beyond(self, radiance: NDArray[np.floating[Any]]) -> int:
        """How many values are brighter than what is coded as 1."""
        return int((np.asarray(radiance) > self.brightest).sum())

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {"brightest": self.brightest, "color": str(self.color)}

    @classmethod
    def from_json(cls, record: dict[str, Any]) -> "HdrCoding":
        """The coding that `to_json` wrote."""
        return cls(brightest=record["brightest"], color=ColorCode(record["color"]))

    @property
    def _scheme(self) -> LabScheme:
        return LabScheme.PIX2PIX if self.color is ColorCode.PIX2PIX else LabScheme.EXACT
