"""A set of maps against a reference set: everything that is said of it, in one value."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from panokit.errors import ItemError, Rejection, UsageError
from panokit.qa.sets.changes import Change, Effect, changes_between
from panokit.qa.sets.classes import MEANINGS
from panokit.qa.sets.coverage import Coverage, coverage_of
from panokit.qa.sets.duplicates import NearDuplicate, find_near_duplicates
from panokit.qa.sets.members import Member, groups_of
from panokit.qa.sets.multivariate import (
    Neighborhood,
    Separation,
    energy_and_kernel,
    harmonics_frechet,
    neighborhoods,
    standardized,
)
from panokit.qa.sets.nearest import Nearest, nearest_references
from panokit.qa.sets.places import Spread, cell_of, month_of, solar_hour_of, spread_of
from panokit.qa.sets.resampling import TwoSets
from panokit.qa.sets.settings import SetSettings
from panokit.qa.sets.store import Description, DescriptionStore

SCHEMA = "panokit.sets/1"
LEAST_MAPS = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DescribedMap:
    """One map of a set and what was measured of it.

    Attributes:
        member: The map.
        description: Its light.
        nearest: Its nearest references; None for a reference map.
    """

    member: Member
    description: Description
    nearest: Nearest | None = None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "name": self.member.name,
            "digest": self.description.digest,
            "class": str(self.description.light_class),
            "category": self.member.category,
            "values": dict(self.description.values),
            "nearest": self.nearest and self.nearest.to_json(),
        }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SetComparison:
    """An augmented set beside its reference.

    Attributes:
        augmented: Its maps.
        reference: The reference maps.
        paired: How many augmented maps have a reference of the same name.
        changes: Every figure: what is added, what is distorted.
        energy: The energy distance over all figures.
        kernel: The kernel distance (MMD squared) over all figures.
        frechet: The Frechet distance of harmonic spectra, None with too few maps.
        neighborhood: Precision, recall, density and coverage.
        figures: The figures that the three above are over.
        coverage: By kinds of light, place and time.
        augmented_spread: Where and when the augmented maps were taken.
        reference_spread: The same of the reference.
        class_moves: For maps with a reference of the same name, how many went from each kind
            of light to each: "sun > overcast".
        duplicates: Maps that show the same thing, within and across the sets.
        tested: How many maps of each set the distances are over, after drawing.
        skipped: Maps that could not be described, and why.
        settings: The rule's numbers.
    """

    augmented: tuple[DescribedMap, ...]
    reference: tuple[DescribedMap, ...]
    paired: int
    changes: tuple[Change, ...]
    energy: Separation
    kernel: Separation
    frechet: Separation | None
    neighborhood: Neighborhood | None
    figures: tuple[str, ...]
    coverage: Coverage | None
    augmented_spread: Spread
    reference_spread: Spread
    class_moves: dict[str, int]
    duplicates: tuple[NearDuplicate, ...]
    tested: tuple[int, int]
    skipped: tuple[Rejection, ...]
    settings: SetSettings

    @property
    def effects(self) -> dict[str, int]:
        """How many figures have each effect."""
        counted = Counter(change.effect for change in self.changes)
        return {str(effect): counted[effect] for effect in Effect}

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`, free of paths."""
        return {
            "schema": SCHEMA,
            "settings": self.settings.model_dump(mode="json"),
            "counts": {
                "augmented": len(self.augmented),
                "reference": len(self.reference),
                "paired": self.paired,
                "tested_augmented": self.tested[0],
                "tested_reference": self.tested[1],
            },
            "effects": self.effects,
            "changes": [change.to_json() for change in self.changes],
            "distances": {
                "figures": list(self.figures),
                "energy": _separation(self.energy),
                "kernel": _separation(self.kernel),
                "frechet_harmonics": self.frechet and _separation(self.frechet),
            },
            "neighborhood": self.neighborhood and self.neighborhood.to_json(),
            "coverage": self.coverage and self.coverage.to_json(),
            "spread": {
                "augmented": self.augmented_spread.to_json(),
                "reference": self.reference_spread.to_json(),
            },
            "classes": {str(name): meaning for name, meaning in MEANINGS.items()},
            "class_moves": self.class_moves,
            "duplicates": [pair.to_json() for pair in self.duplicates],
            "augmented": [one.to_json() for one in self.augmented],
            "reference": [one.to_json() for one in self.reference],
            "skipped": [one.to_json() for one in self.skipped],
        }


