"""The report of a run: what became of everything, how long it took, and how good the models are.

RUN/report.html for people, RUN/timings.json for programs. Durations only: neither knows the clock.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from panokit.console import duration_text, size_text
from panokit.errors import RecordError
from panokit.io.files import read_json, write_json
from panokit.io.pictures import record_path
from panokit.ledger import Ledger
from panokit.pipeline.batch import BatchResult
from panokit.pipeline.judging_models import FEWEST_PLACES
from panokit.pipeline.result import RunResult
from panokit.pipeline.settings import PipelineSettings
from panokit.records import RunFolder
from panokit.report.page import write_page
from panokit.report.values import (
    Badge,
    Cell,
    Column,
    Count,
    Counts,
    Page,
    Section,
    Table,
    Text,
)
from panokit.report.wording import format_figure

SCHEMA = "panokit.timings/1"
_SHOWN_REJECTIONS = 200
_ARMS = ("references", "augmented")
# What of all figures a reader sees first.
_FIGURES = ("relit-diffuse-si-rmse", "relit-glossy-0.3-si-rmse", "si-rmse", "rgb-angular")


def write_run_report(
    settings: PipelineSettings, result: RunResult, seconds: Mapping[str, float]
) -> Path:
    """Write RUN/report.html and RUN/timings.json.

    Args:
        settings: Of the pipeline.
        result: What became of the run.
        seconds: Stage -> how long it took this time.

    Raises:
        StorageError: If the folder cannot be written.
    """
    run = result.run
    timings = _timings(result, seconds)
    write_json(run.root / "timings.json", timings)
    return write_page(_page(settings, result, timings), run.root / "report.html")


def _timings(result: RunResult, seconds: Mapping[str, float]) -> dict[str, Any]:
    """Of each stage: items, time of this start, and processor time of all its items."""
    ledger = Ledger(result.run.ledger)
    counts = ledger.counts()
    return {
        "schema": SCHEMA,
        "stages": {
            batch.stage: {
                "done": len(batch.receipts),
                "fresh": batch.fresh,
                "rejected": dict(sorted(Counter(r.reason for r in batch.rejections).items())),
                "seconds": round(seconds.get(batch.stage, 0.0), 3),
                "item_seconds": round(counts.get(batch.stage, (0, 0.0, 0.0))[1], 3),
                "item_cpu_s": round(counts.get(batch.stage, (0, 0.0, 0.0))[2], 3),
            }
            for batch in result.batches
        },
        "energy": energy_ledger(result),
    }


def energy_ledger(result: RunResult) -> dict[str, float | int]:
    """How much light the maps hold, before and after their range was restored.

    Energy is the integral of radiance over the sphere, mean of red, green and blue, in units of
    the level of LDR white; `kept` is by how much a file's own energy may differ from what the
    stage wrote down, as QA measured it.
    """
    expanded = next((b for b in result.batches if b.stage == "expand"), None)
    before, after = [], []
    for receipt in expanded.receipts if expanded else ():
        values = _expand_values(receipt.path)
        if values:
            before.append(_mean(values["energy_before"]))
            after.append(_mean(values["energy_after"]))
    if not before:
        return {}
    deviations = list(_deviations(result.run))
    return {
        "maps": len(before),
        "median_before": round(median(before), 5),
        "median_after": round(median(after), 5),
        "median_gain": round(
            median(a / max(b, 1e-9) for a, b in zip(after, before, strict=True)), 5
        ),
        **({"largest_deviation": round(max(deviations), 7)} if deviations else {}),
    }


def _expand_values(path: Path) -> Mapping[str, Any] | None:
    try:
        steps = read_json(record_path(path))["provenance"]
    except (RecordError, KeyError, TypeError):
        return None
    own = (step for step in reversed(steps) if step.get("stage") == "expand")
    values: Mapping[str, Any] = next((step["values"] for step in own), {})
    return values if "energy_before" in values and "energy_after" in values else None


def _deviations(run: RunFolder) -> Iterator[float]:
    try:
        maps = read_json(run.qa / "qa.json")["maps"]
    except (RecordError, KeyError, TypeError):
        return
    for one in maps:
        for check in (one.get("report") or {}).get("checks", ()):
            if check.get("name") == "energy-ledger" and check.get("value") is not None:
                yield abs(float(check["value"]))


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _page(settings: PipelineSettings, result: RunResult, timings: Mapping[str, Any]) -> Page:
    stages = timings["stages"]
    sections: list[Section | None] = [
        _stage_table(stages),
        _rejection_table(result),
        _energy_section(timings["energy"]),
        *_model_sections(result),
    ]
    probes = stages.get("probes", {}).get("done")
    counts = [
        Count(label="fetched", value=str(stages["fetch"]["done"])),
        *([] if probes is None else [Count(label="light probes", value=str(probes))]),
        Count(label="rejected", value=str(len({r.item for r in result.rejections}))),
        Count(label="library and models", value=size_text(_bytes(settings, result.run))),
    ]
    qa = result.run.qa / "report.html"
    links = f"The maps themselves, check by check: {qa.relative_to(result.run.root)}." if (
        qa.exists()
    ) else "No map has come as far as QA."  # fmt: skip
    return Page(
        title=settings.name,
        head=(Counts(counts=tuple(counts)), Text(paragraphs=(links,), small=True)),
        sections=tuple(section for section in sections if section is not None),
        footer=(
            "Time is that of the last start of the pipeline, processor time that of all items as "
            "far as the ledger knows it, waiting for the network not counted.",
        ),
    )


def _stage_table(stages: Mapping[str, Any]) -> Table:
    rows = []
    for name, one in stages.items():
        rate = one["fresh"] / one["seconds"] * 3600 if one["fresh"] and one["seconds"] else None
        rows.append(
            (
                Cell(text=name),
                Cell(text=str(one["done"]), sort=one["done"]),
                Cell(text=str(sum(one["rejected"].values())), sort=sum(one["rejected"].values())),
                Cell(text=str(one["fresh"]), sort=one["fresh"]),
                Cell(text=duration_text(one["seconds"]), sort=one["seconds"]),
                Cell(text=duration_text(one["item_cpu_s"]), sort=one["item_cpu_s"]),
                Cell(text=f"{rate:,.0f}" if rate else "–", sort=rate or 0),
            )
        )
    labels = ("done", "rejected", "made now", "time", "processor time", "per hour")
    return Table(
        title="Stages",
        columns=(Column(label="Stage"), *(Column(label=text, numeric=True) for text in labels)),
        rows=tuple(rows),
    )


def _rejection_table(result: RunResult) -> Table | None:
    rejections = result.rejections
    if not rejections:
        return None
    reasons = Counter((r.stage, r.reason) for r in rejections)
    rows = []
    for (stage, reason), count in sorted(reasons.items(), key=lambda pair: -pair[1]):
        own = [r for r in rejections if (r.stage, r.reason) == (stage, reason)]
        rows.append(
            (
                Cell(text=reason),
                Cell(text=stage),
                Cell(text=str(count), sort=count),
                Cell(text=own[0].message, note=", ".join(r.item for r in own[:_SHOWN_REJECTIONS])),
            )
        )
    columns = (
        Column(label="Reason"), Column(label="Stage"), Column(label="Items", numeric=True),
        Column(label="What was said, and of which"),
    )  # fmt: skip
    return Table(title="Rejected", columns=columns, rows=tuple(rows), sortable=len(rows) > 1)


def _energy_section(energy: Mapping[str, float]) -> Counts | None:
    if not energy:
        return None
    counts = [
        Count(
            label="energy before expansion, median", value=format_figure(energy["median_before"])
        ),
        Count(label="after", value=format_figure(energy["median_after"])),
        Count(label="gain, median", value=f"{format_figure(energy['median_gain'])}×"),
    ]
    if "largest_deviation" in energy:
        counts.append(
            Count(
                label="largest deviation on disk", value=format_figure(energy["largest_deviation"])
            )
        )
    return Counts(title="Energy ledger", counts=tuple(counts))


def _model_sections(result: RunResult) -> list[Section]:
    batches: dict[str, BatchResult] = {batch.stage: batch for batch in result.batches}
    sections: list[Section] = []
    if "dataset" in batches:
        sections.append(_dataset_table(batches["dataset"], result.run))
    if "evaluate" in batches and batches["evaluate"].receipts:
        values = batches["evaluate"].receipts[0].values
        sections += [_score_table(values), *_comparisons(values)]
    return sections


def _dataset_table(batch: BatchResult, run: RunFolder) -> Table:
    rows = [
        (
            Cell(text=receipt.item, note=str(receipt.path.relative_to(run.root))),
            Cell(text=str(receipt.values["samples"])),
            *(Cell(text=str(receipt.values["lights"].get(split, 0)))
              for split in ("train", "validation", "test")),
        )
        for receipt in batch.receipts
    ]  # fmt: skip
    labels = ("samples", "maps to train", "to validate", "to test")
    return Table(
        title="Datasets",
        columns=(Column(label="Arm"), *(Column(label=text, numeric=True) for text in labels)),
        rows=tuple(rows),
    )


def _score_table(values: Mapping[str, Any]) -> Table:
    scores: Mapping[str, Mapping[str, float | None]] = values["scores"]
    first = next(iter(scores.values()))
    figures = [name for name in dict.fromkeys((values["figure"], *_FIGURES)) if name in first]
    rows = [
        (
            Cell(text=predictor),
            *(Cell(text="–" if own[f] is None else format_figure(own[f] or 0.0), sort=own[f])
              for f in figures),
        )
        for predictor, own in sorted(scores.items(), key=lambda pair: pair[0] not in _ARMS)
    ]  # fmt: skip
    return Table(
        title="Models on held-out places",
        columns=(
            Column(label="Predictor"),
            *(Column(label=name, numeric=True) for name in figures),
        ),
        rows=tuple(rows),
        note=f"Means over {values['samples']} samples of {values['places']} places that no arm "
        "learned from; lower is better. models/scores-*/results.jsonl has every score.",
        sortable=True,
    )


def _comparisons(values: Mapping[str, Any]) -> list[Section]:
    words = {"better": "good", "worse": "poor"}
    told: list[Section] = []
    for one in values["comparisons"]:
        told.append(
            Counts(
                title=f"{one['first']} against {one['second']}",
                counts=(
                    Count(
                        label=f"difference of {one['figure']}",
                        value=format_figure(one["mean"]),
                        badge=Badge(text=one["verdict"], tone=words.get(one["verdict"], "note")),  # type: ignore[arg-type]
                    ),
                    Count(label="95 % interval over places",
                          value=f"{format_figure(one['low'])} to {format_figure(one['high'])}"),
                ),
                note="Below zero, the first is better. The interval is over places: with fewer "
                f"than {FEWEST_PLACES}, or where it holds zero, nothing is decided; and it says "
                "nothing of how much another training of the same recipe would differ.",
            )
        )  # fmt: skip
    return told


def _bytes(settings: PipelineSettings, run: RunFolder) -> int:
    """How much lies in the library, which other runs may share, and below `models`."""
    folders = (run.root / settings.library, run.models)
    files = (p for f in folders if f.is_dir() for p in f.rglob("*") if p.is_file())
    return sum(path.lstat().st_size for path in files)
