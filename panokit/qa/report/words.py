"""What QA found out, in words: the lines of the tables on a map's card."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from panokit.capture import Capture, TimePrecision
from panokit.envmap import Anchor, EnvironmentMap
from panokit.frames import Frame
from panokit.provenance import Provenance
from panokit.qa.comparison import Comparison
from panokit.qa.distribution import Standing
from panokit.qa.report.accuracy import grade_of
from panokit.qa.report.html import format_figure, format_limit
from panokit.qa.verdicts import Check, Verdict

_TIME_FORMATS: Mapping[TimePrecision, str] = {
    TimePrecision.SECOND: "%Y-%m-%d %H:%M UTC",
    TimePrecision.DAY: "%Y-%m-%d",
    TimePrecision.MONTH: "%Y-%m",
    TimePrecision.YEAR: "%Y",
}
_FRAMES: Mapping[Frame, str] = {
    Frame.WORLD: "north at the center",
    Frame.LEVEL: "level, heading unknown",
    Frame.CAMERA: "as the camera stood",
}
_ANCHORS: Mapping[Anchor, str] = {
    Anchor.RELATIVE: "relative scale",
    Anchor.LDR_WHITE: "1.0 is the camera's white",
    Anchor.LUMINANCE: "in cd/m²",
    Anchor.RADIANCE: "in W/(sr m²)",
}
_LONGEST_VALUE = 120


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One line of a table: every cell is a finished text.

    Attributes:
        label: What the figure is called.
        value: The figure with its unit.
        meaning: The plain sentence below the label.
        limits: What passes, for a check.
        verdict: "pass", "fail" or "not-applicable", for a check.
        grade: "good", "fair" or "poor", for a difference from the truth that has bounds.
    """

    label: str
    value: str
    meaning: str = ""
    limits: str = ""
    verdict: str = ""
    grade: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class StandingRow:
    """Where one figure lies among those of the references, in words."""

    label: str
    value: str
    meaning: str
    range: str
    place: str
    percent: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRow:
    """One provenance step in words."""

    stage: str
    version: str
    values: str


def label_of(name: str) -> str:
    """A figure's name for people: "wrap-seam" is "Wrap seam"."""
    return name.replace("-", " ").capitalize()


def subtitle(capture: Capture | None, envmap: EnvironmentMap) -> str:
    """Where, when and how the map was taken, and its size, frame and scale."""
    parts = []
    if capture is not None:
        parts.append(capture.place)
        if capture.time is not None and capture.time_precision is not None:
            parts.append(capture.time.strftime(_TIME_FORMATS[capture.time_precision]))
        parts.append(f"from {capture.provider}")
    parts.append(f"{envmap.width_px}x{envmap.height_px}")
    parts.append(_FRAMES[envmap.frame])
    parts.append(_ANCHORS[envmap.anchor])
    return " · ".join(part for part in parts if part)


def failure_summary(failed: Sequence[Check]) -> str:
    """One sentence on the checks that fail, "" if none does."""
    if not failed:
        return ""
    words = [
        f"{label_of(check.name).lower()} is {format_figure(check.value, check.unit)}, "
        f"allowed is {_limits(check)}"
        for check in failed
    ]
    return f"Defect: {'; '.join(words)}."


def check_row(check: Check) -> Row:
    """A check as a line of its table."""
    return Row(
        label=label_of(check.name),
        value=format_figure(check.value, check.unit),
        meaning=check.meaning,
        limits="" if check.verdict is Verdict.NOT_APPLICABLE else _limits(check),
        verdict=str(check.verdict),
    )


def difference_rows(comparison: Comparison | None) -> tuple[Row, ...]:
    """The differences from the truth as lines of their table."""
    return tuple(
        Row(
            label=difference.label,
            value=format_figure(difference.value, difference.unit),
            meaning=difference.meaning,
            grade=grade_of(difference.name, difference.value),
        )
        for difference in (comparison.differences if comparison else ())
    )


def gain_note(comparison: Comparison | None) -> str:
    """What was done to the scale before comparing, "" if nothing."""
    if comparison is None or comparison.gain == 1.0:
        return ""
    return (
        f"The scale is relative: the map was multiplied by {format_figure(comparison.gain)} first."
    )


def standing_row(standing: Standing) -> StandingRow:
    """A standing as a line of its table."""
    low, median, high = (format_figure(v) for v in (standing.low, standing.median, standing.high))
    return StandingRow(
        label=label_of(standing.name),
        value=format_figure(standing.value, standing.unit),
        meaning=standing.meaning,
        range=f"References: median {median}, nine in ten from {low} to {high}",
        place=f"above {standing.percentile:.0f} % of them",
        percent=f"{standing.percentile:.1f}",
    )


def step_rows(provenance: Provenance) -> tuple[StepRow, ...]:
    """The provenance, one line for each step."""
    return tuple(
        StepRow(stage=step.stage, version=step.version, values=_values(step.values))
        for step in provenance.steps
    )


def _limits(check: Check) -> str:
    if check.low is not None and check.high is not None:
        return f"{format_limit(check.low)} to {format_limit(check.high)}"
    if check.low is not None:
        return f"at least {format_limit(check.low)}"
    return "" if check.high is None else f"at most {format_limit(check.high)}"


def _values(values: Mapping[str, Any]) -> str:
    words = (f"{name} {_short(value)}" for name, value in sorted(values.items()))
    return " · ".join(words)


def _short(value: Any) -> str:
    if isinstance(value, float):
        return format_figure(value)
    if isinstance(value, list | tuple) and all(isinstance(v, int | float) for v in value):
        value = "[" + ", ".join(format_figure(v) for v in value) + "]"
    text = str(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 1] + "…"
