"""One judged map as an entry of the gallery: its layers, and all that was found out about it."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, StorageError
from panokit.io import decode_image, read_environment_map
from panokit.io.files import read_bytes
from panokit.qa.batch import JudgedMap
from panokit.qa.report import words
from panokit.report.entries import light_map
from panokit.report.plain import sections_of
from panokit.report.values import MapEntry, Section, Text
from panokit.report.wording import words_of

# What the entry shows by itself; anything else that a judged map tells is shown as it is.
_SHOWN = {
    "name",
    "file",
    "verdict",
    "report",
    "rejection",
    "comparison",
    "standings",
    "license",
    "attribution",
    "category",
}


def entry_of(judged: JudgedMap, width_px: int) -> MapEntry:
    """The entry of a map that could be read.

    Args:
        judged: The map.
        width_px: The most that its layers may be wide.

    Raises:
        ItemError: If its file has changed since it was judged.
        StorageError: If its file has gone.
    """
    envmap = read_environment_map(judged.item.map_path)
    return light_map(
        envmap,
        judged.item.name,
        photos=_photographs(judged),
        references=_references(judged),
        width_px=width_px,
        badge=words.verdict_badge(str(judged.verdict)),
        category=_category(judged),
        figures=figures_of(judged),
        subtitle=words.subtitle(judged.capture, envmap),
        summary=words.failure_summary(judged.report.failed if judged.report else ()),
        facts=_facts(judged),
    )


def count_layers(maps: tuple[JudgedMap, ...]) -> tuple[int, int]:
    """How many maps of radiance, and how many photographs, the page will hold."""
    read = [judged for judged in maps if judged.report is not None]
    truths = sum(_truth_path(judged) is not None for judged in read)
    photos = sum(path is not None for judged in read for path in _photograph_paths(judged).values())
    return len(read) + truths, photos


def figures_of(judged: JudgedMap) -> dict[str, float | None]:
    """Label -> value of every check and every difference, to sort by."""
    checks = judged.report.checks if judged.report else ()
    differences = judged.comparison.differences if judged.comparison else ()
    figures: dict[str, float | None] = {words_of(c.name): c.value for c in checks}
    return figures | {difference.label: difference.value for difference in differences}


def _category(judged: JudgedMap) -> str:
    said = getattr(judged, "category", "")
    return str(said) if said else judged.capture.place if judged.capture else ""


def _truth_path(judged: JudgedMap) -> Path | None:
    comparison = judged.comparison
    return None if comparison is None or comparison.obstacle else comparison.path


def _references(judged: JudgedMap) -> dict[str, tuple[EnvironmentMap, float]]:
    """The truth on the map's own scale."""
    path, comparison = _truth_path(judged), judged.comparison
    if path is None or comparison is None:
        return {}
    return {"Reference": (read_environment_map(path), 1 / comparison.gain)}


def _photograph_paths(judged: JudgedMap) -> dict[str, Path | None]:
    item = judged.item
    return {"Panorama, holes filled": item.filled_path, "Panorama, as stitched": item.panorama_path}


def _photographs(judged: JudgedMap) -> dict[str, NDArray[np.uint8]]:
    found = {}
    for label, path in _photograph_paths(judged).items():
        pixels = _photograph(path) if path else None
        if pixels is not None:
            found[label] = pixels
    return found


def _photograph(path: Path) -> NDArray[np.uint8] | None:
    """A picture beside the map; one that has gone is not worth the report."""
    try:
        pixels = decode_image(read_bytes(path), what=str(path))
    except (ItemError, StorageError):
        return None
    whole = pixels.shape[1] == 2 * pixels.shape[0]
    return pixels if whole else None


def _facts(judged: JudgedMap) -> tuple[Section, ...]:
    facts: list[Section] = list(words.check_tables(judged.report.checks if judged.report else ()))
    comparison = judged.comparison
    if comparison is not None and comparison.obstacle:
        said = f"Not compared: {comparison.obstacle}"
        facts.append(Text(title="Against the reference", paragraphs=(said,), small=True))
    elif comparison is not None and comparison.differences:
        facts.append(words.difference_table(comparison))
    if judged.standings:
        facts.append(words.standing_table(judged.standings))
    record: dict[str, Any] = judged.to_json()
    for key, value in record.items():
        if key not in _SHOWN and value not in (None, (), [], {}, ""):
            facts += sections_of(words_of(key), value)
    if judged.provenance.steps:
        facts.append(words.step_group(judged.provenance))
    return (*facts, _terms(judged))


def _terms(judged: JudgedMap) -> Text:
    capture = judged.capture
    parts = [capture.license.id, capture.license.attribution] if capture else ["unknown"]
    return Text(title="License", paragraphs=(" · ".join(p for p in parts if p),), small=True)
