"""What augmentation adds and what it distorts, figure by figure, by a rule."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from panokit.qa.sets.descriptors import DESCRIPTORS, Descriptor
from panokit.qa.sets.distances import Interval, Shift, shift_between
from panokit.qa.sets.resampling import TwoSets, false_discovery_rates
from panokit.qa.sets.settings import SetSettings

Figures = Mapping[str, float | None]

_LEAST_MAPS = 4
# From this share of augmented maps on whose scenes the reference has, the sets show the same.
_SAME_SCENES = 0.9
_OWN_RESAMPLES = 1000
_MOST_BINS = 30
_CURVE_POINTS = 41


class Effect(StrEnum):
    """What the augmented set does to a figure of the reference."""

    DISTORTS = "distorts"
    ADDS = "adds"
    SAME = "same"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, kw_only=True)
class Distribution:
    """One figure in both sets, as numbers to draw.

    Attributes:
        edges: (b + 1,) of the histogram's bins, shared by both sets.
        reference_counts: (b,) maps in each bin.
        augmented_counts: The same.
        points: (c,) values at which the distribution functions are given.
        reference_below: (c,) the share of reference maps at or below each point.
        augmented_below: The same.
    """

    edges: tuple[float, ...]
    reference_counts: tuple[int, ...]
    augmented_counts: tuple[int, ...]
    points: tuple[float, ...]
    reference_below: tuple[float, ...]
    augmented_below: tuple[float, ...]

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {name: list(getattr(self, name)) for name in self.__slots__}


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One figure of the augmented set against the reference.

    Attributes:
        descriptor: The figure.
        effect: By the rule of `effect_of`.
        reason: Why, in a few words.
        augmented_count: Maps that have the figure.
        reference_count: Maps that have it.
        augmented_missing: Maps that do not, such as maps without lights.
        reference_missing: The same of the reference.
        shift: The comparison; None where there are too few maps, or one value in all.
        q: The rate of false alarms if this figure and all clearer ones are said to differ.
        own_change: For maps with a truth of their own in the reference, the median of how far
            the figure is from that of the truth, in units of `shift.scale`. It can be large
            where the distributions are alike: each map is wrong in its own way.
        distribution: To draw; None where there is nothing to draw.
    """

    descriptor: Descriptor
    effect: Effect
    reason: str
    augmented_count: int
    reference_count: int
    augmented_missing: int
    reference_missing: int
    shift: Shift | None = None
    q: float | None = None
    own_change: Interval | None = None
    distribution: Distribution | None = None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "name": self.descriptor.name,
            "label": self.descriptor.label,
            "unit": self.descriptor.unit,
            "meaning": self.descriptor.meaning,
            "effect": str(self.effect),
            "reason": self.reason,
            "augmented_count": self.augmented_count,
            "reference_count": self.reference_count,
            "augmented_missing": self.augmented_missing,
            "reference_missing": self.reference_missing,
            "shift": self.shift and self.shift.to_json(),
            "q": self.q,
            "own_change": asdict(self.own_change) if self.own_change else None,
            "distribution": self.distribution and self.distribution.to_json(),
        }


def changes_between(
    augmented: Sequence[Figures],
    reference: Sequence[Figures],
    sets: TwoSets,
    settings: SetSettings | None = None,
    own: Sequence[int | None] = (),
) -> tuple[Change, ...]:
    """Every figure of `DESCRIPTORS`, compared and judged.

    Args:
        augmented: The figures of each augmented map, from `describe`.
        reference: The same of each reference map.
        sets: Which maps belong together, in the same order.
        settings: The rule's numbers.
        own: For each augmented map, which reference map is its own truth; None for none.
    """
    settings = settings or SetSettings()
    same_scenes = bool(np.isin(sets.augmented, sets.shared).mean() >= _SAME_SCENES)
    shifts = [_shift(d.name, augmented, reference, sets, settings) for d in DESCRIPTORS]
    rates = iter(false_discovery_rates([shift.p for shift in shifts if shift is not None]))
    found = []
    for descriptor, shift in zip(DESCRIPTORS, shifts, strict=True):
        ours, theirs = _values(descriptor.name, augmented), _values(descriptor.name, reference)
        q = next(rates) if shift is not None else None
        if shift is not None and q is not None:
            effect, reason = effect_of(shift, q, settings, same_scenes=same_scenes)
        elif min(len(ours), len(theirs)) < _LEAST_MAPS:
            effect, reason = Effect.UNDECIDED, "too few maps have it"
        else:
            effect, reason = Effect.SAME, "one value in all maps"
        found.append(
            Change(
                descriptor=descriptor,
                effect=effect,
                reason=reason,
                augmented_count=len(ours),
                reference_count=len(theirs),
                augmented_missing=len(augmented) - len(ours),
                reference_missing=len(reference) - len(theirs),
                shift=shift,
                q=q,
                own_change=_own_change(descriptor.name, augmented, reference, own, shift),
                distribution=distribution_of(ours, theirs) if len(ours) and len(theirs) else None,
            )
        )
    return tuple(found)


