"""Judging expansion methods on HDR probes: `panokit evaluate expansion`.

Each probe is photographed with the test cameras; each method gets the pictures and is scored
against the probe by the protocol "panokit-expansion-1". What is scored is kept in the output
folder at once: an interrupted run goes on, and a new method costs only itself.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from panokit.console import Console
from panokit.errors import ItemError, UsageError
from panokit.evaluate.area_fit import AreaRecord, area_record, fit_rule, fit_rules
from panokit.evaluate.cache import ScoreCache
from panokit.evaluate.predictors import Method, Predictor, analytic_methods, area_method
from panokit.evaluate.predictors import check_names as _check_names
from panokit.evaluate.probe_set import ListedProbe, assign_folds, find_probes
from panokit.evaluate.scoring import Picture, Row, score_picture, take_picture
from panokit.evaluate.settings import ExpansionEvaluation


@dataclass(frozen=True, slots=True, kw_only=True)
class EvaluationResult:
    """All scores.

    Attributes:
        methods: The columns, in order.
        judged: Those that the user asked for; the others are always there.
        rows: One for each method, probe and camera, in order.
        unusable: Probes that could not be photographed or read -> why.
        rules: The area rule's numbers for each fold.
        rule_of_all: Those that all pictures together give: what a release would take.
        settings: What was asked for.
    """

    methods: tuple[str, ...]
    judged: tuple[str, ...]
    rows: tuple[Row, ...]
    unusable: dict[str, str]
    rules: dict[int, tuple[float, float]]
    rule_of_all: tuple[float, float]
    settings: ExpansionEvaluation


@dataclass(frozen=True, slots=True, kw_only=True)
class _Item:
    """A probe with its place in the list of all probes."""

    index: int
    fold: int
    probe: ListedProbe
    rolled: bool


def evaluate_expansion(
    probes: Path,
    methods: Sequence[Method],
    out: Path,
    settings: ExpansionEvaluation | None = None,
    console: Console | None = None,
) -> EvaluationResult:
    """Judge methods beside LDR, sRGB, inverse Reinhard and the area rule.

    Args:
        probes: A folder of HDR maps, with a manifest.csv or without.
        methods: Beyond the analytic ones, which are always there.
        out: Where scores are kept while it works.
        settings: How; the defaults if not given.
        console: Says how it goes.

    Raises:
        UsageError: If there is no probe to judge on, or two methods share a name.
    """
    settings = settings or ExpansionEvaluation()
    console = console or Console(quiet=True)
    fixed = [*analytic_methods(), *methods]
    _check_names([*fixed, area_method({})])
    every = find_probes(probes)
    folds = assign_folds(every, settings.folds).tolist()
    judged = _judged(every, folds, settings)
    cache = ScoreCache(out / "cache", settings)
    unusable: dict[str, str] = {}
    # The rule needs the pictures of all folds, also where one fold is judged.
    records = []
    fitting = _items(every, folds, settings) if settings.limit is None else judged
    with console.stage("pictures", len(fitting)) as tick:
        for item in fitting:
            records += _guarded(item, unusable, console, lambda i: _records(i, cache, settings))
            tick()
    rules = fit_rules(records, folds)
    of_all = fit_rule(records)
    columns = [*fixed, area_method(rules)]
    rows: list[Row] = []
    usable = [item for item in judged if item.probe.name not in unusable]
    # Fold by fold: a method with a network for each loads each once.
    usable.sort(key=lambda item: (item.fold, item.index))
    with console.stage("scores", len(usable)) as tick:
        for item in usable:
            rows += _guarded(
                item, unusable, console, lambda i: _scores(i, columns, cache, settings)
            )
            tick()
    if not rows:
        raise UsageError(f"No probe of {probes} could be judged: {next(iter(unusable.values()))}")
    order = [column.name for column in columns]
    return EvaluationResult(
        methods=tuple(order),
        judged=tuple(method.name for method in methods),
        rows=tuple(sorted(rows, key=lambda row: (order.index(row.method), row.camera, row.probe))),
        unusable=unusable,
        rules={fold: (rule.offset, rule.slope) for fold, rule in rules.items()},
        rule_of_all=(of_all.offset, of_all.slope),
        settings=settings,
    )


def _judged(
    every: Sequence[ListedProbe], folds: Sequence[int], settings: ExpansionEvaluation
) -> list[_Item]:
    items = [
        item
        for item in _items(every, folds, settings)
        if settings.fold is None or item.fold == settings.fold
    ][: settings.limit]
    if not items:
        raise UsageError(f"Fold {settings.fold} has no probe. Choose another, or fewer folds.")
    # Spread over the list, so that every kind of scene is turned.
    count = min(settings.roll_probes, len(items))
    turned = {round(i * (len(items) - 1) / max(count - 1, 1)) for i in range(count)}
    return [
        _Item(index=item.index, fold=item.fold, probe=item.probe, rolled=i in turned)
        for i, item in enumerate(items)
    ]


def _items(
    every: Sequence[ListedProbe], folds: Sequence[int], settings: ExpansionEvaluation
) -> list[_Item]:
    return [
        _Item(index=i, fold=fold, probe=probe, rolled=False)
        for i, (probe, fold) in enumerate(zip(every, folds, strict=True))
    ]


def _guarded(
    item: _Item,
    unusable: dict[str, str],
    console: Console,
    work: Callable[[_Item], list],
) -> list:
    """The work's results; a probe that cannot be used is noted, and the others go on."""
    try:
        return work(item)
    except ItemError as error:
        unusable[item.probe.name] = str(error)
        console.note(f"{item.probe.name} is left out: {error}")
        return []


def _pictures(item: _Item, settings: ExpansionEvaluation) -> list[Picture]:
    radiance = item.probe.radiance()
    return [
        take_picture(item.probe, radiance, camera, index=item.index, fold=item.fold)
        for camera in settings.cameras
    ]


def _records(item: _Item, cache: ScoreCache, settings: ExpansionEvaluation) -> list[AreaRecord]:
    kept = cache.area_records(item.probe, item.index, item.fold)
    if kept is not None:
        return kept
    made = [area_record(p.pixels, p.truth, item.fold) for p in _pictures(item, settings)]
    cache.keep_area_records(item.probe, item.index, made)
    return made


def _scores(
    item: _Item,
    columns: Sequence[Method],
    cache: ScoreCache,
    settings: ExpansionEvaluation,
) -> list[Row]:
    rows: list[Row] = []
    missing: list[tuple[str, Predictor]] = []
    for column in columns:
        if not column.has_fold(item.fold):
            continue
        predictor = column.predictor(item.fold)
        kept = cache.rows(item.probe, item.index, column.name, predictor, rolled=item.rolled)
        if kept is None:
            missing.append((column.name, predictor))
        else:
            rows += kept
    pictures = _pictures(item, settings) if missing else []
    for name, predictor in missing:
        made = [
            score_picture(name, predictor, picture, rolled=item.rolled and picture is pictures[0])
            for picture in pictures
        ]
        cache.keep_rows(item.probe, item.index, predictor, made, rolled=item.rolled)
        rows += made
    return rows
