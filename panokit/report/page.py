"""The file itself: sections, style, scripts and maps in one HTML file that needs nothing else.

A policy in the page forbids every request and every script but its own, by their digests; all
texts are escaped, and the scripts never make markup of data.
"""

import base64
import hashlib
import math
import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup, escape

import panokit
from panokit.errors import UsageError
from panokit.io import write_bytes
from panokit.report import charts
from panokit.report.pictures import HIGHEST_STOP, LOWEST_STOP, false_color_palette
from panokit.report.values import Gallery, Group, MapEntry, Page, Section

# In the order in which each stands on what is before it.
_SCRIPTS = (
    "codec.js",
    "data.js",
    "camera.js",
    "shader.js",
    "renderer.js",
    "viewer.js",
    "input.js",
    "gallery.js",
    "main.js",
)
_STYLES = ("report.css", "gallery.css", "viewer.css", "print.css")
# One map alone, for a frame in another page.
_LONE_SCRIPTS = (*_SCRIPTS[:-2], "lone.js")
_LONE_STYLES = ("report.css", "gallery.css", "viewer.css", "lone.css")
_FEWEST_CONTENTS = 3
_LEGEND_WORDS = (
    f"Legend: from dark blue, {-LOWEST_STOP} stops below the median, to dark red, "
    f"{HIGHEST_STOP} stops above it"
)


def write_page(page: Page, path: Path) -> Path:
    """Write a report as one HTML file that opens from disk.

    Raises:
        UsageError: If the page has two galleries, or two maps of one name.
        StorageError: If the file cannot be written.
    """
    write_bytes(Path(path), render_page(page).encode())
    return Path(path)


def render_page(page: Page) -> str:
    """The HTML of a report: equal pages are equal texts.

    Raises:
        UsageError: If the page has two galleries, or two maps of one name.
    """
    entries = _entries(page)
    anchors = dict(
        zip(
            (entry.name for entry in entries),
            _anchors("map", [entry.name for entry in entries]),
            strict=True,
        )
    )
    titles = [section.title for section in page.sections]
    places = _anchors("part", titles)
    contents = [(title, place) for title, place in zip(titles, places, strict=True) if title]
    style, script = _asset_text(_STYLES), _script(_SCRIPTS)
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            page=page,
            version=panokit.__version__,
            policy=_policy(style, script),
            style=Markup(style),
            script=Markup(script),
            anchors=anchors,
            places=places,
            contents=contents if len(contents) >= _FEWEST_CONTENTS else [],
            entries=entries,
            blocks=_blocks(entries),
            data=_data(entries, anchors),
            legend_ticks=_legend_ticks(),
            legend_words=_LEGEND_WORDS,
        )
    )


def render_viewer(entry: MapEntry) -> str:
    """The HTML of one map alone, open in the viewer: for a frame in another page.

    Raises:
        UsageError: If the map has no layers.
    """
    entries = _entries(Page(title=entry.name, head=(Gallery(entries=(entry,)),)))
    anchors = {entry.name: "map-alone"}
    style, script = _asset_text(_LONE_STYLES), _script(_LONE_SCRIPTS)
    return (
        _environment()
        .get_template("lone.html.j2")
        .render(
            entry=entry,
            anchor=anchors[entry.name],
            policy=_policy(style, script),
            style=Markup(style),
            script=Markup(script),
            blocks=_blocks(entries),
            data=_data(entries, anchors),
            legend_ticks=_legend_ticks(),
            legend_words=_LEGEND_WORDS,
        )
    )


def _entries(page: Page) -> tuple[MapEntry, ...]:
    galleries = list(_galleries((*page.head, *page.sections)))
    if len(galleries) > 1:
        raise UsageError("A page has one gallery. Put all maps into it, told apart by category.")
    entries = galleries[0].entries if galleries else ()
    names = [entry.name for entry in entries]
    doubled = sorted({name for name in names if names.count(name) > 1}) if names else []
    if doubled:
        raise UsageError(f"Two maps of the gallery are called {doubled[0]!r}. Give each its name.")
    for entry in entries:
        if not entry.layers:
            raise UsageError(f"The map {entry.name!r} has no layers. Make it with light_map.")
    return entries


def _galleries(sections: Sequence[Section]) -> Iterator[Gallery]:
    for section in sections:
        if isinstance(section, Gallery):
            yield section
        elif isinstance(section, Group):
            yield from _galleries(section.sections)


def _anchors(kind: str, names: Sequence[str]) -> list[str]:
    """An id for each name that no other has, whatever characters they are made of."""
    taken: dict[str, None] = {}
    for name in names:
        base = f"{kind}-" + (re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") or "x")
        anchor, number = base, 2
        while anchor in taken:
            anchor, number = f"{base}-{number}", number + 1
        taken[anchor] = None
    return list(taken)


def _block(entry: int, layer: int) -> str:
    return f"layer-{entry}-{layer}"


def _blocks(entries: Sequence[MapEntry]) -> list[tuple[str, str]]:
    """Id -> what the viewer decodes: the layer, and the light of balls, in one text."""
    return [
        (_block(i, j), f"{layer.data} {layer.diffuse} {layer.glossy}")
        for i, entry in enumerate(entries)
        for j, layer in enumerate(entry.layers)
    ]


def _data(entries: Sequence[MapEntry], anchors: dict[str, str]) -> dict[str, Any]:
    return {
        "palette": base64.b64encode(false_color_palette().tobytes()).decode(),
        "maps": [
            {
                "name": entry.name,
                "anchor": anchors[entry.name],
                "subtitle": entry.subtitle,
                "summary": entry.summary,
                "verdict": entry.badge.text if entry.badge else "",
                "category": entry.category,
                "figures": {k: _number(v) for k, v in entry.figures.items()},
                "displayGain": entry.display_gain,
                "ballGain": entry.ball_gain,
                "unit": entry.unit,
                "layers": [
                    {
                        "label": layer.label,
                        "block": _block(i, j),
                        "width": layer.width_px,
                        "height": layer.height_px,
                        "photo": layer.photo,
                        "gain": layer.gain,
                        "median": layer.median,
                    }
                    for j, layer in enumerate(entry.layers)
                ],
            }
            for i, entry in enumerate(entries)
        ],
    }


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def _breakable(name: str) -> Markup:
    """A name with places where a line may end; names of files have few."""
    return escape(name).replace("_", Markup("_<wbr>"))


def _legend_ticks() -> list[str]:
    stops = range(LOWEST_STOP, HIGHEST_STOP + 1, 4)
    return [f"{'+' if s > 0 else '−' if s < 0 else ''}{abs(s)}" for s in stops]


def _policy(style: str, script: str) -> str:
    """What a browser may do with the page: nothing but run this script and this style."""
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src '{_digest(script)}'",
            f"style-src '{_digest(style)}'",
            "img-src data: blob:",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


@lru_cache(maxsize=2)
def _script(names: tuple[str, ...]) -> str:
    """All scripts in a scope of their own."""
    return f'(() => {{\n"use strict";\n{_asset_text(names)}}})();'


@lru_cache(maxsize=4)
def _asset_text(names: tuple[str, ...]) -> str:
    folder = Path(__file__).parent / "assets"
    return "\n".join((folder / name).read_text(encoding="utf-8") for name in names)


@lru_cache(maxsize=1)
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("panokit.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["kind"] = lambda section: type(section).__name__
    environment.filters["drawn"] = charts.draw
    environment.filters["breakable"] = _breakable
    environment.globals["summary_columns"] = charts.SUMMARY_COLUMNS
    return environment