def effect_of(
    shift: Shift, q: float, settings: SetSettings, *, same_scenes: bool = False
) -> tuple[Effect, str]:
    """The rule; docs/ideas/qa-sets.md says it in words.

    Args:
        shift: The comparison of one figure.
        q: Its false discovery rate among all figures.
        settings: The rule's numbers.
        same_scenes: Whether both sets show the same scenes: then there is nothing to add, and
            a wider range is one that the scenes do not have.
    """
    moved = shift.shift
    if q <= settings.false_discovery:
        if moved.is_clear and abs(moved.value) >= settings.shift_min:
            return Effect.DISTORTS, "higher" if moved.value > 0 else "lower"
        if shift.spread is not None and shift.spread.high < settings.narrower_max:
            return Effect.DISTORTS, "narrower"
        if shift.outside.low > settings.outside_expected:
            return (Effect.DISTORTS if same_scenes else Effect.ADDS), "wider"
        return Effect.UNDECIDED, "differs, but neither in its middle nor in its range for sure"
    if max(abs(moved.low), abs(moved.high)) <= settings.same_within:
        return Effect.SAME, "no difference seen, and none that is large can be"
    return Effect.UNDECIDED, "too few maps to tell"


def distribution_of(augmented: Sequence[float], reference: Sequence[float]) -> Distribution:
    """Histograms on shared bins and distribution functions at shared points.

    The bins are Freedman and Diaconis' (1981) for the reference, at most 30 over both sets.
    """
    ours, theirs = np.asarray(augmented, np.float64), np.asarray(reference, np.float64)
    pooled = np.concatenate([ours, theirs])
    low, high = float(pooled.min()), float(pooled.max())
    if high <= low:
        low, high = low - 0.5, high + 0.5
    q1, q3 = np.percentile(theirs, [25, 75])
    width = 2 * (q3 - q1) / len(theirs) ** (1 / 3)
    bins = int(np.clip(np.ceil((high - low) / width) if width > 0 else 10, 5, _MOST_BINS))
    edges = np.linspace(low, high, bins + 1)
    points = np.linspace(low, high, _CURVE_POINTS)
    return Distribution(
        edges=_floats(edges),
        reference_counts=tuple(int(c) for c in np.histogram(theirs, edges)[0]),
        augmented_counts=tuple(int(c) for c in np.histogram(ours, edges)[0]),
        points=_floats(points),
        reference_below=_floats(np.searchsorted(np.sort(theirs), points, "right") / len(theirs)),
        augmented_below=_floats(np.searchsorted(np.sort(ours), points, "right") / len(ours)),
    )


def _shift(
    name: str,
    augmented: Sequence[Figures],
    reference: Sequence[Figures],
    sets: TwoSets,
    settings: SetSettings,
) -> Shift | None:
    ours = np.array([figures[name] is not None for figures in augmented])
    theirs = np.array([figures[name] is not None for figures in reference])
    if min(ours.sum(), theirs.sum()) < _LEAST_MAPS:
        return None
    if not (ours.all() and theirs.all()):
        sets = TwoSets(augmented=sets.augmented[ours], reference=sets.reference[theirs])
    return shift_between(
        _values(name, augmented),
        _values(name, reference),
        sets,
        permutations=settings.permutations,
        resamples=settings.resamples,
        seed=settings.seed,
    )


def _own_change(
    name: str,
    augmented: Sequence[Figures],
    reference: Sequence[Figures],
    own: Sequence[int | None],
    shift: Shift | None,
) -> Interval | None:
    pairs = [
        (ours[name], reference[place][name])
        for ours, place in zip(augmented, own, strict=False)
        if place is not None
    ]
    both = np.array([(a, b) for a, b in pairs if a is not None and b is not None], np.float64)
    if shift is None or len(both) < _LEAST_MAPS:
        return None
    apart = np.abs(both[:, 0] - both[:, 1]) / shift.scale
    random = np.random.default_rng(0)
    drawn = apart[random.integers(0, len(apart), (_OWN_RESAMPLES, len(apart)))]
    low, high = np.percentile(np.median(drawn, axis=1), [2.5, 97.5])
    return Interval(value=float(np.median(apart)), low=float(low), high=float(high))


def _values(name: str, figures: Sequence[Figures]) -> list[float]:
    return [value for one in figures if (value := one[name]) is not None]


def _floats(values: np.ndarray) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
