"""One item through one stage: read, call the stage's function, write with its record.

This is the only place that knows both the files of a run and the functions of the stages.
A task is a small picklable value, so any engine can carry it anywhere.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.engine import Outcome, attempt
from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError, UsageError
from panokit.expand.settings import VERSION as EXPAND_VERSION
from panokit.expand.settings import ExpandSettings
from panokit.inpaint.settings import VERSION as INPAINT_VERSION
from panokit.inpaint.settings import InpaintSettings
from panokit.io.captures import RECORD, read_capture
from panokit.io.files import read_bytes, read_json, sha256_of_file, write_bytes
from panokit.io.images import encode_png
from panokit.io.pictures import (
    HDR_SUFFIXES,
    read_environment_map,
    read_mask,
    read_panorama,
    record_path,
    write_environment_map,
    write_panorama,
)
from panokit.panorama import Panorama
from panokit.provenance import digest_of
from panokit.records import Receipt, is_complete, stage_key
from panokit.settings import Settings
from panokit.stitch.settings import VERSION as STITCH_VERSION
from panokit.stitch.settings import StitchSettings
from panokit.weights import released_models


@dataclass(frozen=True, slots=True, kw_only=True)
class StageTask:
    """One item to take through one stage.

    Attributes:
        stage: "stitch", "inpaint" or "expand".
        item: The item's id.
        source: The capture's folder, the file of views, or the picture.
        target: The picture to write.
        settings: The stage's settings.
        mask: A picture of what to fill, for inpaint, or None.
    """

    stage: str
    item: str
    source: Path
    target: Path
    settings: Settings
    mask: Path | None = None

    def inputs(self) -> list[str]:
        """The digests of what the task reads."""
        digests = [_source_digest(self.source)]
        return digests if self.mask is None else [*digests, sha256_of_file(self.mask)]

    def key(self) -> str:
        """The key of the result."""
        version, weights = _VERSIONS[self.stage], ""
        if isinstance(self.settings, ExpandSettings):
            weights = _expansion_digest(self.settings.model)
        elif isinstance(self.settings, InpaintSettings) and self.settings.network is not None:
            weights = sha256_of_file(self.settings.network)
        return stage_key(self.stage, version, self.settings.digest, self.inputs(), weights)


def run_task(task: StageTask) -> Outcome:
    """Take one item through one stage; a bad item becomes a `Rejection`."""
    return attempt(task.item, task.stage, lambda: _run(task))


def _run(task: StageTask) -> Receipt:
    started, cpu_started = time.monotonic(), time.process_time()
    key = task.key()
    # A worker that was lost right after it wrote the record: its item is run again.
    is_done = is_complete(task.target, key)
    values = {} if is_done else _WORK[task.stage](task, key)
    return Receipt(
        item=task.item,
        stage=task.stage,
        path=task.target,
        key=key,
        seconds=time.monotonic() - started,
        cpu_s=time.process_time() - cpu_started,
        values=values,
    )


# The stages' functions are loaded where they are called: a run that is finished needs none.
def _stitch(task: StageTask, key: str) -> Mapping[str, Any]:
    from panokit.stitch import stitch

    settings = _of(StitchSettings, task)
    if task.source.is_file():
        return _stitch_view_set(task, settings, key)
    panorama = stitch(read_capture(task.source), settings)
    provenance = panorama.provenance.with_inputs(task.inputs())
    write_panorama(panorama.with_changes(provenance=provenance), task.target, key=key)
    return provenance.steps[-1].values


def _stitch_view_set(task: StageTask, settings: StitchSettings, key: str) -> Mapping[str, Any]:
    from panokit.stitch import read_view_set, stitch_view_set

    made = stitch_view_set(read_view_set(task.source), settings)
    provenance = made.provenance.with_inputs(task.inputs())
    if isinstance(made, EnvironmentMap):
        write_environment_map(made.with_changes(provenance=provenance), task.target, key=key)
    else:
        write_panorama(made.with_changes(provenance=provenance), task.target, key=key)
    return provenance.steps[-1].values


def _inpaint(task: StageTask, key: str) -> Mapping[str, Any]:
    from panokit.inpaint import inpaint

    settings = _of(InpaintSettings, task)
    if task.source.suffix.lower() in HDR_SUFFIXES:
        envmap = read_environment_map(task.source)
        mask = None if task.mask is None else _fitting_mask(task.mask, envmap.radiance.shape[:2])
        whole = inpaint(envmap, settings, mask)
        provenance = whole.provenance.with_inputs(task.inputs())
        write_environment_map(whole.with_changes(provenance=provenance), task.target, key=key)
        return provenance.steps[-1].values
    panorama = read_panorama(task.source)
    mask = None if task.mask is None else _fitting_mask(task.mask, panorama.pixels.shape[:2])
    filled = inpaint(panorama, settings, mask)
    provenance = filled.provenance.with_inputs(task.inputs())
    # Where nothing was filled nothing is encoded anew: a JPEG gets worse each time.
    unchanged = np.shares_memory(filled.pixels, panorama.pixels)
    same = unchanged and task.source.suffix.lower() in (".jpg", ".jpeg")
    write_panorama(
        filled.with_changes(provenance=provenance),
        task.target,
        key=key,
        encoded=read_bytes(task.source) if same else None,
    )
    return provenance.steps[-1].values


def _expand(task: StageTask, key: str) -> Mapping[str, Any]:
    from panokit.expand import expand

    settings = _of(ExpandSettings, task)
    panorama = read_panorama(task.source)
    envmap = expand(panorama, settings)
    if settings.compare:
        _write_comparison(panorama, settings, envmap, task.target)
    provenance = envmap.provenance.with_inputs(task.inputs())
    write_environment_map(envmap.with_changes(provenance=provenance), task.target, key=key)
    return provenance.steps[-1].values


def _write_comparison(
    panorama: Panorama, settings: ExpandSettings, envmap: EnvironmentMap, target: Path
) -> None:
    """The analytic methods' maps and a picture of all, in NAME.compare; before the record."""
    from panokit.expand.compare import compare_methods, comparison_picture

    maps = compare_methods(panorama, settings, envmap)
    folder = target.with_suffix(".compare")
    for name, other in maps.items():
        if name != settings.model:
            write_environment_map(other, folder / f"{name}.exr")
    write_bytes(folder / "preview.png", encode_png(comparison_picture(maps)))


