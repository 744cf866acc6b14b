"""One judged map as its card on the page: pictures, and the words beside them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, StorageError
from panokit.io import read_environment_map
from panokit.qa.batch import JudgedMap
from panokit.qa.comparison import Comparison
from panokit.qa.report import pictures, words
from panokit.qa.report.html import Picture, picture


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
    checks: tuple[words.Row, ...]
    differences: tuple[words.Row, ...]
    obstacle: str
    gain_note: str
    standings: tuple[words.StandingRow, ...]
    steps: tuple[words.StepRow, ...]
    license: str
    attribution: str


def card_of(judged: JudgedMap, anchor: str) -> Card:
    """The card of a map that could be read.

    Raises:
        ItemError: If its file has changed since it was judged.
        StorageError: If its file has gone.
    """
    envmap = read_environment_map(judged.item.map_path)
    truth = _truth(judged)
    comparison = judged.comparison
    return Card(
        name=judged.item.name,
        anchor=anchor,
        verdict=str(judged.verdict),
        subtitle=words.subtitle(judged.capture, envmap),
        summary=words.failure_summary(judged.report.failed if judged.report else ()),
        photographs=_photographs(judged),
        views=_views(judged.item.name, envmap, truth),
        bracket=_bracket(judged.item.name, envmap),
        balls=_balls(judged.item.name, envmap, truth, comparison),
        checks=tuple(
            words.check_row(check) for check in (judged.report.checks if judged.report else ())
        ),
        differences=words.difference_rows(comparison),
        obstacle=comparison.obstacle if comparison else "",
        gain_note=words.gain_note(comparison),
        standings=tuple(words.standing_row(standing) for standing in judged.standings),
        steps=words.step_rows(judged.provenance),
        license=judged.capture.license.id if judged.capture else "unknown",
        attribution=judged.capture.license.attribution if judged.capture else "",
    )


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
    except (ItemError, StorageError):
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
            picture(pixels, alt=f"{kind} ball lit by {name}", disc=True, quality=84)
            for kind, pixels in kinds
        ),
    )
