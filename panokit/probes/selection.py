"""Choosing some probes: as many of each kind of scene, and as different as can be.

Within the quotas the choice is farthest-point: each next probe is the one whose light is
farthest from all chosen so far (Gonzalez 1985, "Clustering to Minimize the Maximum Intercluster
Distance"; the least distance among the chosen is at least half of the best that any choice of
as many could have). Near-duplicates are chosen last.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import RecordError, UsageError
from panokit.io import read_json, write_json
from panokit.probes.descriptors import LENGTH, distances
from panokit.probes.entry import Entry
from panokit.probes.settings import SelectSettings

SCHEMA = "panokit.selection/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Selection:
    """Probes that were chosen, and how.

    Attributes:
        ids: In the order of choice: the first n are a good choice of n, too.
        names: What they are called.
        criteria: The filter, and the settings with the seed, as JSON values.
        counts: Group -> how many were chosen of how many there were.
        least_distance: Between the two most alike that were chosen; None for fewer than two.
    """

    ids: tuple[str, ...]
    names: tuple[str, ...]
    criteria: Mapping[str, Any] = field(default_factory=dict)
    counts: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    least_distance: float | None = None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "schema": SCHEMA,
            "ids": list(self.ids),
            "names": list(self.names),
            "criteria": dict(self.criteria),
            "counts": {group: list(pair) for group, pair in self.counts.items()},
            "least_distance": self.least_distance,
        }


def select(
    entries: Sequence[Entry],
    descriptors: Mapping[str, Sequence[float]],
    settings: SelectSettings,
    criteria: Mapping[str, Any] | None = None,
) -> Selection:
    """Choose among probes.

    Args:
        entries: What to choose from, for example what a filter lets pass.
        descriptors: Id -> descriptor, of `Library.descriptors`; a probe without one counts as
            far from all others by nothing, and is chosen last.
        settings: How many, balanced by what, and the seed.
        criteria: What `entries` were filtered by, for the record.

    Returns:
        The same for the same probes and settings, in whatever order they come.

    Raises:
        UsageError: If there is nothing to choose from.
    """
    if not entries:
        raise UsageError(
            "No probe passes the filter, so there is nothing to select. Ask for less, or see "
            "what there is with: panokit probes list LIBRARY"
        )
    entries = sorted(entries, key=lambda entry: entry.id)
    groups = [_group(entry, settings.balance) for entry in entries]
    quotas = allot(Counter(groups), settings.count)
    numbers = np.array([_numbers(descriptors.get(entry.id, ())) for entry in entries])
    chosen, gaps = _farthest(entries, groups, numbers, quotas, settings)
    there = Counter(groups)
    taken = Counter(groups[i] for i in chosen)
    return Selection(
        ids=tuple(entries[i].id for i in chosen),
        names=tuple(entries[i].name for i in chosen),
        criteria={"filter": dict(criteria or {}), **settings.model_dump(mode="json")},
        counts={group or "unsorted": (taken[group], there[group]) for group in sorted(there)},
        least_distance=round(float(min(gaps)), 4) if gaps else None,
    )


def allot(available: Mapping[str, int], count: int) -> dict[str, int]:
    """How many to take of each group: as even as can be, no more than there are.

    What a small group cannot give, the others share; the remainder goes to the groups that
    have the most left, by name where they tie.
    """
    quotas = dict.fromkeys(available, 0)
    left = min(count, sum(available.values()))
    while left:
        open_groups = [group for group in available if quotas[group] < available[group]]
        share = left // len(open_groups)
        if share == 0:
            by_room = sorted(open_groups, key=lambda g: (quotas[g] - available[g], g))
            for group in by_room[:left]:
                quotas[group] += 1
            break
        for group in open_groups:
            more = min(share, available[group] - quotas[group])
            quotas[group] += more
            left -= more
    return quotas


def write_selection(selection: Selection, path: Path) -> None:
    """Write a selection as JSON, the same bytes for the same choice.

    Raises:
        StorageError: If the file cannot be written.
    """
    write_json(path, selection.to_json())


def read_selection(path: Path) -> Selection:
    """The selection in a file.

    Raises:
        RecordError: If it is missing, damaged or something else.
    """
    value = read_json(path)
    if not isinstance(value, dict) or value.get("schema") != SCHEMA:
        raise RecordError(
            f"{path} is no selection of probes. Make one with: panokit probes select LIBRARY "
            f"--count N --out {path.name}",
            reason="no-selection",
        )
    try:
        return Selection(
            ids=tuple(str(id) for id in value["ids"]),
            names=tuple(str(name) for name in value["names"]),
            criteria=dict(value["criteria"]),
            counts={group: (pair[0], pair[1]) for group, pair in value["counts"].items()},
            least_distance=value.get("least_distance"),
        )
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise RecordError(
            f"The selection {path} is damaged ({error!r}). Select again.",
            reason="damaged-selection",
        ) from error


def _farthest(
    entries: Sequence[Entry],
    groups: Sequence[str],
    numbers: NDArray[np.float64],
    quotas: dict[str, int],
    settings: SelectSettings,
) -> tuple[list[int], list[float]]:
    """Which entries, in the order of choice, and how far each was from those before it."""
    open_ = np.array([quotas[group] > 0 for group in groups])
    apart = np.full(len(entries), np.inf)
    places: Counter[str] = Counter()
    chosen: list[int] = []
    gaps: list[float] = []
    rng = np.random.default_rng(settings.seed)
    while open_.any():
        if chosen:
            best = int(np.argmax(np.where(open_, apart, -1.0)))
            gaps.append(float(apart[best]))
        else:
            best = int(rng.choice(np.flatnonzero(open_)))
        chosen.append(best)
        open_[best] = False
        apart = np.minimum(apart, distances(numbers, numbers[best]))
        quotas[groups[best]] -= 1
        if quotas[groups[best]] == 0:
            open_ &= np.array([group != groups[best] for group in groups])
        place = entries[best].place
        places[place] += 1
        if settings.per_place and place and places[place] >= settings.per_place:
            open_ &= np.array([entry.place != place for entry in entries])
    return chosen, gaps


def _group(entry: Entry, balance: str) -> str:
    return "" if balance == "none" else str(getattr(entry, balance))


def _numbers(known: Sequence[float]) -> Sequence[float]:
    return known if len(known) == LENGTH else [0.0] * LENGTH
