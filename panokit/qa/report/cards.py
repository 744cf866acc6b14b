"""One judged map as the words and pictures of its card on the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from panokit.capture import Capture, TimePrecision
from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import ItemError
from panokit.frames import Frame
from panokit.io import read_environment_map
from panokit.provenance import Provenance
from panokit.qa.batch import JudgedMap
from panokit.qa.comparison import Comparison
from panokit.qa.distribution import Standing
from panokit.qa.report import pictures
from panokit.qa.report.html import Picture, format_figure, format_limit, picture
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
    """

    label: str
    value: str
    meaning: str = ""
    limits: str = ""
    verdict: str = ""


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
class View:
    """A map as a whole: of the map that is judged, or of its reference."""

    tonemapped: Picture
    luminance: Picture


@dataclass(frozen=True, slots=True, kw_only=True)
class BallRow:
    """A row of relit balls: of the map, or of its reference."""

    label: str
    pictures: tuple[Picture, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRow:
    """One provenance step in words."""

    stage: str
    version: str
    values: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Card:
    """Everything that the page shows of one map."""

    name: str
    anchor: str
    verdict: str
    subtitle: str
    summary: str
    photographs: tuple[Picture, ...]
    views: tuple[View, ...]
    bracket: tuple[Picture, ...]
    balls: tuple[BallRow, ...]
    checks: tuple[Row, ...]
    differences: tuple[Row, ...]
    obstacle: str
    gain_note: str
    standings: tuple[StandingRow, ...]
    steps: tuple[StepRow, ...]
    license: str
    attribution: str


def card_of(judged: JudgedMap, anchor: str) -> Card:
    """The card of a map that could be read.

    Raises:
        ItemError: If its file has gone or changed since it was judged.
    """
    envmap = read_environment_map(judged.item.map_path)
    truth = _truth(judged)
    comparison = judged.comparison
    return Card(
        name=judged.item.name,
        anchor=anchor,
        verdict=str(judged.verdict),
        subtitle=_subtitle(judged.capture, envmap),
        summary=_summary(judged.report.failed if judged.report else ()),
        photographs=_photographs(judged),
        views=_views(judged.item.name, envmap, truth),
        bracket=_bracket(judged.item.name, envmap),
        balls=_balls(judged.item.name, envmap, truth, comparison),
        checks=tuple(
            _check_row(check) for check in (judged.report.checks if judged.report else ())
        ),
        differences=_difference_rows(comparison),
        obstacle=comparison.obstacle if comparison else "",
        gain_note=_gain_note(comparison),
        standings=tuple(_standing_row(standing) for standing in judged.standings),
        steps=_step_rows(judged.provenance),
        license=judged.capture.license.id if judged.capture else "unknown",
        attribution=judged.capture.license.attribution if judged.capture else "",
    )


def label_of(name: str) -> str:
    """A figure's name for people: "wrap-seam" is "Wrap seam"."""
    return name.replace("-", " ").capitalize()


def _truth(judged: JudgedMap) -> EnvironmentMap | None:
    comparison = judged.comparison
    if comparison is None or comparison.obstacle or comparison.path is None:
        return None
    return read_environment_map(comparison.path)


def _photographs(judged: JudgedMap) -> tuple[Picture, ...]:
    item = judged.item
    return (
        *_photograph(item.panorama_path, item.name, "Panorama, as stitched"),
        *_photograph(item.filled_path, item.name, "Holes filled"),
    )


def _views(name: str, envmap: EnvironmentMap, truth: EnvironmentMap | None) -> tuple[View, ...]:
    own = _view("Light map", name, envmap)
    return (own,) if truth is None else (own, _view("Reference", name, truth))


def _view(what: str, name: str, envmap: EnvironmentMap) -> View:
    return View(
        tonemapped=picture(
            pictures.tonemapped(envmap),
            alt=f"{what} of {name}, tone mapped to show sources and shadows at once",
            caption=f"{what}, tone mapped",
        ),
        luminance=picture(
            pictures.false_color(envmap),
            alt=f"{what} of {name}: luminance in false color, blue dark, red bright",
            caption=f"{what}: luminance, in stops from its median",
        ),
    )


def _photograph(path: Path | None, name: str, caption: str) -> list[Picture]:
    if path is None:
        return []
    try:
        pixels = pictures.panorama_pixels(path)
    except ItemError:
        # The map is what is judged; a picture beside it that has gone is not worth the report.
        return []
    return [picture(pixels, alt=f"{caption}: {name}", caption=caption)]


def _bracket(name: str, envmap: EnvironmentMap) -> tuple[Picture, ...]:
    return tuple(
        picture(
            exposure.pixels,
            alt=f"{name} at {_stops(exposure.stops)}",
            caption=_stops(exposure.stops),
            quality=76,
        )
        for exposure in pictures.exposures(envmap)
    )


def _stops(stops: int) -> str:
    if stops == 0:
        return "0 stops"
    return f"−{-stops} stop{'s' if stops != -1 else ''}"


def _balls(
    name: str,
    envmap: EnvironmentMap,
    truth: EnvironmentMap | None,
    comparison: Comparison | None,
) -> tuple[BallRow, ...]:
    if truth is None or comparison is None:
        return (_ball_row("This map", name, pictures.balls(envmap)),)
    aligned = envmap.with_changes(radiance=envmap.radiance * np.float32(comparison.gain))
    right = pictures.balls(truth)
    return (
        _ball_row("This map", name, pictures.balls(aligned, exposure=right.exposure)),
        _ball_row("Reference", f"the reference of {name}", right),
    )


def _ball_row(label: str, name: str, balls: pictures.Balls) -> BallRow:
    kinds = (("Diffuse", balls.diffuse), ("Glossy", balls.glossy), ("Mirror", balls.mirror))
    return BallRow(
        label=label,
        pictures=tuple(
            picture(pixels, alt=f"{kind} ball lit by {name}", round=True, quality=84)
            for kind, pixels in kinds
        ),
    )


def _subtitle(capture: Capture | None, envmap: EnvironmentMap) -> str:
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


def _summary(failed: Sequence[Check]) -> str:
    if not failed:
        return ""
    words = [
        f"{label_of(check.name).lower()} is {format_figure(check.value, check.unit)}, "
        f"allowed is {_limits(check)}"
        for check in failed
    ]
    return f"Fails: {'; '.join(words)}."


def _check_row(check: Check) -> Row:
    return Row(
        label=label_of(check.name),
        value=format_figure(check.value, check.unit),
        meaning=check.meaning,
        limits="" if check.verdict is Verdict.NOT_APPLICABLE else _limits(check),
        verdict=str(check.verdict),
    )


def _limits(check: Check) -> str:
    if check.low is not None and check.high is not None:
        return f"{format_limit(check.low)} to {format_limit(check.high)}"
    if check.low is not None:
        return f"at least {format_limit(check.low)}"
    return "" if check.high is None else f"at most {format_limit(check.high)}"


def _difference_rows(comparison: Comparison | None) -> tuple[Row, ...]:
    return tuple(
        Row(
            label=difference.label,
            value=format_figure(difference.value, difference.unit),
            meaning=difference.meaning,
        )
        for difference in (comparison.differences if comparison else ())
    )


def _gain_note(comparison: Comparison | None) -> str:
    if comparison is None or comparison.gain == 1.0:
        return ""
    return (
        f"The scale is relative: the map was multiplied by {format_figure(comparison.gain)} first."
    )


def _standing_row(standing: Standing) -> StandingRow:
    low, median, high = (format_figure(v) for v in (standing.low, standing.median, standing.high))
    return StandingRow(
        label=label_of(standing.name),
        value=format_figure(standing.value, standing.unit),
        meaning=standing.meaning,
        range=f"References: median {median}, nine in ten from {low} to {high}",
        place=f"above {standing.percentile:.0f} % of them",
        percent=f"{standing.percentile:.1f}",
    )


def _step_rows(provenance: Provenance) -> tuple[StepRow, ...]:
    return tuple(
        StepRow(stage=step.stage, version=step.version, values=_values(step.values))
        for step in provenance.steps
    )


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
