"""The horizontal axis of a chart: its range, and round numbers on it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.report.values import Mark
from panokit.report.wording import format_limit

_MOST_TICKS = 6
# A mark farther from the values than this share of their range is not worth the room.
_REACH = 0.6


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """From values to places in a picture.

    Attributes:
        low: The left end; a power of ten where `log`.
        high: The right end.
        log: Whether places go with the logarithm.
        span: Left and right in the picture.
        ticks: Place in the picture, and label.
        marks: Those that lie on the axis.
    """

    low: float
    high: float
    log: bool
    span: tuple[float, float]
    ticks: tuple[tuple[float, str], ...] = ()
    marks: tuple[Mark, ...] = ()

    def at(self, scaled: float) -> float:
        """The place of a value that is scaled already."""
        left, right = self.span
        return round(left + (scaled - self.low) / (self.high - self.low) * (right - left), 2)

    def place(self, value: float) -> float:
        """The place of a value."""
        return self.at(_scaled(value, self.log))

    def scaled(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values as the axis counts."""
        return np.log10(values) if self.log else values

    def unscaled(self, scaled: float) -> float:
        """A value again."""
        return float(10.0**scaled) if self.log else scaled


def axis_of(
    sets: Sequence[NDArray[np.float64]],
    marks: Sequence[Mark],
    *,
    log: bool,
    span: tuple[float, float],
) -> Axis:
    """The axis for all values, and for those marks that are not far off."""
    usable = [m for m in marks if np.isfinite(m.value) and (m.value > 0 or not log)]
    low, high = _range(np.concatenate(list(sets)), [_scaled(m.value, log) for m in usable], log)
    axis = Axis(low=low, high=high, log=log, span=span)
    return Axis(
        low=low,
        high=high,
        log=log,
        span=span,
        ticks=tuple(
            (axis.at(place), label)
            for place, label in (_log_ticks(low, high) if log else _ticks(low, high))
        ),
        marks=tuple(m for m in usable if low <= _scaled(m.value, log) <= high),
    )


def _range(values: NDArray[np.float64], marks: Sequence[float], log: bool) -> tuple[float, float]:
    if not len(values):
        return 0.0, 1.0
    scaled = np.log10(values) if log else values
    low, high = float(scaled.min()), float(scaled.max())
    span = (high - low) or abs(high) * 0.1 or 1.0
    for mark in marks:
        if low - _REACH * span <= mark <= high + _REACH * span:
            low, high = min(low, mark), max(high, mark)
    if high == low:
        low, high = low - span / 2, high + span / 2
    # A mark at the very edge would be cut in half by it.
    room = 0.02 * (high - low)
    return low - (room if log or low != 0 else 0), high + room


def _scaled(value: float, log: bool) -> float:
    return float(np.log10(value)) if log else float(value)


def _ticks(low: float, high: float) -> list[tuple[float, str]]:
    """Round numbers, at most six."""
    rough = (high - low) / (_MOST_TICKS - 1)
    power = 10.0 ** np.floor(np.log10(rough))
    step = next(f * power for f in (1, 2, 5, 10) if f * power >= rough * (1 - 1e-9))
    numbers = np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step
    # Plus 0.0: no tick is called minus nothing.
    return [(float(n), format_limit(float(f"{n:.6g}") + 0.0)) for n in numbers]


def _log_ticks(low: float, high: float) -> list[tuple[float, str]]:
    """Powers of ten; with 2 and 5 between them where there are few."""
    factors = (1.0,) if high - low > 2 else (1.0, 2.0, 5.0)
    powers = range(int(np.floor(low)), int(np.ceil(high)) + 1)
    numbers = [f * 10.0**p for p in powers for f in factors]
    inside = [n for n in numbers if low <= np.log10(n) <= high]
    stride = -(-len(inside) // _MOST_TICKS) or 1
    return [(float(np.log10(n)), format_limit(float(f"{n:.6g}"))) for n in inside[::stride]]
