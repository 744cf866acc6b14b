"""What a pipeline would take: items, requests, money, disk and time, before anything starts.

Nothing is asked of any server and nothing is written: counts are what the areas ask for, and costs
are those of `panokit.pipeline.costs`. They are estimates, and say so.
"""

import math
import shutil
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from panokit.engine import available_cores
from panokit.engine.settings import SLURM_JOBS
from panokit.fetch.prices import price_of
from panokit.fetch.settings import FetchSettings
from panokit.fetch.where import total_wanted
from panokit.ledger import Ledger
from panokit.pipeline.beforehand import nearest_there
from panokit.pipeline.costs import (
    COSTS,
    MEASURED,
    SAMPLE_COSTS,
    SCORE_BYTES,
    SCORE_CPU_S,
    TRAIN_BYTES,
    TRAIN_INPUT_PX,
    TRAIN_SAMPLE_CPU_S,
    TRAIN_START_CPU_S,
    TRAIN_WIDTH,
    StageCost,
    at_width,
)
from panokit.pipeline.references import references_folder
from panokit.pipeline.runner import stages_up_to
from panokit.pipeline.serving import served_asks
from panokit.pipeline.settings import (
    MODEL_STAGES,
    DatasetStage,
    EvaluateStage,
    PipelineSettings,
)
from panokit.records import RunFolder

# A search brings about so many pictures of a place; what is too near is passed over.
_FOUND_PER_SEARCH = 20
_GOOGLE_WIDTH_PX, _TILE_PX = 16384, 512
# Where stitch sets no limit; services have hardly any wider ones.
_WIDEST_PX = 16384
# Stages that work item by item on the engine's workers; the others have one process.
_PARALLEL = ("stitch", "inpaint", "expand", "dataset")


