"""What may be wrong with a record when the sun stands elsewhere: the clock, the heading, a flip."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np
from numpy.typing import NDArray

from panokit.frames import angle_between
from panokit.sun import sun_direction

# A clock error explains the sun if this little is left of the angle.
_FITS_CLOCK_DEG = 3.0
_FITS_DEG = 6.0
_DAYLIGHT_SAVING_H = (1.0, 2.0)
_ZONE_STEP_H = (-1.0, -0.5, 0.0, 0.5, 1.0)
_DEGREES_PER_HOUR = 15.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """A clock error.

    Attributes:
        hours: What the recorded time is ahead of the true one.
        words: What it may be, "" for none.
    """

    hours: float
    words: str

    def __str__(self) -> str:
        return (
            f"a clock {abs(self.hours):g} h {'fast' if self.hours > 0 else 'slow'} ({self.words})"
        )


# What a map's sun may have suffered, undone: the sun's true direction if it did.
_UNDONE: tuple[tuple[str, Callable[[NDArray[np.float64]], NDArray[np.float64]]], ...] = (
    ("a picture flipped left to right", lambda d: d * np.array([-1.0, 1.0, 1.0])),
    ("a heading off by 180°", lambda d: d * np.array([-1.0, 1.0, -1.0])),
    ("a picture flipped and turned by 180°", lambda d: d * np.array([1.0, 1.0, -1.0])),
    ("a heading off by 90° one way", lambda d: np.array([d[2], d[1], -d[0]])),
    ("a heading off by 90° the other way", lambda d: np.array([-d[2], d[1], d[0]])),
)


def explanations(
    found: NDArray[np.float64], expected: NDArray[np.float64], allowance_deg: float = 0.0
) -> str:
    """The errors of heading and of handedness that would explain a sun, in words, best first.

    Args:
        found: (3,) unit direction toward the map's sun, in the world frame as recorded.
        expected: (3,) unit direction toward where it stood.
        allowance_deg: By how much the first is uncertain.
    """
    fits = []
    for words, undo in _UNDONE:
        angle = float(np.degrees(angle_between(undo(found), expected)))
        if angle <= _FITS_DEG + allowance_deg:
            fits.append((angle, words))
    return " or ".join(words for _, words in sorted(fits))


def best_clock(
    found: NDArray[np.float64], latitude_deg: float, longitude_deg: float, time: datetime
) -> tuple[float, Hypothesis] | None:
    """The clock error that explains a sun best, with the angle in degrees that is left; or None.

    Asked are daylight saving time, once and twice, and local time taken for UTC or the reverse,
    by the zone that the longitude suggests, and its neighbors.
    """
    fits = []
    for hypothesis in _clock_errors(longitude_deg):
        then = time - timedelta(hours=hypothesis.hours)
        expected = sun_direction(latitude_deg, longitude_deg, then)
        angle = float(np.degrees(angle_between(found, expected)))
        if angle <= _FITS_CLOCK_DEG:
            fits.append((angle, abs(hypothesis.hours), hypothesis))
    if not fits:
        return None
    angle, _, hypothesis = min(fits, key=lambda fit: fit[:2])
    return angle, hypothesis


def _clock_errors(longitude_deg: float) -> list[Hypothesis]:
    zone = float(round(longitude_deg / _DEGREES_PER_HOUR))
    errors = {}
    for step in _ZONE_STEP_H:
        for hours, words in (
            (zone + step, "local time taken for UTC"),
            (-(zone + step), "UTC taken for local time"),
        ):
            errors[hours] = words
    for hours in _DAYLIGHT_SAVING_H:
        for signed in (hours, -hours):
            errors[signed] = "daylight saving time or a neighboring zone"
    return [Hypothesis(hours=h, words=w) for h, w in sorted(errors.items()) if h != 0]
