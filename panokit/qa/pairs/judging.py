"""Maps against the maps they should be: which belongs to which, their scores, their pictures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from panokit.capture import Capture
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, RecordError, UsageError
from panokit.io import read_environment_map, read_json, write_bytes
from panokit.io.pictures import record_path
from panokit.qa.items import QaItem, find_maps
from panokit.qa.pairs.aligning import AlignedPair, align_pair
from panokit.qa.pairs.pictures import COLUMNS, FULL_STOPS, SCENES, encode_sheet, relit_sheet
from panokit.qa.pairs.scoring import (
    PairScore,
    columns,
    dominance_of,
    not_scored,
    scores_of,
    summaries,
)
from panokit.qa.sets.members import manifest_rows
from panokit.qa.settings import QaSettings

SCHEMA = "panokit.pairs/1"
FOLDER = "pairs"


@dataclass(frozen=True, slots=True, kw_only=True)
class Matches:
    """Which truth belongs to which map.

    Attributes:
        truths: Name of the map -> file of its truth.
        without_truth: Names of the maps that have none.
        unused: File names of the truths that belong to no map.
    """

    truths: Mapping[str, Path]
    without_truth: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PairResults:
    """All pairs.

    Attributes:
        scores: One for each map with a truth, in the order of the maps.
        without_truth: Names of the maps that have none.
        unused: File names of the truths that belong to no map.
    """

    scores: tuple[PairScore, ...]
    without_truth: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`, free of paths."""
        everything = summaries(self.scores)
        dominant = summaries(self.scores, dominant_only=True)
        compared = [score for score in self.scores if not score.obstacle]
        return {
            "schema": SCHEMA,
            "counts": {
                "pairs": len(self.scores),
                "compared": len(compared),
                "with_dominant_light": sum(score.has_dominant_light for score in compared),
                "without_truth": len(self.without_truth),
                "unused_truths": len(self.unused),
            },
            "without_truth": list(self.without_truth),
            "unused_truths": list(self.unused),
            "columns": [
                {
                    **column.to_json(),
                    "summary": _summary(everything[column.name]),
                    "summary_dominant": _summary(dominant[column.name]),
                }
                for column in columns()
            ],
            "not_scored": not_scored(),
            "pictures": {
                "rows": list(SCENES),
                "columns": list(COLUMNS),
                "difference_stops": FULL_STOPS,
            },
            "pairs": [score.to_json() for score in self.scores],
        }


def match_truths(items: Sequence[QaItem], folder: Path) -> Matches:
    """Find the truth of each map in a folder.

    A truth belongs to a map if its file, its name in the folder's manifest.csv or the capture in
    its record has the map's name, or the id or key of the map's capture. A map or a truth
    without the other is told of, and no error.

    Raises:
        UsageError: If the folder does not exist or holds no maps.
        StorageError: If it cannot be read.
    """
    if not folder.is_dir():
        raise UsageError(f"There is no folder {folder} of true maps.")
    files = find_maps(folder)
    if not files:
        raise UsageError(f"There are no .exr or .hdr maps in {folder} to compare with.")
    rows = manifest_rows(folder)
    by_manifest = {rows[path.name].name: path for path in files.values() if path.name in rows}
    called = {name for item in items for name in _names(item)}
    named = {path for known in (files, by_manifest) for n, path in known.items() if n in called}
    by_capture = _by_capture([path for path in files.values() if path not in named])
    truths = {}
    for item in items:
        found = item.truth_path or next(
            (
                known[name]
                for known in (files, by_manifest, by_capture)
                for name in _names(item)
                if name in known
            ),
            None,
        )
        if found is not None:
            truths[item.name] = found
    used = set(truths.values())
    return Matches(
        truths=truths,
        without_truth=tuple(item.name for item in items if item.name not in truths),
        unused=tuple(path.name for path in files.values() if path not in used),
    )


def judge_pairs(
    items: Sequence[QaItem],
    matches: Matches,
    settings: QaSettings | None = None,
    *,
    out: Path | None = None,
    on_judged: Callable[[PairScore], None] | None = None,
) -> PairResults:
    """Score every map that has a truth.

    A pair that cannot be compared has an obstacle and no figures.

    Args:
        items: The maps.
        matches: Their truths, from `match_truths`.
        settings: The size at which they are compared.
        out: The report's folder: pictures of relit scenes go to OUT/pairs. None for none.
        on_judged: Called after each pair, for progress.

    Raises:
        StorageError: If a picture cannot be written.
    """
    settings = settings or QaSettings()
    scores = []
    for item in items:
        if item.name in matches.truths:
            scores.append(_judge(item, matches.truths[item.name], settings, out))
            if on_judged:
                on_judged(scores[-1])
    return PairResults(
        scores=tuple(scores), without_truth=matches.without_truth, unused=matches.unused
    )


def score_pair(
    envmap: EnvironmentMap, truth: EnvironmentMap, settings: QaSettings | None = None
) -> PairScore:
    """One map against its truth, under every protocol.

    Raises:
        ItemError: If they cannot be compared.
    """
    return _scored(align_pair(envmap, truth, (settings or QaSettings()).comparison_width_px))


def _judge(item: QaItem, truth_path: Path, settings: QaSettings, out: Path | None) -> PairScore:
    try:
        envmap, truth = (read_environment_map(path) for path in (item.map_path, truth_path))
        pair = align_pair(envmap, truth, settings.comparison_width_px)
        scored = _scored(pair)
    except ItemError as error:
        said = str(error)
        for path in (item.map_path, truth_path):
            said = said.replace(str(path), path.name)
        return PairScore(name=item.name, reference=truth_path.name, obstacle=said)
    picture = ""
    if out is not None:
        picture = f"{FOLDER}/{item.name}.jpg"
        write_bytes(out / picture, encode_sheet(relit_sheet(pair)))
    return replace(scored, name=item.name, reference=truth_path.name, picture=picture)


def _scored(pair: AlignedPair) -> PairScore:
    return PairScore(
        name="",
        reference="",
        gain=pair.gain,
        dominance=dominance_of(pair),
        values=scores_of(pair),
    )


def _names(item: QaItem) -> tuple[str, ...]:
    if item.capture is None:
        return (item.name,)
    return (item.name, item.capture.id, item.capture.key)


def _by_capture(paths: Sequence[Path]) -> dict[str, Path]:
    """Truths by the id and key of their capture, where only one of them has it."""
    found: dict[str, list[Path]] = {}
    for path in paths:
        capture = _capture_of(path)
        for name in {capture.id, capture.key} if capture else ():
            found.setdefault(name, []).append(path)
    return {name: of_one[0] for name, of_one in found.items() if len(of_one) == 1}


def _capture_of(path: Path) -> Capture | None:
    record = record_path(path)
    try:
        return Capture.from_json(read_json(record)["capture"]) if record.exists() else None
    except (RecordError, KeyError, TypeError):
        return None


def _summary(summary: Any) -> dict[str, int | float] | None:
    return summary.to_json() if summary is not None else None
