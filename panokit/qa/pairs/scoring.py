"""One pair under every protocol of `panokit.metrics`, and many pairs in one table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from panokit.errors import UsageError
from panokit.metrics import (
    PROTOCOLS,
    Summary,
    dominance_ratio,
    native_scores,
    relit_three_spheres,
    summarize,
)
from panokit.metrics.brightest import DOMINANT
from panokit.metrics.spheres import Variant
from panokit.qa.pairs.aligning import AlignedPair

_THREE_SPHERES = "panokit-three-spheres"
_SPHERE_PARTS = {"rmse": "radiance", "si_rmse": "radiance", "angular_deg": "°",
                 "normalized_rmse": ""}  # fmt: skip
_MATERIALS = ("mirror", "matte_silver", "diffuse")
_VARIANTS: tuple[Variant, ...] = ("compat", "fixed")
_WHY_NOT: Mapping[str, str] = {
    "renders": "needs the published Blender scene; its scores by panokit's transport are "
    f"{_THREE_SPHERES}-*",
    "frames": "needs the published scene of nine spheres",
    "object images": "needs pictures of an object, not a map",
    "features": "compares sets, not pairs",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One figure of the table.

    Attributes:
        name: Of the protocol.
        unit: Of the figure.
        better: Which way is better.
        source: Where the definition is from.
        variant: "native", "compat" as published or "fixed".
    """

    name: str
    unit: str
    better: str
    source: str
    variant: str

    def to_json(self) -> dict[str, str]:
        """A dictionary for `json.dump`."""
        return {name: getattr(self, name) for name in self.__slots__}


@dataclass(frozen=True, slots=True, kw_only=True)
class PairScore:
    """One map against its truth.

    Attributes:
        name: Of the map.
        reference: The file name of the truth.
        obstacle: Why they cannot be compared, "" if they can.
        gain: What the map was multiplied by.
        dominance: How many times brighter the truth's brightest direction is than any other.
        values: Figure -> value; None where there is none, such as an angle between lights
            where a map has no light.
        picture: The relit scenes, relative to the report's folder; "" for none.
    """

    name: str
    reference: str
    obstacle: str = ""
    gain: float = 1.0
    dominance: float | None = None
    values: Mapping[str, float | None] = field(default_factory=dict)
    picture: str = ""

    @property
    def has_dominant_light(self) -> bool:
        """Whether the direction of "the" light means anything in this scene."""
        return self.dominance is None or self.dominance >= DOMINANT

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "name": self.name,
            "reference": self.reference,
            "obstacle": self.obstacle,
            "gain": self.gain,
            "dominance": self.dominance,
            "has_dominant_light": self.has_dominant_light,
            "values": dict(self.values),
            "picture": self.picture,
        }


def columns() -> tuple[Column, ...]:
    """Every figure that a pair of maps has, in the order of the protocols."""
    own = [
        Column(
            name=row.name, unit=row.unit, better=row.better, source=row.source, variant=row.variant
        )
        for row in PROTOCOLS.values()
        if row.takes == "maps"
    ]
    spheres = [
        Column(
            name=_sphere_name(material, part, variant),
            unit=unit,
            better="lower",
            source="panokit-v1, after StyleLight 2022",
            variant=variant,
        )
        for variant in _VARIANTS
        for material in _MATERIALS
        for part, unit in _SPHERE_PARTS.items()
    ]
    return (*own, *spheres)


def not_scored() -> dict[str, str]:
    """The protocols that a pair of maps does not have, and why."""
    return {row.name: _WHY_NOT[row.takes] for row in PROTOCOLS.values() if row.takes != "maps"}


def scores_of(pair: AlignedPair) -> dict[str, float | None]:
    """Every figure of `columns`; those that are not finite are None."""
    found: dict[str, float] = dict(native_scores(pair.estimate, pair.truth))
    for name, row in PROTOCOLS.items():
        if row.takes == "maps" and name not in found:
            found[name] = row.score(pair.estimate, pair.truth)
    for variant in _VARIANTS:
        errors = relit_three_spheres(pair.estimate, pair.truth, variant)
        for material in _MATERIALS:
            for part in _SPHERE_PARTS:
                name = _sphere_name(material, part, variant)
                found[name] = float(getattr(errors[material], part))
    return {
        column.name: found[column.name] if np.isfinite(found[column.name]) else None
        for column in columns()
    }


def dominance_of(pair: AlignedPair) -> float:
    """The truth's `dominance_ratio`, within what JSON can hold."""
    return min(dominance_ratio(pair.truth), 1e9)


def summaries(
    scores: Sequence[PairScore], *, dominant_only: bool = False, seed: int = 0
) -> dict[str, Summary | None]:
    """Every figure over all pairs, with percentiles and the bootstrap interval of its mean.

    Args:
        scores: Of the pairs; those with an obstacle do not count.
        dominant_only: Count only the scenes with one dominant light, as is right for figures
            of its direction.
        seed: Of the bootstrap.

    Returns:
        Figure -> summary; None where no pair has it.
    """
    counted = [
        score
        for score in scores
        if not score.obstacle and (score.has_dominant_light or not dominant_only)
    ]
    found: dict[str, Summary | None] = {}
    for column in columns():
        values = [score.values.get(column.name) for score in counted]
        numbers = [float("nan") if value is None else value for value in values]
        try:
            found[column.name] = summarize(numbers, seed=seed)
        except UsageError:
            found[column.name] = None
    return found


def _sphere_name(material: str, part: str, variant: str) -> str:
    return f"{_THREE_SPHERES}-{material}-{part}-{variant}".replace("_", "-")
