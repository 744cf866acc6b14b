"""The table of checks, and the report that it gives for a map."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from panokit.envmap import EnvironmentMap
from panokit.qa.geometry import pole_detail, seam_step
from panokit.qa.radiometry import (
    clipped_area_percent,
    dynamic_range_stops,
    ledger_error,
    mean_radiance,
    top_share,
    unphysical_values,
)
from panokit.qa.settings import QaSettings
from panokit.qa.verdicts import Check, Report


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """How one check measures and which settings limit it.

    Attributes:
        name: Of the check.
        measure: Map -> figure, None where it does not apply.
        unit: Of the figure.
        meaning: What the figure says, in one plain sentence.
        low: Settings -> the least value that passes.
        high: Settings -> the largest value that passes.
    """

    name: str
    measure: Callable[[EnvironmentMap], float | None]
    unit: str
    meaning: str
    low: Callable[[QaSettings], float] | None = None
    high: Callable[[QaSettings], float] | None = None


RULES: tuple[Rule, ...] = (
    Rule(
        name="physical",
        measure=unphysical_values,
        unit="bad values",
        meaning="Radiance is finite and not negative everywhere.",
        high=lambda settings: 0.0,
    ),
    Rule(
        name="energy",
        measure=mean_radiance,
        unit="",
        meaning="The mean radiance over the sphere: there is light in the map.",
        low=lambda settings: settings.energy_min,
    ),
    Rule(
        name="energy-ledger",
        measure=ledger_error,
        unit="",
        meaning="The file holds the energy that the stage before it wrote down.",
        high=lambda settings: settings.ledger_error_max,
    ),
    Rule(
        name="dynamic-range",
        measure=dynamic_range_stops,
        unit="stops",
        meaning="From the median to the peak: light sources stand out as they do in the world.",
        low=lambda settings: settings.dynamic_range_min_stops,
        high=lambda settings: settings.dynamic_range_max_stops,
    ),
    Rule(
        name="top-share",
        measure=top_share,
        unit="",
        meaning="The share of the energy that comes from the brightest 0.1 % of the sphere.",
        low=lambda settings: settings.top_share_min,
        high=lambda settings: settings.top_share_max,
    ),
    Rule(
        name="wrap-seam",
        measure=seam_step,
        unit="×",
        meaning="Left and right edge meet: the step there is like those between other columns.",
        high=lambda settings: settings.seam_max,
    ),
    Rule(
        name="poles",
        measure=pole_detail,
        unit="×",
        meaning="No pinwheel at zenith or nadir: the detail around them ends before the pole.",
        high=lambda settings: settings.pole_max,
    ),
    Rule(
        name="clipped-area",
        measure=clipped_area_percent,
        unit="%",
        meaning="The share of the sphere that sits on a flat plateau at the map's maximum.",
        high=lambda settings: settings.clipped_area_max_percent,
    ),
)


def check(envmap: EnvironmentMap, settings: QaSettings | None = None) -> Report:
    """Measure a map and hold every figure against its limits."""
    return judge({rule.name: rule.measure(envmap) for rule in RULES}, settings)


def judge(values: Mapping[str, float | None], settings: QaSettings | None = None) -> Report:
    """The report that these figures give under these settings; a figure not given is None."""
    settings = settings or QaSettings()
    return Report(
        checks=tuple(
            Check(
                name=rule.name,
                value=values.get(rule.name),
                unit=rule.unit,
                low=rule.low and rule.low(settings),
                high=rule.high and rule.high(settings),
                meaning=rule.meaning,
            )
            for rule in RULES
        ),
        settings_digest=settings.digest,
    )
