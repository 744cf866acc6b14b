"""Maps that show the same thing: copies at another yaw, size or exposure, and shared places.

Candidates are the nearest by a signature that no yaw, exposure or mirroring changes; a candidate
is confirmed by correlating fine detail at every yaw. Clear skies look alike, but their detail is
their own.
"""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from panokit.capture import Capture
from panokit.qa.sets.nearest import align
from panokit.qa.sets.places import distance_m, near_on_the_ground
from panokit.qa.sets.store import DETAIL_WIDTH_PX, Description

# Correlations of detail. Of 77 captured maps no two of different scenes have more than 0.39 over
# the whole sphere or 0.52 over a half; copies through a camera's clipping and JPEG have 0.5 to 1.
COPY = 0.5
HALF = 0.65
# What the other half has less than where only one half is shared.
_OTHER_HALF = 0.3
# A featureless map has no detail to be known by.
_LEAST_DETAIL_STOPS = 0.004
_CANDIDATES = 12
_TURNS = 4 * DETAIL_WIDTH_PX
_SAME_PLACE_M = 10.0
_MIDDLE = DETAIL_WIDTH_PX // 4


class Likeness(StrEnum):
    """How two maps are one."""

    COPY = "copy"
    UPPER = "same sky"
    LOWER = "same ground"
    PLACE = "same place"


_PARTS = {
    Likeness.COPY: slice(None),
    Likeness.UPPER: slice(None, _MIDDLE),
    Likeness.LOWER: slice(_MIDDLE, None),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class NearDuplicate:
    """Two maps that are not independent of each other.

    Attributes:
        first: The name of one, with its set: "augmented/NAME" or "reference/NAME".
        second: The name of the other.
        likeness: What they share.
        correlation: Of their detail at the best yaw, over what they share; None where only
            their places are near.
        yaw_deg: By how much the second is turned to the right to fit the first; None likewise.
        mirrored: Whether the second has to be mirrored as well.
        distance_m: Between the places of their captures, None where these are not known.
    """

    first: str
    second: str
    likeness: Likeness
    correlation: float | None = None
    yaw_deg: float | None = None
    mirrored: bool = False
    distance_m: float | None = None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {**asdict(self), "likeness": str(self.likeness)}


def find_near_duplicates(
    names: Sequence[str],
    descriptions: Sequence[Description],
    captures: Sequence[Capture | None] | None = None,
    *,
    apart: Iterable[tuple[int, int]] = (),
) -> list[NearDuplicate]:
    """All pairs of maps that share their scene, the most alike first.

    Args:
        names: Of the maps.
        descriptions: Of the same maps.
        captures: Where they are from; pairs that look different but are within 10 m are told.
        apart: Pairs that are known, such as a map and its own truth, and are left out.
    """
    places = captures or [None] * len(names)
    known = {(min(pair), max(pair)) for pair in apart}
    found = []
    for i, j in _candidates(descriptions, places):
        if (i, j) in known:
            continue
        meters = distance_m(places[i], places[j])
        same = _same_scene(descriptions[i].detail, descriptions[j].detail)
        if same is None and meters is not None and meters < _SAME_PLACE_M:
            same = {"likeness": Likeness.PLACE}
        if same is not None:
            found.append(NearDuplicate(first=names[i], second=names[j], distance_m=meters, **same))
    return sorted(found, key=lambda pair: (-(pair.correlation or 0.0), pair.first, pair.second))


def _candidates(
    descriptions: Sequence[Description], places: Sequence[Capture | None]
) -> list[tuple[int, int]]:
    """Pairs (i < j) that are near in signature or on the ground."""
    if len(descriptions) < 2:
        return []
    signatures = np.stack([description.signature for description in descriptions])
    count = min(_CANDIDATES + 1, len(descriptions))
    _, near = cKDTree(signatures).query(signatures, k=count)
    pairs = {(min(i, int(j)), max(i, int(j))) for i, row in enumerate(near) for j in row}
    pairs |= set(near_on_the_ground(places, _SAME_PLACE_M))
    return sorted((i, j) for i, j in pairs if i != j)


def _same_scene(first: NDArray[np.float32], second: NDArray[np.float32]) -> dict[str, Any] | None:
    """What two maps share, judged by their detail; None if nothing."""
    found = []
    for mirrored in (False, True):
        other = second[:, ::-1] if mirrored else second
        fits = {part: _fit(first, other, rows) for part, rows in _PARTS.items()}
        likeness = _likeness({part: fit[0] for part, fit in fits.items()})
        if likeness is not None:
            correlation, yaw_deg = fits[likeness]
            found.append((correlation, likeness, yaw_deg, mirrored))
    if not found:
        return None
    correlation, likeness, yaw_deg, mirrored = max(found, key=lambda fit: fit[0])
    return {
        "likeness": likeness,
        "correlation": correlation,
        "yaw_deg": yaw_deg,
        "mirrored": mirrored,
    }


def _likeness(correlations: dict[Likeness, float | None]) -> Likeness | None:
    upper, lower = correlations[Likeness.UPPER], correlations[Likeness.LOWER]
    for part, this, other in ((Likeness.UPPER, upper, lower), (Likeness.LOWER, lower, upper)):
        if (this or 0) >= HALF and other is not None and other < _OTHER_HALF:
            return part
    whole = correlations[Likeness.COPY]
    return Likeness.COPY if whole is not None and whole >= COPY else None


def _fit(
    first: NDArray[np.float32], second: NDArray[np.float32], rows: slice
) -> tuple[float | None, float]:
    """The correlation of some rows at the best yaw, and that yaw; None where there is no detail."""
    a, b = np.zeros_like(first), np.zeros_like(first)
    a[rows], b[rows] = first[rows], second[rows]
    if min(float(a[rows].std()), float(b[rows].std())) < _LEAST_DETAIL_STOPS:
        return None, 0.0
    fit = align(a[None], b[None], _TURNS)
    yaw_deg = (float(np.degrees(fit.yaw[0, 0])) + 180) % 360 - 180
    return float(fit.correlation[0, 0]), yaw_deg