@dataclass(frozen=True, slots=True, kw_only=True)
class StagePlan:
    """What one stage would take.

    Attributes:
        stage: The stage.
        unit: What its items are.
        items: How many the pipeline asks for; None where nobody knows before.
        done: How many of them are done.
        requests: To send.
        cost_usd: By list price, nothing free.
        cpu_s: Processor seconds.
        seconds: On as many workers as the stage uses.
        bytes: That stay on disk.
    """

    stage: str
    unit: str = "panorama"
    items: int | None = 0
    done: int = 0
    requests: int = 0
    cost_usd: float = 0.0
    cpu_s: float = 0.0
    seconds: float = 0.0
    bytes: float = 0.0

    @property
    def left(self) -> int:
        """Items still to be done."""
        return max((self.items or 0) - self.done, 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What a whole pipeline would take.

    Attributes:
        name: Of the pipeline.
        stages: In order.
        workers: That the time is for; of a scheduler's, one if the pipeline does not say how many.
        quota_days: Days that the sources' usual quotas take, None where they have none.
        within_quota: Whether one start can send all requests and spend all money.
        free_bytes: On the disk that the run goes to.
        measured: When and where the costs were measured.
    """

    name: str
    stages: tuple[StagePlan, ...]
    workers: int
    quota_days: int | None
    within_quota: bool
    free_bytes: int
    measured: str = MEASURED

    def total(self, figure: str) -> float:
        """The sum of one figure over all stages."""
        return sum(getattr(stage, figure) for stage in self.stages)

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        totals = ("requests", "cost_usd", "cpu_s", "seconds", "bytes")
        return {**asdict(self), "total": {name: self.total(name) for name in totals}}


def plan_pipeline(settings: PipelineSettings, *, stop_after: str | None = None) -> Plan:
    """What a pipeline would take, less what its run has done already.

    Args:
        settings: Of the pipeline.
        stop_after: The last stage; all if not given.

    Raises:
        UsageError: If it has no such stage.
        PlaceError: If a city is not known, or no place is given.
    """
    workers = _workers(settings)
    run = RunFolder(settings.folder())
    done = {stage: count for stage, (count, _, _) in Ledger(run.ledger).counts().items()}
    asks = served_asks(settings)
    counts = [total_wanted(ask) for ask in asks]
    panoramas = None if None in counts else sum(count or 0 for count in counts)
    stages = []
    for stage in stages_up_to(settings, stop_after):
        plan = _stage_plan(stage, settings, panoramas, done.get(stage, 0), workers)
        stages.append(_with_requests(plan, asks) if stage == "fetch" else plan)
    fetch = stages[0]
    limits = (settings.quota.max_requests, settings.quota.max_cost_usd)
    return Plan(
        name=settings.name,
        stages=tuple(stages),
        workers=workers,
        quota_days=_quota_days(asks),
        within_quota=all(
            limit is None or spent <= limit
            for limit, spent in zip(limits, (fetch.requests, fetch.cost_usd), strict=True)
        ),
        free_bytes=_free_bytes(run.root),
    )


def _workers(settings: PipelineSettings) -> int:
    """How many workers an engine has; of a scheduler that nobody was told of, one."""
    if settings.engine == "serial":
        return 1
    own = {"local": available_cores(), "dask": available_cores(), "slurm": SLURM_JOBS}
    return settings.workers or own.get(settings.engine, 1)


def requests_of(ask: FetchSettings, panoramas: int, *, places: int = 1) -> tuple[int, int]:
    """How many requests some panoramas of a source take: to search, and for their files.

    Args:
        ask: Where from, and how large.
        panoramas: How many.
        places: That they are spread over.
    """
    if ask.source == "folder" or panoramas == 0:
        return 0, 0
    searches = max(places, math.ceil(panoramas / _FOUND_PER_SEARCH))
    if ask.source == "google-tiles":
        searches += panoramas  # metadata, which is free
    return searches, panoramas * files_per_panorama(ask)


def files_per_panorama(ask: FetchSettings) -> int:
    """How many files a panorama comes in: one, or its tiles, or its views."""
    if ask.source == "google-tiles":
        if ask.zoom is not None:
            columns = max(1, (_GOOGLE_WIDTH_PX // _TILE_PX) >> (5 - ask.zoom))
        else:
            columns = math.ceil(min(ask.width_px, _GOOGLE_WIDTH_PX) / _TILE_PX)
        return columns * max(1, columns // 2)
    if ask.source == "google-static":
        from panokit.fetch.google_static import plan_views

        return len(plan_views(ask.view_fov_deg))
    return 1


def _with_requests(plan: StagePlan, asks: Sequence[FetchSettings]) -> StagePlan:
    requests, cost, slowest = 0, 0.0, 0.0
    done = plan.done
    for ask in asks:
        wanted = total_wanted(ask) or 0
        left, done = max(wanted - done, 0), max(done - wanted, 0)
        searches, files = requests_of(ask, left)
        requests += searches + files
        cost += files * price_of(ask.source, ask.prices).usd_per_unit
        slowest += (searches + files) / ask.requests_per_s
    return replace(plan, requests=requests, cost_usd=cost, seconds=max(plan.seconds, slowest))


def _quota_days(asks: Sequence[FetchSettings]) -> int | None:
    """Days of the sources' usual quotas; one source after the other."""
    days = 0
    for ask in asks:
        price = price_of(ask.source, ask.prices)
        if price.per_day:
            days += math.ceil((total_wanted(ask) or 0) * files_per_panorama(ask) / price.per_day)
    return days or None


def _stage_plan(
    stage: str, settings: PipelineSettings, panoramas: int | None, done: int, workers: int
) -> StagePlan:
    items, cost = _items_and_cost(stage, settings, panoramas)
    left = max((items or 0) - done, 0)
    cpu_s = left * cost.cpu_s
    return StagePlan(
        stage=stage,
        unit=cost.unit,
        items=items,
        done=min(done, items) if items is not None else done,
        cpu_s=cpu_s,
        seconds=cpu_s / (workers if stage in _PARALLEL else 1),
        bytes=left * cost.bytes,
    )


def _items_and_cost(
    stage: str, settings: PipelineSettings, panoramas: int | None
) -> tuple[int | None, StageCost]:
    """How many items a stage has, and what one costs."""
    if stage in MODEL_STAGES:
        return _MODELS[stage](settings)
    if stage in ("expand", "probes"):
        return panoramas, at_width(COSTS[stage], settings.expand.width_px)
    width = max(ask.width_px for ask in settings.asks())
    if stage != "fetch":
        width = min(width, settings.stitch.width_px or _WIDEST_PX)
    return panoramas, at_width(COSTS[stage], width)


def _references(settings: PipelineSettings) -> tuple[int, StageCost]:
    own = references_folder(settings.references) is None
    return settings.references.rendered if own else 0, COSTS["references"]


def _dataset(settings: PipelineSettings) -> tuple[int, StageCost]:
    asked = settings.dataset or DatasetStage()
    one = at_width(SAMPLE_COSTS[asked.settings.renderer], asked.settings.rig.width_px)
    cpu_s, size = one.cpu_s * asked.count, one.bytes * asked.count
    return len(asked.arms), StageCost(unit="dataset", cpu_s=cpu_s, bytes=size)


def _train(settings: PipelineSettings) -> tuple[int, StageCost]:
    asked, recipe = settings.dataset or DatasetStage(), settings.train
    if recipe is None:
        return 0, StageCost(unit="model")
    share = 1 - asked.settings.validation_share - asked.settings.test_share
    seen = recipe.schedule.epochs * asked.count * share
    network = recipe.network
    size = (network.input_px / TRAIN_INPUT_PX) ** 2 * (network.width / TRAIN_WIDTH) ** 2
    cpu_s = TRAIN_START_CPU_S + TRAIN_SAMPLE_CPU_S * seen * size
    return len(asked.arms), StageCost(unit="model", cpu_s=cpu_s, bytes=TRAIN_BYTES)


def _evaluate(settings: PipelineSettings) -> tuple[int, StageCost]:
    asked, judged = settings.dataset or DatasetStage(), settings.evaluate or EvaluateStage()
    samples = asked.count * asked.settings.test_share
    samples = min(judged.count, samples) if judged.count else samples
    scores = samples * (len(asked.arms) + (2 if judged.baselines else 0))
    return 1, StageCost(unit="table", cpu_s=SCORE_CPU_S * scores, bytes=SCORE_BYTES * scores)


_MODELS: dict[str, Callable[[PipelineSettings], tuple[int, StageCost]]] = {
    "references": _references,
    "dataset": _dataset,
    "train": _train,
    "evaluate": _evaluate,
}


def _free_bytes(folder: Path) -> int:
    return shutil.disk_usage(nearest_there(folder)).free
