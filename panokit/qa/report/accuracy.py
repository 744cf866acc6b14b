"""How near to its reference a map is, in one word; the checks cannot say, they know no truth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from panokit.qa.batch import JudgedMap
from panokit.report.wording import format_figure, format_limit


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """What is good, fair and poor of one figure, in its unit.

    Attributes:
        label: The figure's name within a sentence.
        good: The largest value that is good.
        fair: The largest value that is fair; above is poor.
        unit: Of both.
    """

    label: str
    good: float
    fair: float
    unit: str


BOUNDS: Mapping[str, Bounds] = {
    "irradiance-error": Bounds(label="irradiance error", good=20, fair=50, unit="%"),
    "light-direction": Bounds(label="light direction error", good=12, fair=30, unit="°"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Median:
    """The median of one figure over all maps that have a reference, for the page's head."""

    label: str
    value: str
    grade: str


def grade_of(name: str, value: float | None) -> str:
    """How good a figure is: "good", "fair" or "poor"; empty for one without bounds."""
    bounds = BOUNDS.get(name)
    if bounds is None or value is None:
        return ""
    if value <= bounds.good:
        return "good"
    return "fair" if value <= bounds.fair else "poor"


def medians(maps: Sequence[JudgedMap]) -> tuple[Median, ...]:
    """The medians of the graded figures; empty where no map has a reference."""
    found = []
    for name, bounds in BOUNDS.items():
        values = [
            difference.value
            for judged in maps
            for difference in (judged.comparison.differences if judged.comparison else ())
            if difference.name == name
        ]
        if values:
            middle = median(values)
            found.append(
                Median(
                    label=f"median {bounds.label}",
                    value=format_figure(middle, bounds.unit),
                    grade=grade_of(name, middle),
                )
            )
    return tuple(found)


def explanation(maps: Sequence[JudgedMap]) -> str:
    """What the verdict means and what it does not, for those who read only the head."""
    said = "The checks look for defects of a map itself; a map without one can still light wrongly"
    compared = sum(bool(j.comparison and j.comparison.differences) for j in maps)
    if not compared:
        return f"{said}, which only a reference could tell."
    whom = "map has" if compared == 1 else "maps have"
    bounds = "; ".join(
        f"{b.label} up to {format_limit(b.good)}{_gap(b)}{b.unit} is good, "
        f"up to {format_limit(b.fair)}{_gap(b)}{b.unit} fair, above poor"
        for b in BOUNDS.values()
    )
    return f"{said}, which the reference tells ({compared} {whom} one): {bounds}."


def _gap(bounds: Bounds) -> str:
    return "" if bounds.unit == "°" else " "
