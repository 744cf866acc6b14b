"""What QA found out, in words: the lines of the tables on a map's page."""

from collections.abc import Mapping, Sequence
from typing import Any

from panokit.capture import Capture, TimePrecision
from panokit.envmap import Anchor, EnvironmentMap
from panokit.frames import Frame
from panokit.provenance import Provenance
from panokit.qa.comparison import Comparison
from panokit.qa.distribution import Standing
from panokit.qa.report.accuracy import grade_of
from panokit.qa.verdicts import Check, Verdict
from panokit.report.plain import in_words
from panokit.report.values import Badge, Cell, Column, Group, Table, Tone
from panokit.report.wording import format_figure, format_limit, words_of

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
# "Pass" would be taken for "the light is right", which no check can tell.
_VERDICTS: Mapping[str, str] = {"pass": "No defect", "fail": "Defect", "not-applicable": "n/a"}
_VERDICT_TONES: Mapping[str, Tone] = {"fail": "fail", "suspect": "fair", "warn": "fair"}
_LONGEST_VALUE = 120
_FIGURE, _VALUE = Column(label="Figure"), Column(label="Value", numeric=True)


def verdict_badge(verdict: str) -> Badge:
    """A verdict as a word that stands out."""
    text = _VERDICTS.get(verdict, words_of(verdict))
    return Badge(text=text, tone=_VERDICT_TONES.get(verdict, ""))


def _check_badge(verdict: str) -> Badge:
    """The same in the table of a map's checks, where most are as they should be."""
    return Badge(text="ok") if verdict == "pass" else verdict_badge(verdict)


def grade_badge(name: str, value: float | None) -> Badge | None:
    """How good a figure is, where it has bounds."""
    tones: dict[str, Tone] = {"good": "good", "fair": "fair", "poor": "poor"}
    grade = grade_of(name, value)
    return Badge(text=grade, tone=tones[grade]) if grade else None


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
        f"{words_of(check.name).lower()} is {format_figure(check.value, check.unit)}, "
        f"allowed is {_limits(check)}"
        for check in failed
    ]
    return f"Defect: {'; '.join(words)}."


def check_tables(checks: Sequence[Check]) -> tuple[Table, ...]:
    """The checks, a table for each family; those without a family in the first."""
    return tuple(
        Table(
            title=f"Checks: {words_of(family).lower()}" if family else "Checks for defects",
            columns=(_FIGURE, _VALUE),
            rows=tuple(_check_row(check) for check in members),
            headings=False,
        )
        for family, members in by_family(checks).items()
    )


def by_family(checks: Sequence[Check]) -> dict[str, list[Check]]:
    """Family -> its checks, in the order in which they come."""
    families: dict[str, list[Check]] = {}
    for check in checks:
        families.setdefault(check.family, []).append(check)
    return families


def _check_row(check: Check) -> tuple[Cell, Cell]:
    judged = check.verdict is not Verdict.NOT_APPLICABLE
    return (
        Cell(text=words_of(check.name), note=" ".join(filter(None, (check.meaning, check.note)))),
        Cell(
            text=format_figure(check.value, check.unit),
            badge=_check_badge(str(check.verdict)),
            note=_limits(check) if judged else "",
        ),
    )


def _limits(check: Check) -> str:
    if check.low is not None and check.high is not None:
        return f"{format_limit(check.low)} to {format_limit(check.high)}"
    if check.low is not None:
        return f"at least {format_limit(check.low)}"
    return "" if check.high is None else f"at most {format_limit(check.high)}"


def difference_table(comparison: Comparison) -> Table:
    """The differences from the truth."""
    gain = format_figure(comparison.gain)
    note = (
        ""
        if comparison.gain == 1.0
        else f"The scale is relative: the map was multiplied by {gain} first."
    )
    return Table(
        title="Against the reference",
        columns=(_FIGURE, _VALUE),
        rows=tuple(
            (
                Cell(text=difference.label, note=difference.meaning),
                Cell(
                    text=format_figure(difference.value, difference.unit),
                    badge=grade_badge(difference.name, difference.value),
                ),
            )
            for difference in comparison.differences
        ),
        headings=False,
        note=note,
    )


def standing_table(standings: Sequence[Standing]) -> Table:
    """Where the map's figures lie among those of the references."""
    return Table(
        title="Among the reference maps",
        columns=(_FIGURE, _VALUE, Column(label="Place among the references")),
        rows=tuple(_standing_row(standing) for standing in standings),
        headings=False,
    )


def _standing_row(standing: Standing) -> tuple[Cell, Cell, Cell]:
    low, median, high = (format_figure(v) for v in (standing.low, standing.median, standing.high))
    spread = f"References: median {median}, nine in ten from {low} to {high}."
    return (
        Cell(text=words_of(standing.name), note=f"{standing.meaning} {spread}"),
        Cell(text=format_figure(standing.value, standing.unit)),
        Cell(percent=standing.percentile, note=f"above {standing.percentile:.0f} % of them"),
    )


def step_group(provenance: Provenance) -> Group:
    """The provenance, one line for each step, closed until it is asked for."""
    table = Table(
        columns=(Column(label="Step"), Column(label="With")),
        rows=tuple(
            (
                Cell(text=step.stage, note=f"version {step.version}"),
                Cell(note=_values(step.values)),
            )
            for step in provenance.steps
        ),
        headings=False,
    )
    stages = ", ".join(step.stage for step in provenance.steps)
    return Group(title=f"How it was made: {stages}", sections=(table,), folded=True)


def _values(values: Mapping[str, Any]) -> str:
    return " · ".join(f"{name} {_short(value)}" for name, value in sorted(values.items()))


def _short(value: Any) -> str:
    text = in_words(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 1] + "…"
