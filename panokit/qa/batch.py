"""QA of many maps: each read once, judged alone, then against references."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from panokit.capture import Capture
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, Rejection, UsageError
from panokit.io import read_environment_map, write_bytes
from panokit.provenance import Provenance
from panokit.qa.against import Stage, matches_of, no_stage, pairs_of, set_against
from panokit.qa.checks import check_measured
from panokit.qa.comparison import Comparison, compare
from panokit.qa.distribution import Standing, scale_free_figures, standings
from panokit.qa.items import QaItem, find_maps
from panokit.qa.measurements import Measurements
from panokit.qa.pairs.judging import PairResults
from panokit.qa.plausibility import FIGURES, plausibility_figures
from panokit.qa.reference_set import ReferenceSet, own_reference, shipped_reference
from panokit.qa.sets.comparing import SetComparison
from panokit.qa.settings import VERSION, QaSettings
from panokit.qa.verdicts import Report, Verdict

SCHEMA = "panokit.qa/1"
PLAUSIBILITY = "plausibility"


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedMap:
    """What QA found out about one map.

    Attributes:
        item: The map and its pictures.
        report: Its checks, or None if it could not be read.
        rejection: Why it could not be read, or None.
        comparison: With its own truth, or None where there is none.
        standings: Among reference maps of other places; empty where there are too few.
        capture: Where it is from, as the item or the map's record says.
        provenance: The steps that made it.
    """

    item: QaItem
    report: Report | None = None
    rejection: Rejection | None = None
    comparison: Comparison | None = None
    standings: tuple[Standing, ...] = ()
    capture: Capture | None = None
    provenance: Provenance = field(default_factory=Provenance)

    @property
    def verdict(self) -> Verdict:
        """FAIL where the map cannot be read or a check fails."""
        return self.report.verdict if self.report else Verdict.FAIL

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`, free of paths, so that it is the same on any machine."""
        return {
            "name": self.item.name,
            "file": self.item.map_path.name,
            "verdict": str(self.verdict),
            "report": self.report and self.report.to_json(),
            "rejection": self.rejection and self.rejection.to_json(),
            "comparison": self.comparison and self.comparison.to_json(),
            "standings": [standing.to_json() for standing in self.standings],
            "license": self.capture.license.id if self.capture else None,
            "attribution": self.capture.license.attribution if self.capture else None,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class QaResult:
    """What QA found out about all maps.

    Attributes:
        maps: In the order they were given.
        settings: The limits they were held against.
        reference_names: The maps that make the distribution; empty where there is none.
        skipped_references: Reference files that could not be read, and why.
        sets: The maps as a set beside the reference set; None where there are too few.
        pairs: The maps beside their truths; None where there is no truth.
    """

    maps: tuple[JudgedMap, ...]
    settings: QaSettings = field(default_factory=QaSettings)
    reference_names: tuple[str, ...] = ()
    skipped_references: tuple[Rejection, ...] = ()
    sets: SetComparison | None = None
    pairs: PairResults | None = None

    @property
    def passed(self) -> tuple[JudgedMap, ...]:
        """The maps in which no check finds a defect."""
        return tuple(judged for judged in self.maps if judged.verdict is Verdict.PASS)

    @property
    def failed(self) -> tuple[JudgedMap, ...]:
        """The maps that were read and fail a check."""
        return tuple(j for j in self.maps if j.report and j.verdict is Verdict.FAIL)

    @property
    def unreadable(self) -> tuple[JudgedMap, ...]:
        """The maps that could not be read."""
        return tuple(judged for judged in self.maps if judged.rejection)

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`: the same for the same maps, settings and references."""
        return {
            "schema": SCHEMA,
            "version": VERSION,
            "settings": self.settings.model_dump(mode="json"),
            "counts": {
                "maps": len(self.maps),
                "passed": len(self.passed),
                "failed": len(self.failed),
                "unreadable": len(self.unreadable),
            },
            "references": list(self.reference_names),
            "skipped_references": [skipped.to_json() for skipped in self.skipped_references],
            "maps": [judged.to_json() for judged in self.maps],
            "sets": self.sets and self.sets.to_json(),
            "pairs": self.pairs and self.pairs.to_json(),
        }


def qa(
    maps: Sequence[QaItem],
    settings: QaSettings | None = None,
    *,
    reference: Path | None = None,
    truth: Path | None = None,
    out: Path | None = None,
    pictures: bool = False,
    stage: Stage = no_stage,
    on_judged: Callable[[JudgedMap], None] | None = None,
) -> QaResult:
    """Judge maps by themselves, against their truths, and as a set against a reference set.

    A map that cannot be read is a rejection in the result, not an exception.

    Args:
        maps: What to judge.
        settings: The limits.
        reference: A folder of maps. One with the name of a judged map is its truth; the
            others, if they are enough, make the distribution that each map is placed in, and
            take the place of the shipped figures in the check of plausibility; all of them,
            if they are enough, are the set that the maps are held against as a set.
        truth: A folder of true maps, by the names of the maps or of their captures; then
            `reference` gives no truths.
        out: The report's folder: pictures of pairs and what is known of each map go there.
        pictures: Whether OUT/plausibility/NAME.png shows where each map lies.
        stage: Shows progress; `panokit.console.Console.stage` does.
        on_judged: Called after each map.

    Raises:
        UsageError: If there is nothing to judge, or the folder holds no maps.
    """
    if not maps:
        raise UsageError("There is nothing to judge. Give at least one map.")
    settings = settings or QaSettings()
    others = _other_references(maps, reference)
    matches = matches_of(maps, reference, truth)
    population, among, skipped = _measure_references(others, settings.reference_count_min)
    drawn = out / PLAUSIBILITY if out and pictures else None
    judged_maps = []
    with stage("qa", len(maps)) as tick:
        for item in maps:
            true_map = matches.truths.get(item.name)
            judged = judge_item(
                item,
                settings,
                truth=true_map,
                population=population.values(),
                among=among,
                drawn=drawn,
            )
            judged_maps.append(judged)
            tick(rejected=judged.rejection is not None)
            if on_judged:
                on_judged(judged)
    readable = [judged.item for judged in judged_maps if judged.rejection is None]
    least = settings.reference_count_min
    sets = set_against(readable, reference, least, out, stage) if reference else None
    return QaResult(
        maps=tuple(judged_maps),
        settings=settings,
        reference_names=tuple(population),
        skipped_references=skipped,
        sets=sets,
        pairs=pairs_of(readable, matches, settings, out, stage),
    )


def judge_item(
    item: QaItem,
    settings: QaSettings,
    *,
    truth: Path | None = None,
    population: Iterable[Mapping[str, float | None]] = (),
    among: ReferenceSet | None = None,
    drawn: Path | None = None,
) -> JudgedMap:
    """Judge one map; see `qa`.

    Args:
        item: The map.
        settings: The limits.
        truth: The map it should be.
        population: `scale_free_figures` of each reference map of another place.
        among: The maps to place it among; None for those that ship.
        drawn: The folder for a picture of that; None for none.
    """
    try:
        envmap = read_environment_map(item.map_path)
    except ItemError as error:
        rejection = _rejection(item.name, item.map_path, error)
        return JudgedMap(item=item, rejection=rejection, capture=item.capture)
    measured = Measurements(envmap, item.capture, among)
    if drawn is not None:
        _draw(measured, item.name, drawn)
    return JudgedMap(
        item=item,
        report=check_measured(measured, settings),
        comparison=_compare_with(envmap, truth, settings) if truth else None,
        standings=standings(scale_free_figures(envmap), population),
        capture=item.capture or envmap.capture,
        provenance=envmap.provenance,
    )


def _compare_with(envmap: EnvironmentMap, truth: Path, settings: QaSettings) -> Comparison:
    try:
        reference = read_environment_map(truth)
    except ItemError as error:
        obstacle = str(error).replace(str(truth), truth.name)
        return Comparison(reference=truth.name, obstacle=obstacle)
    return compare(envmap, reference, settings, path=truth)


def _other_references(maps: Sequence[QaItem], reference: Path | None) -> dict[str, Path]:
    """The reference files that are of other places than the judged maps."""
    if reference is None:
        return {}
    if not reference.is_dir():
        raise UsageError(f"There is no folder {reference} of reference maps.")
    found = find_maps(reference)
    if not found:
        raise UsageError(f"There are no .exr or .hdr maps in {reference} to compare with.")
    judged = {name for item in maps for name in _names(item)}
    return {name: path for name, path in found.items() if name not in judged}


def _names(item: QaItem) -> tuple[str, ...]:
    """What a map's truth may be called: as the map, or as the picture it was made of."""
    return (item.name, item.capture.id) if item.capture else (item.name,)


def _measure_references(
    files: Mapping[str, Path], least: int
) -> tuple[dict[str, dict[str, float | None]], ReferenceSet | None, tuple[Rejection, ...]]:
    """The figures of the reference maps, for two purposes; none where there are too few."""
    measured, placed, skipped = {}, [], []
    for name, path in files.items():
        try:
            envmap = read_environment_map(path)
        except ItemError as error:
            skipped.append(_rejection(name, path, error))
            continue
        measured[name] = scale_free_figures(envmap)
        placed.append(plausibility_figures(Measurements(envmap)) or {})
    among = own_reference(placed, FIGURES, least)
    return measured if len(measured) >= least else {}, among, tuple(skipped)


def _draw(measured: Measurements, name: str, folder: Path) -> None:
    # matplotlib takes a second to import, which only those pay who want pictures.
    from panokit.qa.plausibility_figure import draw_plausibility

    figures = plausibility_figures(measured)
    if figures is not None:
        among = measured.reference or shipped_reference()
        write_bytes(folder / f"{name}.png", draw_plausibility(figures, among, name))


def _rejection(name: str, path: Path, error: ItemError) -> Rejection:
    """What the error says, with the file's name alone: reports are the same on any machine."""
    rejection = Rejection.from_error(name, "qa", error)
    return replace(rejection, message=rejection.message.replace(str(path), path.name))
