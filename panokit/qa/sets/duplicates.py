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
# Pairs with less over the whole sphere, at the yaws of pixels, are not looked at more closely.
_PERHAPS = 0.2
# A bare sky has less detail than this, mostly the rim of its sun, and one sun is like another:
# then only a nearly exact copy is one.
_PLAIN_STOPS = 0.1
_EXACT = 0.8
# Less is rounding.
_LEAST_STOPS = 0.004
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
    partners: dict[int, list[int]] = {}
    for i, j in _candidates(descriptions, places):
        if (i, j) not in known:
            partners.setdefault(i, []).append(j)
    found = []
    for i, others in partners.items():
        shared = _shared_with(descriptions[i].detail, [descriptions[j].detail for j in others])
        for place, j in enumerate(others):
            meters = distance_m(places[i], places[j])
            same = shared.get(place)
            if same is None and meters is not None and meters < _SAME_PLACE_M:
                same = {"likeness": Likeness.PLACE}
            if same is not None:
                found.append(
                    NearDuplicate(first=names[i], second=names[j], distance_m=meters, **same)
                )
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


def _shared_with(
    detail: NDArray[np.float32], others: Sequence[NDArray[np.float32]]
) -> dict[int, dict[str, Any]]:
    """Which of others share something with a map, and what."""
    details = np.stack(others)
    likely = np.zeros(len(others), bool)
    for turned in (details, details[:, :, ::-1]):
        likely |= align(detail[None], turned, DETAIL_WIDTH_PX).correlation[0] >= _PERHAPS
    places = np.flatnonzero(likely)
    if not len(places):
        return {}
    found = _same_scenes(detail, details[places])
    return {int(j): same for j, same in zip(places, found, strict=True) if same is not None}


def _same_scenes(
    detail: NDArray[np.float32], others: NDArray[np.float32]
) -> list[dict[str, Any] | None]:
    """What a map shares with each of others (n, H, W), judged by their detail; None if nothing."""
    best: list[dict[str, Any] | None] = [None] * len(others)
    for mirrored in (False, True):
        turned = others[:, :, ::-1] if mirrored else others
        fits = {part: _fit(detail, turned, rows) for part, rows in _PARTS.items()}
        for j in range(len(others)):
            likeness = _likeness({part: float(fit[0][j]) for part, fit in fits.items()})
            if likeness is None:
                continue
            correlation = float(fits[likeness][0][j])
            earlier = best[j]
            if earlier is None or correlation > earlier["correlation"]:
                best[j] = {
                    "likeness": likeness,
                    "correlation": correlation,
                    "yaw_deg": float(fits[likeness][1][j]),
                    "mirrored": mirrored,
                }
    return best


def _likeness(correlations: dict[Likeness, float]) -> Likeness | None:
    """The verdict; comparisons with NaN, where there is no detail, are false."""
    upper, lower = correlations[Likeness.UPPER], correlations[Likeness.LOWER]
    if upper >= HALF and lower < _OTHER_HALF:
        return Likeness.UPPER
    if lower >= HALF and upper < _OTHER_HALF:
        return Likeness.LOWER
    return Likeness.COPY if correlations[Likeness.COPY] >= COPY else None


def _fit(
    detail: NDArray[np.float32], others: NDArray[np.float32], rows: slice
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Correlations (n,) of some rows at the best yaws, and these; NaN where there is no detail."""
    ours, theirs = np.zeros_like(detail), np.zeros_like(others)
    ours[rows], theirs[:, rows] = detail[rows], others[:, rows]
    fit = align(ours[None], theirs, _TURNS)
    least = np.minimum(detail[rows].std(), others[:, rows].std(axis=(1, 2)))
    correlation = np.where(least < _LEAST_STOPS, np.nan, fit.correlation[0])
    plain = (least < _PLAIN_STOPS) & (correlation < _EXACT)
    yaw_deg = (np.degrees(fit.yaw[0]) + 180) % 360 - 180
    return np.where(plain, np.nan, correlation), yaw_deg