_WORK: dict[str, Callable[[StageTask, str], Mapping[str, Any]]] = {
    "stitch": _stitch,
    "inpaint": _inpaint,
    "expand": _expand,
}
_VERSIONS = {"stitch": STITCH_VERSION, "inpaint": INPAINT_VERSION, "expand": EXPAND_VERSION}


def _expansion_digest(model: str) -> str:
    """Of a model's weights, "" for an analytic method.

    Raises:
        ModelError: If there is none of this name.
    """
    released = {one.id: one for one in released_models() if one.task == "expansion"}
    if model in released:
        return released[model].digest
    from panokit.expand.stage import weights_digest

    return weights_digest(model)


def _of(kind: type[Any], task: StageTask) -> Any:
    if not isinstance(task.settings, kind):
        raise UsageError(f"{task.stage} takes {kind.__name__}, not {type(task.settings).__name__}.")
    return task.settings


def _source_digest(source: Path) -> str:
    """Of a capture or a picture with a record, what the record says; else of the bytes."""
    if source.is_dir():
        record = read_json(source / RECORD)
        return digest_of([record.get("capture"), record.get("grid"), record.get("files")])
    if source.suffix.lower() == ".json":
        from panokit.stitch import read_view_set

        return digest_of([sha256_of_file(source), read_view_set(source).digests()])
    record_file = record_path(source)
    if record_file.exists():
        record = read_json(record_file)
        if isinstance(record, dict) and source.name in record.get("files", {}):
            return digest_of([record["files"], record.get("provenance")])
    return sha256_of_file(source)


def _fitting_mask(path: Path, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    mask = read_mask(path)
    if mask.shape != shape:
        raise ImageError(
            f"The mask {path} is {mask.shape[1]}x{mask.shape[0]}, the panorama "
            f"{shape[1]}x{shape[0]}. Make them the same size.",
            reason="wrong-mask",
        )
    return mask
