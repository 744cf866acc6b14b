"""Maps of true range for a run that goes on to models: a folder's, or synthetic ones."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from panokit.console import Console
from panokit.errors import RecordError, UsageError
from panokit.io.files import read_json, sha256_of_file, write_json
from panokit.io.pictures import HDR_SUFFIXES
from panokit.pipeline.batch import BatchResult
from panokit.pipeline.once import do_once, folder_of
from panokit.pipeline.settings import PipelineSettings, ReferenceSettings
from panokit.provenance import digest_of
from panokit.records import Receipt, RunFolder, stage_key
from panokit.synthetic.settings import VERSION, CitySettings

DATA_VARIABLE = "PANOKIT_DATA"
_DIGESTS = "reference-digests.json"


def references_folder(settings: ReferenceSettings) -> Path | None:
    """The folder of maps that a pipeline names or this machine has; None for synthetic ones."""
    if settings.folder is not None:
        return settings.folder
    data = os.environ.get(DATA_VARIABLE)
    return Path(data) / "probes" if data else None


def gather_references(settings: PipelineSettings, run: RunFolder, console: Console) -> BatchResult:
    """Make the maps of true range, or find out that they are there.

    Raises:
        UsageError: If the folder has none.
        MissingExtraError: If they are to be synthetic and Mitsuba is not installed.
    """
    asked = settings.references
    folder = references_folder(asked)
    receipt = _found(folder, run) if folder is not None else _synthetic(asked, run, console)
    return BatchResult(stage="references", receipts=(receipt,))


def _synthetic(asked: ReferenceSettings, run: RunFolder, console: Console) -> Receipt:
    key = stage_key("references", VERSION, asked.digest, [])
    folder = folder_of(run.references, "synthetic", key)
    city = CitySettings(seed=asked.seed, truth_width_px=asked.width_px, truth_samples=asked.samples)

    def work() -> Mapping[str, Any]:
        from panokit.synthetic import reference_maps  # Mitsuba

        with console.stage("references", asked.rendered + asked.skies, unit="maps") as tick:
            files = reference_maps(
                city, asked.rendered, asked.skies, folder, on_done=lambda _: tick()
            )
        return {"kind": "synthetic", "maps": len(files)}

    return do_once("references", "synthetic", folder, key, work)


def _found(folder: Path, run: RunFolder) -> Receipt:
    """Of a folder that is there: a key from what its files are."""
    if not folder.is_dir():
        raise UsageError(
            f"There is no folder {folder} of reference maps. Check references.folder, or "
            f"{DATA_VARIABLE}."
        )
    maps = sorted(p for p in folder.iterdir() if p.suffix.lower() in HDR_SUFFIXES)
    if not maps:
        raise UsageError(f"There are no .exr or .hdr maps in {folder}. Check references.folder.")
    digests = _digests([*maps, *sorted(folder.glob("*.csv"))], run.root / _DIGESTS)
    key = stage_key("references", VERSION, digest_of(digests), [])
    values = {"kind": "folder", "maps": len(maps)}
    return Receipt(
        item=folder.name, stage="references", path=folder, key=key, fresh=False, values=values
    )


def _digests(files: list[Path], kept: Path) -> dict[str, str]:
    """Name -> SHA-256; of files whose size and time are as before it is not computed again."""
    try:
        known = dict(read_json(kept))
    except (RecordError, TypeError, ValueError):
        known = {}
    told = {}
    for file in files:
        state = file.stat()
        was = known.get(str(file), {})
        same = was.get("bytes") == state.st_size and was.get("mtime_ns") == state.st_mtime_ns
        told[str(file)] = {
            "bytes": state.st_size,
            "mtime_ns": state.st_mtime_ns,
            "sha256": was["sha256"] if same else sha256_of_file(file),
        }
    if told != known:
        write_json(kept, told)
    return {Path(name).name: str(entry["sha256"]) for name, entry in told.items()}
