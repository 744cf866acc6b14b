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
# A featureless map has no detail to be known by.
_LEAST_DETAIL_STOPS = 0.004
_CANDIDATES = 12
_TURNS = 4 * DETAIL_WIDTH_PX
_SAME_PLACE_M = 10.0


class Likeness(StrEnum):
    """How two maps are one."""

    COPY = "copy"
    UPPER = "same sky"
    LOWER = "same ground"
    PLACE = "same place"


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
    best: dict[str, Any] | None = None
    middle = len(first) // 2
    for mirrored in (False, True):
        other = second[:, ::-1] if mirrored else second
        for likeness, rows, least in (
            (Likeness.COPY, slice(None), COPY),
            (Likeness.UPPER, slice(None, middle), HALF),
            (Likeness.LOWER, slice(middle, None), HALF),
        ):
            a, b = np.zeros_like(first), np.zeros_like(first)
            a[rows], b[rows] = first[rows], other[rows]
            if min(float(a.std()), float(b.std())) < _LEAST_DETAIL_STOPS:
                continue
            fit = align(a[None], b[None], _TURNS)
            correlation = float(fit.correlation[0, 0])
            if correlation >= least and (best is None or correlation > best["correlation"]):
                yaw = (float(np.degrees(fit.yaw[0, 0])) + 180) % 360 - 180
                best = {
                    "likeness": likeness,
                    "correlation": correlation,
                    "yaw_deg": yaw,
                    "mirrored": mirrored,
                }
            if best is not None and best["likeness"] is Likeness.COPY:
                break
    return best
