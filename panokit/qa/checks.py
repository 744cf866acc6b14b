"""The table of checks, and the report that it gives for a map."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from panokit.capture import Capture
from panokit.envmap import EnvironmentMap
from panokit.qa import content, daylight, encoding, geometry, radiometry, sources, sunlight, tilt
from panokit.qa.measurements import Finding, Measurements
from panokit.qa.plausibility import plausibility
from panokit.qa.reference_set import ReferenceSet
from panokit.qa.settings import QaSettings
from panokit.qa.verdicts import Check, Report


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """How one check measures and which settings limit it.

    Attributes:
        name: Of the check.
        family: What it is about.
        measure: What is shared of a map -> the figure.
        unit: Of the figure.
        meaning: What the figure says, in one plain sentence.
        low: Settings -> the least value that passes.
        high: Settings -> the largest value that passes.
    """

    name: str
    family: str
    measure: Callable[[Measurements], Finding]
    unit: str
    meaning: str
    low: Callable[[QaSettings], float] | None = None
    high: Callable[[QaSettings], float] | None = None


RULES: tuple[Rule, ...] = (
    Rule(
        name="physical",
        family="radiometry",
        measure=radiometry.physical,
        unit="bad values",
        meaning="Radiance is finite and not negative everywhere.",
        high=lambda settings: 0.0,
    ),
    Rule(
        name="energy",
        family="radiometry",
        measure=radiometry.brightness,
        unit="",
        meaning="The mean radiance over the sphere: there is light in the map.",
        low=lambda settings: settings.energy_min,
    ),
    Rule(
        name="energy-ledger",
        family="radiometry",
        measure=radiometry.ledger,
        unit="",
        meaning="The file holds the energy that the stage before it wrote down.",
        high=lambda settings: settings.ledger_error_max,
    ),
    Rule(
        name="dynamic-range",
        family="radiometry",
        measure=radiometry.dynamic_range,
        unit="stops",
        meaning="From the median to the peak: light sources stand out as they do in the world.",
        low=lambda settings: settings.dynamic_range_min_stops,
        high=lambda settings: settings.dynamic_range_max_stops,
    ),
    Rule(
        name="top-share",
        family="radiometry",
        measure=radiometry.brightest_share,
        unit="",
        meaning="The share of the energy that comes from the brightest 0.1 % of the sphere.",
        low=lambda settings: settings.top_share_min,
        high=lambda settings: settings.top_share_max,
    ),
    Rule(
        name="clipped-area",
        family="radiometry",
        measure=radiometry.clipped_area,
        unit="%",
        meaning="The share of the sphere that sits on a flat plateau at the map's maximum.",
        high=lambda settings: settings.clipped_area_max_percent,
    ),
    Rule(
        name="clipped-source",
        family="radiometry",
        measure=radiometry.clipped_source,
        unit="px",
        meaning="Equally bright pixels at the top of a small source: a clipped sun has no peak.",
        high=lambda settings: settings.clipped_source_max_px,
    ),
    Rule(
        name="contrast",
        family="radiometry",
        measure=encoding.contrast,
        unit="×",
        meaning="Contrast beside that of captured light: display values taken for light have half.",
        low=lambda settings: settings.contrast_min,
        high=lambda settings: settings.contrast_max,
    ),
    Rule(
        name="source-share",
        family="radiometry",
        measure=sources.source_share,
        unit="",
        meaning="The share of the light from sources; the rest is ambient light.",
        high=lambda settings: settings.source_share_max,
    ),
    Rule(
        name="twin-source",
        family="radiometry",
        measure=sources.twin_source,
        unit="",
        meaning="The share of the light of the weaker of two equal small sources: one sun, twice.",
        high=lambda settings: settings.twin_share_max,
    ),
    Rule(
        name="expansion-gain",
        family="radiometry",
        measure=sources.expansion_gain,
        unit="×",
        meaning="All light after expansion over that of the panorama before.",
        low=lambda settings: settings.expansion_gain_min,
        high=lambda settings: settings.expansion_gain_max,
    ),
    Rule(
        name="recorded-light",
        family="radiometry",
        measure=sources.recorded_light,
        unit="°",
        meaning="The strongest light of the record is where the map has a light.",
        high=lambda settings: settings.recorded_light_max_deg,
    ),
    Rule(
        name="light-temperature",
        family="radiometry",
        measure=daylight.light_temperature,
        unit="K",
        meaning="The color temperature of the light as a whole.",
        low=lambda settings: settings.light_temperature_min_kelvin,
        high=lambda settings: settings.light_temperature_max_kelvin,
    ),
    Rule(
        name="sky-temperature",
        family="radiometry",
        measure=daylight.sky_temperature,
        unit="K",
        meaning="The color temperature of a smooth sky overhead.",
        low=lambda settings: settings.sky_temperature_min_kelvin,
    ),
    Rule(
        name="channel-order",
        family="radiometry",
        measure=daylight.channel_order,
        unit="octaves",
        meaning="Skies are bluer than the ground and the sun; red and blue are not swapped.",
        low=lambda settings: settings.channel_order_min,
    ),
    Rule(
        name="wrap-seam",
        family="geometry",
        measure=geometry.seam_step,
        unit="σ",
        meaning="Left and right edge meet: the columns there do not stand out among all columns.",
        high=lambda settings: settings.seam_max,
    ),
    Rule(
        name="seam-repeat",
        family="geometry",
        measure=geometry.seam_repeat,
        unit="×",
        meaning="The last column is not the first one again: there is a step like those beside it.",
        low=lambda settings: settings.seam_repeat_min,
    ),
    Rule(
        name="poles",
        family="geometry",
        measure=geometry.pole_detail,
        unit="×",
        meaning="No pinwheel at zenith or nadir: the detail around them ends before the pole.",
        high=lambda settings: settings.pole_max,
    ),
    Rule(
        name="tilt",
        family="geometry",
        measure=tilt.tilt,
        unit="°",
        meaning="The map is level: its upright lines stand upright, its horizon is at its height.",
        high=lambda settings: settings.tilt_max_deg,
    ),
    Rule(
        name="uprightness",
        family="geometry",
        measure=daylight.uprightness,
        unit="octaves",
        meaning="Light comes from above, and what is above is bluer: not upside down.",
        low=lambda settings: settings.uprightness_min,
    ),
    Rule(
        name="sharpness",
        family="content",
        measure=content.sharpness,
        unit="×",
        meaning="The finest detail is there: the map was not enlarged from half its size.",
        low=lambda settings: settings.sharpness_min,
    ),
    Rule(
        name="empty-area",
        family="content",
        measure=content.empty_area,
        unit="%",
        meaning="The share of the sphere that is exactly black, as padding is.",
        high=lambda settings: settings.empty_area_max_percent,
    ),
    Rule(
        name="hole-area",
        family="content",
        measure=content.hole_area,
        unit="%",
        meaning="Holes that were found and not filled, by the record.",
        high=lambda settings: settings.hole_area_max_percent,
    ),
    Rule(
        name="filled-area",
        family="content",
        measure=content.filled_area,
        unit="%",
        meaning="What was made up to fill holes, by the record.",
        high=lambda settings: settings.filled_area_max_percent,
    ),
    Rule(
        name="sun-place",
        family="sun",
        measure=sunlight.sun_place,
        unit="°",
        meaning="The sun stands where place, heading and time say it stood.",
        high=lambda settings: settings.sun_place_max_deg,
    ),
    Rule(
        name="sun-clock",
        family="sun",
        measure=sunlight.sun_clock,
        unit="h",
        meaning="The error of the clock that would explain where the sun stands.",
        high=lambda settings: settings.sun_clock_max_h,
    ),
    Rule(
        name="sun-date",
        family="sun",
        measure=sunlight.sun_date,
        unit="°",
        meaning="The sun stands where it can stand on a date without a time of day.",
        high=lambda settings: settings.sun_date_max_deg,
    ),
    Rule(
        name="plausibility",
        family="plausibility",
        measure=plausibility,
        unit="σ",
        meaning="How far the spread of the light is from that of captured maps; 1 is typical.",
        high=lambda settings: settings.plausibility_max,
    ),
)


def check(
    envmap: EnvironmentMap,
    settings: QaSettings | None = None,
    *,
    capture: Capture | None = None,
    reference: ReferenceSet | None = None,
) -> Report:
    """Measure a map and hold every figure against its limits.

    Args:
        envmap: The map, with its records.
        settings: The limits; the defaults if not given.
        capture: Where it is from; None for what the map's record says.
        reference: The maps to place it among; None for those that ship.
    """
    return check_measured(Measurements(envmap, capture, reference), settings)


def check_measured(measured: Measurements, settings: QaSettings | None = None) -> Report:
    """The same for a map of which something is measured already, and is kept."""
    found = {rule.name: rule.measure(measured) for rule in RULES}
    return judge(
        {name: finding.value for name, finding in found.items()},
        settings,
        {name: finding.note for name, finding in found.items()},
    )


def judge(
    values: Mapping[str, float | None],
    settings: QaSettings | None = None,
    notes: Mapping[str, str] | None = None,
) -> Report:
    """The report that these figures give under these settings; a figure not given is None.

    Args:
        values: Of an earlier report.
        settings: The limits.
        notes: Of an earlier report; they have no part in the verdict.
    """
    settings = settings or QaSettings()
    notes = notes or {}
    return Report(
        checks=tuple(
            Check(
                name=rule.name,
                value=values.get(rule.name),
                unit=rule.unit,
                low=rule.low and rule.low(settings),
                high=rule.high and rule.high(settings),
                meaning=rule.meaning,
                family=rule.family,
                note=notes.get(rule.name, ""),
            )
            for rule in RULES
        ),
        settings_digest=settings.digest,
    )
