"""Probes for other tools: files that say the same light in their conventions.

Whatever the target, the folder gets a sheet of credits and a list of what was written.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from panokit.capture import Capture
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, RecordError, Rejection, UsageError
from panokit.io import read_json, write_bytes, write_environment_map, write_exr, write_json
from panokit.io.adapters import (
    AnalyticSun,
    blender_world_script,
    gltf_environment,
    harmonics_json,
    mitsuba_scene,
    sun_from_record,
    take_out_sun,
    to_mitsuba,
    usd_dome_light,
)
from panokit.io.adapters.mitsuba_scene import MITSUBA_NOTE
from panokit.io.attribution import write_attribution
from panokit.probes.library import Library
from panokit.probes.parquet import write_index_table
from panokit.probes.probe import Probe
from panokit.probes.settings import VERSION, ExportSettings
from panokit.provenance import Step
from panokit.sphere import resize

SCHEMA = "panokit.export/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Exported:
    """One probe in another tool's form.

    Attributes:
        probe: What it is.
        files: Names in the folder; the first is the one to open.
        sun: The sun as a light of its own, where it was taken out of the map.
    """

    probe: Probe
    files: tuple[str, ...]
    sun: AnalyticSun | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportResult:
    """What an export made.

    Attributes:
        exported: The probes, in order.
        rejections: Those whose map could not be used.
        table: The Parquet file, where that was asked for.
    """

    exported: tuple[Exported, ...] = ()
    rejections: tuple[Rejection, ...] = ()
    table: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Job:
    """One map on its way out."""

    envmap: EnvironmentMap
    sun: AnalyticSun | None
    name: str
    out: Path
    settings: ExportSettings


def export_probes(
    library: Library,
    ids: Sequence[str],
    out: Path,
    settings: ExportSettings,
    *,
    on_done: Callable[[Exported | Rejection], None] | None = None,
) -> ExportResult:
    """Write probes for another tool into a folder, with their credits.

    Args:
        library: Where they are.
        ids: Which; see `Library.find_id`.
        out: The folder; it is made if need be.
        settings: For which tool, and how.
        on_done: Called with each probe that was written or rejected.

    Raises:
        UsageError: If there is nothing to export, or no probe of an id.
        StorageError: If the folder cannot be written.
    """
    if not ids:
        raise UsageError("There is no probe to export. Name some with --id, or a --selection.")
    whole = list(dict.fromkeys(library.find_id(id) for id in ids))
    exported: list[Exported] = []
    rejections: list[Rejection] = []
    names = _names(library, whole)
    for id in whole:
        outcome = _export_one(library, id, names[id], out, settings)
        if isinstance(outcome, Exported):
            exported.append(outcome)
        else:
            rejections.append(outcome)
        if on_done is not None:
            on_done(outcome)
    table = None
    if settings.to == "parquet":
        table = out / "probes.parquet"
        write_index_table(library, [one.probe.id for one in exported], table)
    if exported:
        _sign(out, exported, settings)
    return ExportResult(exported=tuple(exported), rejections=tuple(rejections), table=table)


def _export_one(
    library: Library, id: str, name: str, out: Path, settings: ExportSettings
) -> Exported | Rejection:
    try:
        probe = library.show(id)
        if settings.to == "parquet":
            return Exported(probe=probe, files=("probes.parquet",))
        envmap, sun = _prepared(library.read(id), probe, settings)
        job = _Job(envmap=envmap, sun=sun, name=name, out=out, settings=settings)
        return Exported(probe=probe, files=_WRITERS[settings.to](job), sun=sun)
    except ItemError as error:
        return Rejection.from_error(id, "export", error)


def _prepared(
    envmap: EnvironmentMap, probe: Probe, settings: ExportSettings
) -> tuple[EnvironmentMap, AnalyticSun | None]:
    """The map as it is to be written, and its sun if that is to be apart."""
    values: dict[str, object] = {}
    sun = None
    if settings.sun == "apart" and probe.sun is not None:
        taken = take_out_sun(np.asarray(envmap.radiance), sun_from_record(probe.sun))
        if taken is not None:
            rest, sun = taken
            envmap = envmap.with_changes(radiance=rest)
            values["sun"] = sun.to_json()
    if settings.width_px is not None and settings.width_px < envmap.width_px:
        envmap = resize(envmap, settings.width_px)
        values["width_px"] = settings.width_px
    if values:
        step = Step(stage="export", version=VERSION, settings_digest=settings.digest, values=values)
        envmap = envmap.with_changes(provenance=envmap.provenance.then(step))
    return envmap, sun


def _write_exr(job: _Job) -> tuple[str, ...]:
    write_environment_map(job.envmap, job.out / f"{job.name}.exr", half=job.settings.half)
    return f"{job.name}.exr", f"{job.name}.json"


def _write_hdr(job: _Job) -> tuple[str, ...]:
    write_environment_map(job.envmap, job.out / f"{job.name}.hdr")
    return f"{job.name}.hdr", f"{job.name}.json"


def _write_blender(job: _Job) -> tuple[str, ...]:
    files = _write_exr(replace(job, settings=job.settings.model_copy(update={"half": False})))
    script = f"{job.name}.blender.py"
    text = blender_world_script(files[0], name=job.name, script=script, sun=job.sun)
    write_bytes(job.out / script, text.encode())
    return script, *files


def _write_usd(job: _Job) -> tuple[str, ...]:
    files = _write_exr(replace(job, settings=job.settings.model_copy(update={"half": False})))
    stage = f"{job.name}.usda"
    write_bytes(job.out / stage, usd_dome_light(f"./{files[0]}", sun=job.sun).encode())
    return stage, *files


def _write_mitsuba(job: _Job) -> tuple[str, ...]:
    texture, scene = f"{job.name}.mitsuba.exr", f"{job.name}.mitsuba.xml"
    write_exr(
        job.out / texture,
        to_mitsuba(job.envmap),
        {"comments": MITSUBA_NOTE, "panokit:projection": "mitsuba"},
    )
    write_bytes(job.out / scene, mitsuba_scene(texture, sun=job.sun).encode())
    return scene, texture


def _write_gltf(job: _Job) -> tuple[str, ...]:
    data = gltf_environment(job.envmap, name=job.name, face_px=job.settings.face_px, sun=job.sun)
    write_bytes(job.out / f"{job.name}.glb", data)
    return (f"{job.name}.glb",)


def _write_harmonics(job: _Job) -> tuple[str, ...]:
    value = harmonics_json(job.envmap, order=job.settings.harmonics_order, sun=job.sun)
    write_json(job.out / f"{job.name}.harmonics.json", value)
    return (f"{job.name}.harmonics.json",)


_WRITERS: dict[str, Callable[[_Job], tuple[str, ...]]] = {
    "exr": _write_exr,
    "hdr": _write_hdr,
    "blender": _write_blender,
    "usd": _write_usd,
    "mitsuba": _write_mitsuba,
    "gltf": _write_gltf,
    "harmonics": _write_harmonics,
}


def export_map(
    envmap: EnvironmentMap,
    name: str,
    out: Path,
    settings: ExportSettings,
    *,
    sun: AnalyticSun | None = None,
) -> tuple[str, ...]:
    """Write one map that is in no library for another tool, without credits or a list.

    Args:
        envmap: The map; without its sun, if that is given.
        name: Of the files, without an ending.
        out: The folder.
        settings: For which tool; "parquet" is for libraries only.
        sun: A light of its own beside the map.

    Returns:
        Names in the folder; the first is the one to open.

    Raises:
        UsageError: If the tool takes no single map.
        StorageError: If the folder cannot be written.
    """
    if settings.to not in _WRITERS:
        raise UsageError(f"{settings.to!r} is a table of a library, not a form of one map.")
    return _WRITERS[settings.to](
        _Job(envmap=envmap, sun=sun, name=name, out=out, settings=settings)
    )


def _names(library: Library, ids: Sequence[str]) -> dict[str, str]:
    """Id -> a name for files: the probe's where it is free, else with digits of the id."""
    names: dict[str, str] = {}
    taken: set[str] = set()
    for entry in library.entries(ids):
        safe = re.sub(r"[^A-Za-z0-9._-]+", "_", entry.name).strip("._")[:100] or "probe"
        if safe.casefold() in taken:
            safe = f"{safe}-{entry.id[:8]}"
        taken.add(safe.casefold())
        names[entry.id] = safe
    return names


