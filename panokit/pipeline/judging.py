"""The end of a run: QA with its report, and the library of those maps that pass."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from panokit.console import Console
from panokit.errors import RecordError, Rejection
from panokit.io.captures import read_capture
from panokit.io.files import file_entry, read_json, sha256_of_file, write_json
from panokit.io.pictures import record_path
from panokit.pipeline.batch import BatchResult
from panokit.pipeline.settings import PipelineSettings
from panokit.probes import Library
from panokit.qa.settings import VERSION
from panokit.records import Receipt, RunFolder, is_complete, stage_key

if TYPE_CHECKING:
    from panokit.qa import JudgedMap, QaItem, QaResult

_SCHEMA = "panokit.report/1"
_KEPT = "kept.json"


def judge_run(
    settings: PipelineSettings, run: RunFolder, console: Console, earlier: Sequence[BatchResult]
) -> BatchResult:
    """Judge the maps of a run and write its report, unless that is done."""
    maps = earlier[-1].receipts
    report = run.qa / "report.html"
    rejections = tuple(r for batch in earlier for r in batch.rejections)
    key = _report_key(settings, maps, rejections)
    if is_complete(report, key):
        verdicts = read_json(record_path(report))["verdicts"]
        return _outcome(run, key, maps, verdicts, fresh=False)
    if not maps:
        return BatchResult(stage="qa")
    from panokit.qa import qa, write_report  # here: a run that is finished needs none of it

    items = [_item(run, receipt) for receipt in maps]
    result = qa(items, settings.qa, reference=settings.reference, out=run.qa, stage=console.stage)
    write_report(result, run.qa, title=settings.name, rejections=rejections)
    verdicts = _verdicts(result)
    write_json(
        record_path(report),
        {
            "schema": _SCHEMA,
            "key": key,
            "verdicts": verdicts,
            "files": {p.name: file_entry(p) for p in (report, run.qa / "qa.json")},
        },
    )
    return _outcome(run, key, maps, verdicts, fresh=True)


def keep_run(
    settings: PipelineSettings, run: RunFolder, console: Console, earlier: Sequence[BatchResult]
) -> BatchResult:
    """Put the maps that passed into the library; those that are in it stay as they are."""
    maps = {receipt.item: receipt for receipt in earlier[-2].receipts}
    passed = [maps[receipt.item] for receipt in earlier[-1].receipts]
    if not passed:
        return BatchResult(stage="probes")
    kept = _kept(run)
    receipts = []
    with Library.create(run.root / settings.library) as library:
        there = {entry.id for entry in library.list()}
        known = {item: one["probe"] for item, one in kept.items() if one["probe"] in there}
        fresh = {
            receipt.item
            for receipt in passed
            if receipt.item not in known or kept[receipt.item]["key"] != receipt.key
        }
        with console.stage("probes", len(fresh)) as tick:
            for receipt in passed:
                if receipt.item in fresh:
                    added = library.add(receipt.path, name=receipt.item)
                    kept[receipt.item] = {"key": receipt.key, "probe": added.probe.id}
                    tick()
                probe = kept[receipt.item]["probe"]
                receipts.append(
                    Receipt(
                        item=receipt.item,
                        stage="probes",
                        path=library.map_path(probe),
                        key=probe,
                        fresh=receipt.item in fresh,
                    )
                )
    write_json(run.root / _KEPT, kept)
    return BatchResult(stage="probes", receipts=tuple(receipts))


def _item(run: RunFolder, receipt: Receipt) -> "QaItem":
    from panokit.qa import QaItem

    name = receipt.item
    stitched, filled = run.panoramas / f"{name}.jpg", run.filled / f"{name}.jpg"
    return QaItem(
        name=name,
        map_path=receipt.path,
        panorama_path=stitched if stitched.exists() else None,
        filled_path=filled if filled.exists() else None,
        capture=read_capture(run.captures / name).capture,
    )


def _report_key(
    settings: PipelineSettings, maps: Sequence[Receipt], rejections: Sequence[Rejection]
) -> str:
    inputs = [f"{receipt.item}:{receipt.key}" for receipt in maps]
    inputs += [f"{rejection.item}:{rejection.reason}" for rejection in rejections]
    if settings.reference is not None:
        inputs += [sha256_of_file(file) for file in _reference_files(settings.reference)]
    return stage_key("qa", VERSION, settings.qa.digest, [settings.name, *inputs])


def _reference_files(folder: Path) -> list[Path]:
    return sorted(p for p in folder.glob("*") if p.suffix.lower() in (".exr", ".hdr"))


def _verdicts(result: "QaResult") -> dict[str, dict[str, Any]]:
    return {judged.item.name: _verdict(judged) for judged in result.maps}


def _verdict(judged: "JudgedMap") -> dict[str, Any]:
    from panokit.qa import Verdict

    if judged.rejection is not None:
        return {"passed": False, "reason": judged.rejection.reason,
                "message": judged.rejection.message}  # fmt: skip
    if judged.verdict is Verdict.PASS or judged.report is None:
        return {"passed": True}
    failed = ", ".join(check.name for check in judged.report.failed)
    return {"passed": False, "reason": "qa-failed", "message": f"It fails: {failed}."}


def _outcome(
    run: RunFolder,
    key: str,
    maps: Sequence[Receipt],
    verdicts: dict[str, dict[str, Any]],
    *,
    fresh: bool,
) -> BatchResult:
    receipts, rejections = [], []
    for receipt in maps:
        verdict = verdicts[receipt.item]
        if verdict["passed"]:
            receipts.append(
                Receipt(
                    item=receipt.item,
                    stage="qa",
                    path=run.qa / "report.html",
                    key=key,
                    fresh=fresh,
                )
            )
        else:
            rejections.append(
                Rejection(
                    item=receipt.item,
                    stage="qa",
                    reason=verdict["reason"],
                    message=verdict["message"],
                )
            )
    return BatchResult(stage="qa", receipts=tuple(receipts), rejections=tuple(rejections))


def _kept(run: RunFolder) -> dict[str, dict[str, str]]:
    try:
        kept = read_json(run.root / _KEPT)
    except RecordError:
        return {}
    return kept if isinstance(kept, dict) else {}
