"""The scale on which holes are filled: gray levels, for photographs and for HDR maps alike.

Fillings mix and compare values. On linear radiance that would be wrong: one bright neighbor
outweighs a hundred others, and bleeds. So HDR radiance is filled on a logarithmic scale, set by
the surroundings of the hole, on which equal ratios are about equal differences.
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

# Where the median of the surroundings lies, and how far below it the scale becomes linear.
_MEDIAN_LEVEL = 110.0
_DARK_SHARE = 1 / 16


class Coding(Protocol):
    """To gray levels, about 0 to 255, and back."""

    def encode(self, values: NDArray[Any]) -> NDArray[np.float32]:
        """The picture's values as gray levels, float32."""
        ...

    def decode(self, levels: NDArray[np.float32]) -> NDArray[Any]:
        """Gray levels as values of the picture, in its dtype."""
        ...


@dataclass(frozen=True, slots=True)
class DisplayCoding:
    """8-bit pictures are in gray levels already."""

    def encode(self, values: NDArray[Any]) -> NDArray[np.float32]:
        """As float32."""
        return values.astype(np.float32)

    def decode(self, levels: NDArray[np.float32]) -> NDArray[Any]:
        """Rounded, uint8."""
        return np.clip(np.rint(levels), 0, 255).astype(np.uint8)


@dataclass(frozen=True, slots=True)
class LogCoding:
    """Radiance on a logarithmic scale: level = k log(1 + L / dark).

    Attributes:
        dark: The radiance below which the scale is about linear.
        per_e: k, gray levels for each factor of e.
    """

    dark: float
    per_e: float

    @classmethod
    def around(cls, radiance: NDArray[np.floating]) -> "LogCoding":
        """The scale on which these surroundings of a hole are mid gray.

        Args:
            radiance: (..., 3), linear; all black is allowed.
        """
        mean = radiance.reshape(-1, 3).mean(axis=1)
        lit = mean[mean > 0]
        median = float(np.median(lit)) if len(lit) else 1.0
        return cls(median * _DARK_SHARE, _MEDIAN_LEVEL / float(np.log1p(1 / _DARK_SHARE)))

    def encode(self, values: NDArray[Any]) -> NDArray[np.float32]:
        """Levels; a lamp ten thousand times brighter than its surroundings has 465."""
        scaled = np.asarray(values, np.float32) / np.float32(self.dark)
        return np.asarray(np.float32(self.per_e) * np.log1p(scaled), np.float32)

    def decode(self, levels: NDArray[np.float32]) -> NDArray[Any]:
        """Radiance, float32, not negative."""
        scaled = np.expm1(np.maximum(levels, 0) / np.float32(self.per_e))
        return np.asarray(scaled * np.float32(self.dark), np.float32)
