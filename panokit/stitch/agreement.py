"""Whether overlapping views show the same, and if not, which sign of their poses may be wrong."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from panokit.capture import View
from panokit.errors import ImageError
from panokit.stitch.overlaps import Overlaps, Thumbnail, sample_overlaps

_GRID_PX = 128
_LEAST_PLACES, _LEAST_SPREAD = 24, 0.03
# Correlation of what overlapping views show, at which they surely do not belong together, and
# what another reading of the poses must reach to be named.
_DISAGREE, _AGREE = 0.25, 0.55

# Poses as they are read when somebody's conventions differ from ours.
_READINGS: dict[str, Callable[[View], View]] = {
    "heading_deg counted counterclockwise": lambda v: replace(v, heading_deg=-v.heading_deg),
    "pitch_deg positive looking down": lambda v: replace(v, pitch_deg=-v.pitch_deg),
    "roll_deg positive leaning left": lambda v: replace(v, roll_deg=-v.roll_deg),
    "pitch_deg as a tilt that is 90 at the horizon": lambda v: replace(
        v, pitch_deg=v.pitch_deg - 90
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """How much overlapping views look alike.

    Attributes:
        score: Mean correlation over all overlaps with structure, weighted with their size.
        pairs: How many pairs of views overlap enough, and have enough structure, to tell.
    """

    score: float
    pairs: int


def check_agreement(small: Sequence[Thumbnail], samples: Overlaps) -> Agreement:
    """How much views agree.

    Args:
        small: Small copies of all views.
        samples: What they show of the same directions.

    Raises:
        ImageError: If they show different things where they overlap ("views-disagree"); the
            message names the other reading of the poses that would make them agree, if one
            does.
    """
    found = agreement(samples)
    if found.pairs == 0 or found.score >= _DISAGREE:
        return found
    named = [name for name, reading in _READINGS.items() if _score(small, reading) >= _AGREE]
    advice = (
        f"They would agree with {named[0]}: change the sign or the origin of that angle."
        if named
        else "Check signs and order of heading, pitch and roll, the field of view, and that all "
        "views are of one place."
    )
    raise ImageError(
        f"The {len(small)} views contradict each other where they overlap (correlation "
        f"{found.score:.2f} over {found.pairs} pairs). {advice}",
        reason="views-disagree",
        values={"agreement": round(found.score, 3), "pairs": found.pairs},
    )


def agreement(samples: Overlaps) -> Agreement:
    """The mean correlation of log brightness over the overlaps of all pairs."""
    logs = np.log(samples.linear.mean(axis=-1) + np.float32(0.01))
    seen = (samples.weight > 0).astype(np.float32)
    logs *= seen
    # Sums over the directions that both of two views show, for all pairs at once.
    count, first = seen @ seen.T, logs @ seen.T
    square, product = np.square(logs) @ seen.T, logs @ logs.T
    number = np.maximum(count, 1)
    spread = square / number - np.square(first / number)
    together = product / number - first * first.T / np.square(number)
    # Empty sky agrees with anything.
    least = np.minimum(spread, spread.T)
    pairs = np.triu((count >= _LEAST_PLACES) & (least > _LEAST_SPREAD**2), 1)
    scores = (together / np.sqrt(np.maximum(spread * spread.T, 1e-12)))[pairs]
    if not scores.size:
        return Agreement(score=1.0, pairs=0)
    return Agreement(score=float(np.average(scores, weights=count[pairs])), pairs=scores.size)


def _score(small: Sequence[Thumbnail], reading: Callable[[View], View]) -> float:
    read = [replace(one, view=reading(one.view)) for one in small]
    found = agreement(sample_overlaps(read, _GRID_PX))
    return found.score if found.pairs else 0.0