def compare_sets(
    augmented: Sequence[Member],
    reference: Sequence[Member],
    settings: SetSettings | None = None,
    *,
    store: DescriptionStore | None = None,
    on_described: Callable[[Member], None] | None = None,
) -> SetComparison:
    """Compare a set of maps with a reference set.

    Maps that cannot be read or are black are skipped and told of.

    Args:
        augmented: The maps in question.
        reference: The maps to hold them against; a map of the same name is its truth.
        settings: The rule's numbers.
        store: Where descriptions are kept; it is saved when all maps are described.
        on_described: Called after each map, for progress.

    Raises:
        UsageError: If fewer than four maps of a set can be described.
        StorageError: If the store cannot be written.
    """
    settings = settings or SetSettings()
    store = store or DescriptionStore()
    ours: list[DescribedMap] = []
    theirs: list[DescribedMap] = []
    skipped: list[Rejection] = []
    for members, described in ((augmented, ours), (reference, theirs)):
        for member in members:
            try:
                found = store.describe(member.path)
                described.append(DescribedMap(member=member, description=found))
            except ItemError as error:
                skipped.append(_rejection(member, error))
            if on_described:
                on_described(member)
    store.save()
    if min(len(ours), len(theirs)) < LEAST_MAPS:
        raise UsageError(
            f"Sets to compare have {LEAST_MAPS} readable maps or more each; these have "
            f"{len(ours)} and {len(theirs)}."
        )
    return _compared(ours, theirs, tuple(skipped), settings)


def _compared(
    ours: list[DescribedMap],
    theirs: list[DescribedMap],
    skipped: tuple[Rejection, ...],
    settings: SetSettings,
) -> SetComparison:
    sets = groups_of([one.member for one in ours], [one.member for one in theirs])
    chosen = _drawn(sets, settings)
    tested_a = [ours[i] for i in chosen[0]]
    tested_r = [theirs[i] for i in chosen[1]]
    tested = TwoSets(augmented=sets.augmented[chosen[0]], reference=sets.reference[chosen[1]])
    values_a = [one.description.values for one in tested_a]
    values_r = [one.description.values for one in tested_r]
    vectors_a, vectors_r, figures = standardized(values_a, values_r)
    energy, kernel = energy_and_kernel(
        vectors_a, vectors_r, tested, permutations=settings.permutations, seed=settings.seed
    )
    nearest = nearest_references(_arrays(ours), _arrays(theirs), (_names(ours), _names(theirs)))
    names_r = {one.member.name: one for one in theirs}
    moves = Counter(
        f"{names_r[one.member.name].description.light_class} > {one.description.light_class}"
        for one in ours
        if one.member.name in names_r
    )
    return SetComparison(
        augmented=tuple(
            DescribedMap(member=one.member, description=one.description, nearest=near)
            for one, near in zip(ours, nearest, strict=True)
        ),
        reference=tuple(theirs),
        paired=sum(moves.values()),
        changes=changes_between(values_a, values_r, tested, settings, _own(tested_a, tested_r)),
        energy=energy,
        kernel=kernel,
        frechet=harmonics_frechet(
            _arrays(tested_a)[0], _arrays(tested_r)[0], tested, seed=settings.seed
        ),
        neighborhood=neighborhoods(
            vectors_a, vectors_r, tested, k=settings.neighbors, seed=settings.seed
        ),
        figures=figures,
        coverage=coverage_of(vectors_a, vectors_r, tested.reference, _kinds(tested_a, tested_r)),
        augmented_spread=spread_of([one.member.capture for one in ours]),
        reference_spread=spread_of([one.member.capture for one in theirs]),
        class_moves=dict(sorted(moves.items())),
        duplicates=tuple(_duplicates(ours, theirs)),
        tested=(len(tested_a), len(tested_r)),
        skipped=skipped,
        settings=settings,
    )