def _credited(probe: Probe) -> Capture:
    """What the sheet of credits says of a probe, also of one from nobody knows where."""
    return probe.capture or Capture(provider="library", id=probe.name, license=probe.license)


def _sign(out: Path, exported: Sequence[Exported], settings: ExportSettings) -> None:
    """Write the list of what an export made, and the credits of all that is in the folder."""
    made = [_line(one) for one in exported]
    path = out / f"export-{settings.to}.json"
    again = {line["id"] for line in made}
    earlier = [line for line in _listed(path) if line["id"] not in again]
    value = {
        "schema": SCHEMA,
        "settings": settings.model_dump(mode="json"),
        "probes": sorted([*earlier, *made], key=lambda line: (line["name"], line["id"])),
    }
    write_json(path, value)
    lists = (_listed(file) for file in sorted(out.glob("export-*.json")))
    write_attribution(out, [Capture.from_json(line["credit"]) for lines in lists for line in lines])


def _line(one: Exported) -> dict[str, Any]:
    return {
        "id": one.probe.id,
        "name": one.probe.name,
        "files": list(one.files),
        "kind": one.probe.kind,
        "credit": _credited(one.probe).to_json(),
        "sun": one.sun and one.sun.to_json(),
    }


def _listed(path: Path) -> list[dict[str, Any]]:
    """What an earlier export into the same folder wrote down; nothing if it is damaged."""
    if not path.exists():
        return []
    try:
        value = read_json(path)
        lines = value["probes"] if value["schema"] == SCHEMA else []
        return [line for line in lines if Capture.from_json(line["credit"]) and line["id"]]
    except (RecordError, KeyError, TypeError):
        return []
