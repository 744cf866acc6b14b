"""Which kinds of light and which places of the reference the augmented set reaches."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """One kind of map: a class of light, a category, a month, an hour, a cell.

    Attributes:
        reference: Reference maps of this kind.
        covered: Those of them with an augmented map nearer than the radius.
        augmented: Augmented maps of this kind.
    """

    reference: int
    covered: int
    augmented: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Coverage:
    """How much of the reference the augmented set reaches.

    Attributes:
        radius: The median distance from a reference map to the nearest one of another scene,
            in standardized figures. Half of the reference is as near to the rest of it.
        covered: The share of reference maps with an augmented map within the radius.
        kinds: Partition -> kind -> counts. The partitions are "light", "category", "month",
            "solar hour" and "cell", where they are known.
    """

    radius: float
    covered: float
    kinds: Mapping[str, Mapping[str, Kind]]

    def share_of_kinds(self, partition: str) -> float | None:
        """The share of the reference's kinds with a covered map; None if it has no kinds."""
        kinds = [kind for kind in self.kinds[partition].values() if kind.reference]
        return sum(kind.covered > 0 for kind in kinds) / len(kinds) if kinds else None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "radius": self.radius,
            "covered": self.covered,
            "partitions": {
                name: {
                    "share_of_kinds": self.share_of_kinds(name),
                    "kinds": {kind: asdict(counts) for kind, counts in kinds.items()},
                }
                for name, kinds in self.kinds.items()
            },
        }


def coverage_of(
    augmented: Array,
    reference: Array,
    groups: NDArray[np.intp],
    kinds: Mapping[str, tuple[Sequence[str], Sequence[str]]],
) -> Coverage | None:
    """Count what is reached; None if the reference shows one scene only.

    Args:
        augmented: (n, d) standardized figures.
        reference: (m, d).
        groups: (m,) which reference maps show one scene.
        kinds: Partition -> the kind of each augmented map, and of each reference map; "" where
            it is not known.
    """
    among = cdist(reference, reference)
    among[groups[:, None] == groups] = np.inf
    nearest = among.min(axis=1)
    if not np.isfinite(nearest).any():
        return None
    radius = float(np.median(nearest[np.isfinite(nearest)]))
    covered = cdist(augmented, reference).min(axis=0) <= radius
    return Coverage(
        radius=radius,
        covered=float(covered.mean()),
        kinds={
            partition: _count(ours, theirs, covered)
            for partition, (ours, theirs) in kinds.items()
            if any(ours) or any(theirs)
        },
    )


def _count(
    augmented: Sequence[str], reference: Sequence[str], covered: NDArray[np.bool_]
) -> dict[str, Kind]:
    return {
        kind: Kind(
            reference=sum(name == kind for name in reference),
            covered=int(
                sum(is_in for name, is_in in zip(reference, covered, strict=True) if name == kind)
            ),
            augmented=sum(name == kind for name in augmented),
        )
        for kind in sorted({*augmented, *reference} - {""})
    }