def _drawn(sets: TwoSets, settings: SetSettings) -> tuple[np.ndarray, np.ndarray]:
    """Which maps the tests are over: all, or whole groups of them drawn until there are enough."""
    if max(len(sets.augmented), len(sets.reference)) <= settings.maps_max:
        return np.arange(len(sets.augmented)), np.arange(len(sets.reference))
    random = np.random.default_rng([settings.seed, 0x64726177])
    order = random.permutation(int(sets.pooled.max()) + 1)
    found = []
    for groups in (sets.augmented, sets.reference):
        by_draw = np.argsort(order[groups], kind="stable")
        found.append(np.sort(by_draw[: settings.maps_max]))
    return found[0], found[1]


def _kinds(
    ours: Sequence[DescribedMap], theirs: Sequence[DescribedMap]
) -> dict[str, tuple[list[str], list[str]]]:
    categories = {one.member.name: one.member.category for one in theirs}
    found: dict[str, tuple[list[str], list[str]]] = {}
    for partition, kind_of in {
        "light": lambda one: str(one.description.light_class),
        # A map that was made from a reference is of its category.
        "category": lambda one: one.member.category or categories.get(one.member.name, ""),
        "month": lambda one: month_of(one.member.capture) if one.member.capture else "",
        "solar hour": lambda one: solar_hour_of(one.member.capture) if one.member.capture else "",
        "cell": _cell,
    }.items():
        found[partition] = ([kind_of(one) for one in ours], [kind_of(one) for one in theirs])
    return found


def _cell(one: DescribedMap) -> str:
    capture = one.member.capture
    if capture is None or capture.latitude_deg is None or capture.longitude_deg is None:
        return ""
    return cell_of(capture.latitude_deg, capture.longitude_deg)


def _duplicates(ours: list[DescribedMap], theirs: list[DescribedMap]) -> list[NearDuplicate]:
    known = {one.member.name: len(ours) + number for number, one in enumerate(theirs)}
    return find_near_duplicates(
        [f"augmented/{name}" for name in _names(ours)]
        + [f"reference/{name}" for name in _names(theirs)],
        [one.description for one in (*ours, *theirs)],
        [one.member.capture for one in (*ours, *theirs)],
        apart=[(i, known[name]) for i, name in enumerate(_names(ours)) if name in known],
    )


def _arrays(maps: Sequence[DescribedMap]) -> tuple[np.ndarray, np.ndarray]:
    return (
        np.stack([one.description.power for one in maps]),
        np.stack([one.description.thumbnail for one in maps]),
    )


def _own(ours: Sequence[DescribedMap], theirs: Sequence[DescribedMap]) -> list[int | None]:
    """For each augmented map, which reference map has its name."""
    known = {one.member.name: number for number, one in enumerate(theirs)}
    return [known.get(one.member.name) for one in ours]


def _names(maps: Sequence[DescribedMap]) -> list[str]:
    return [one.member.name for one in maps]


def _separation(found: Separation) -> dict[str, float]:
    return {
        "value": found.value,
        "expected": found.expected,
        "excess": found.excess,
        "null": found.null,
        "p": found.p,
    }


def _rejection(member: Member, error: ItemError) -> Rejection:
    told = Rejection.from_error(member.name, "qa", error)
    return Rejection(
        item=told.item,
        stage=told.stage,
        reason=told.reason,
        message=told.message.replace(str(member.path), member.path.name),
        values=told.values,
    )
