"""The folders of the library: LIB/probes/<id>/{probe.exr, probe.json, preview.jpg}.

A map that is used in place has no probe.exr; its record says where it lies and its digest.

A probe is filled into a folder of another name, which then takes its place by one rename, so
that after a kill or on a full disk a probe is whole or not there. What was left half-way is
swept up later. Only one process at a time may write to a library.
"""

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import OpenEXR

from panokit.color import tonemap
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, RecordError, StorageError
from panokit.io import (
    encode_jpeg,
    read_environment_map,
    read_json,
    sha256_of_file,
    write_bytes,
    write_environment_map,
    write_json,
)
from panokit.io.files import file_entry, storage_error
from panokit.io.pictures import MAP_SCHEMA
from panokit.probes.descriptors import descriptor
from panokit.probes.probe import Probe, Source, probe_id
from panokit.probes.traits import category_of, kind_of, sun_of, tags_of
from panokit.qa import Report
from panokit.sphere import resize_radiance

MAP_NAME, RECORD_NAME, PREVIEW_NAME = "probe.exr", "probe.json", "preview.jpg"
_PREVIEW_WIDTH_PX = 512
_UNFINISHED = ".unfinished-"


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """Something that is wrong with one folder of the library.

    Attributes:
        folder: Its name; for a probe, its id.
        reason: A short stable code ("changed-on-disk", "missing-file").
        message: What is wrong and what to do about it, in one line.
    """

    folder: str
    reason: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """What is said of a map besides its pixels, when it is put on the shelf.

    Attributes:
        name: What to call it.
        report: What QA said.
        category: The kind of scene; "" for what the capture says.
        tags: Words to find it by, besides those of the capture.
        kind: How it came by its range; "" for what the provenance says.
        source: The file, for a map to be used in place; None to store a copy.
    """

    name: str
    report: Report
    category: str = ""
    tags: tuple[str, ...] = ()
    kind: str = ""
    source: Path | None = None


@dataclass(frozen=True, slots=True)
class Shelf:
    """The folder that holds one folder for each probe."""

    root: Path

    def folder(self, id: str) -> Path:
        """Where a probe lies."""
        return self.root / id

    def has(self, id: str) -> bool:
        """Whether a probe is there, whole."""
        return (self.folder(id) / RECORD_NAME).exists()

    def names(self) -> set[str]:
        """What may be probes, by the names of the folders alone."""
        try:
            # Not iterdir: only names are wanted, and there may be ten thousand.
            names = os.listdir(self.root)  # noqa: PTH208
        except OSError as error:
            raise storage_error("read", self.root, error) from error
        return {name for name in names if not name.startswith(".")}

    def ids(self) -> tuple[str, ...]:
        """Every probe, in order; folders without a record are not probes."""
        return tuple(name for name in sorted(self.names()) if self.has(name))

    def put(self, envmap: EnvironmentMap, known: Known) -> Probe:
        """Store a map that is not there yet, or where it lies.

        Raises:
            StorageError: If the disk is full or the folder cannot be written.
        """
        id = probe_id(envmap)
        unfinished = self.root / f"{_UNFINISHED}{id}"
        _remove(unfinished)
        try:
            source = None if known.source is None else self._source(known.source)
            record = _fill(unfinished, envmap, id, known, source)
            if _is_abandoned(self.folder(id)):
                _remove(self.folder(id))
            unfinished.replace(self.folder(id))
        except OSError as error:
            _remove(unfinished)
            if isinstance(error, StorageError):
                raise
            raise storage_error("write", self.folder(id), error) from error
        return Probe.from_record(record)

    def read(self, id: str) -> Probe:
        """What is known of a probe.

        Raises:
            RecordError: If its record is missing or damaged.
        """
        return Probe.from_record(read_json(self.folder(id) / RECORD_NAME))

    def map_file(self, probe: Probe) -> Path:
        """Where a probe's map lies: in its folder, or where it is used in place."""
        if probe.source is None:
            return self.folder(probe.id) / MAP_NAME
        return Path(os.path.normpath(self.root.parent / probe.source.path))

    def read_map(self, probe: Probe) -> EnvironmentMap:
        """A probe's map, with what its record says of it.

        Raises:
            RecordError: If the file is not what it was when it was added.
            StorageError: If it is not there.
        """
        path = self.map_file(probe)
        entry = asdict(probe.source) if probe.source else probe.files[MAP_NAME]
        problem = _problem_of_file(probe.id, path, entry["sha256"], probe)
        if problem is not None:
            if problem.reason == "missing-file":
                raise StorageError(problem.message)
            raise RecordError(problem.message, reason=problem.reason)
        return _read(path, probe)

    def sweep(self) -> tuple[str, ...]:
        """Remove what a kill or a full disk left half-way; the names of what was removed.

        A folder that holds files of another kind is left alone: somebody put them there. So is
        one that may not be removed; `problems` tells of both.
        """
        swept = []
        for folder in self._folders():
            with suppress(OSError):
                if folder.name.startswith(_UNFINISHED) or _is_abandoned(folder):
                    _remove(folder)
                    swept.append(folder.name)
        return tuple(swept)

    def problems(self) -> Iterator[tuple[Problem, ...]]:
        """What is wrong with the probes, one folder after the other; () where all is well.

        Hashes every file, reads every map through the OpenEXR package and computes its id.
        """
        for folder in self._folders():
            try:
                yield tuple(self._problems_of(folder))
            except (ItemError, StorageError) as error:
                reason = error.reason if isinstance(error, ItemError) else "unreadable"
                yield (Problem(folder=folder.name, reason=reason, message=str(error)),)

    def _problems_of(self, folder: Path) -> Iterator[Problem]:
        probe = Probe.from_record(read_json(folder / RECORD_NAME))
        files: dict[Path, Mapping[str, Any]] = {folder / n: e for n, e in probe.files.items()}
        if probe.source is not None:
            files[self.map_file(probe)] = asdict(probe.source)
        for path, entry in files.items():
            problem = _problem_of_file(folder.name, path, entry["sha256"], probe)
            if problem:
                yield problem
                return
        path = folder / MAP_NAME if probe.source is None else self.map_file(probe)
        found = probe_id(_read(path, probe))
        if found != folder.name or probe.id != folder.name:
            message = (
                f"{folder} holds the probe {found}, and its record says {probe.id}. "
                "Move it out of the library and add it again."
            )
            yield Problem(folder=folder.name, reason="wrong-id", message=message)
        if probe.source is None:
            yield from _problems_of_header(folder)

    def _source(self, path: Path) -> Source:
        """Where a map lies: from the library if both are in one folder, so that it can move."""
        home, path = self.root.parent.absolute(), path.absolute()
        near = path.is_relative_to(home.parent) and home.parent != Path(home.anchor)
        told = Path(os.path.relpath(path, home)) if near else path
        return Source(path=told.as_posix(), **file_entry(path))

    def _folders(self) -> list[Path]:
        try:
            return sorted(path for path in self.root.iterdir() if path.is_dir())
        except OSError as error:
            raise storage_error("read", self.root, error) from error


def _fill(
    folder: Path, envmap: EnvironmentMap, id: str, known: Known, source: Source | None
) -> dict[str, Any]:
    """Write all files of a probe into a new folder; its record."""
    if source is None:
        # The record of the map becomes that of the probe, so that any reader of maps finds the
        # frame, the license and the provenance beside the file.
        write_environment_map(envmap, folder / MAP_NAME)
        record = read_json(folder / RECORD_NAME)
    else:
        record = {
            "schema": MAP_SCHEMA,
            "key": "",
            "capture": envmap.capture and envmap.capture.to_json(),
            "frame": str(envmap.frame),
            "anchor": str(envmap.anchor),
            "provenance": envmap.provenance.to_json(),
            "files": {},
            "source": asdict(source),
        }
    write_bytes(folder / PREVIEW_NAME, _preview(envmap))
    record["files"][PREVIEW_NAME] = file_entry(folder / PREVIEW_NAME)
    tags = {tag.strip().casefold() for tag in known.tags} | set(tags_of(envmap.capture))
    category = known.category or category_of(envmap.capture)
    sun = None if "night" in category else sun_of(envmap)
    record["probe"] = {
        "id": id,
        "name": known.name,
        "width_px": envmap.width_px,
        "kind": known.kind or kind_of(envmap.capture, envmap.provenance),
        "category": category,
        "tags": sorted(tags - {""}),
        "sun": sun and dict(sun),
        "descriptor": list(descriptor(envmap.radiance)),
        "report": known.report.to_json(),
    }
    write_json(folder / RECORD_NAME, record)
    return dict(record)


def _read(path: Path, probe: Probe) -> EnvironmentMap:
    """A map with what the probe's record says of it, whatever lies beside the file."""
    return read_environment_map(path).with_changes(
        frame=probe.frame,
        anchor=probe.anchor,
        capture=probe.capture,
        provenance=probe.provenance,
    )


def _preview(envmap: EnvironmentMap) -> bytes:
    width = min(_PREVIEW_WIDTH_PX, envmap.width_px)
    return encode_jpeg(tonemap(resize_radiance(envmap.radiance, width)), quality=88)


def _problems_of_header(folder: Path) -> Iterator[Problem]:
    with OpenEXR.File(str(folder / MAP_NAME), header_only=True) as file:
        if file.header().get("envmap") != OpenEXR.ENVMAP_LATLONG:
            message = f"{folder / MAP_NAME} is not marked as a lat-long map. Add the map again."
            yield Problem(folder=folder.name, reason="no-envmap-attribute", message=message)


def _problem_of_file(folder: str, path: Path, sha256: str, probe: Probe) -> Problem | None:
    in_place = probe.source is not None and path.name not in probe.files
    if not path.exists():
        remedy = (
            f"Put it back where it was; or delete the folder probes/{probe.id} and add it anew."
            if in_place
            else "Add the map again, or restore the file from a copy."
        )
        message = f"{path} ({probe.name}) is missing. {remedy}"
        return Problem(folder=folder, reason="missing-file", message=message)
    if sha256_of_file(path) != sha256:
        remedy = (
            f"Restore it from a copy; or delete the folder probes/{probe.id} and add it anew."
            if in_place
            else "Restore it from a copy, or delete it."
        )
        message = f"{path} ({probe.name}) has changed since it was added. {remedy}"
        return Problem(folder=folder, reason="changed-on-disk", message=message)
    return None


def _is_abandoned(folder: Path) -> bool:
    """Whether a folder holds nothing but parts of a probe without its record."""
    return folder.is_dir() and {p.name for p in folder.iterdir()} <= {MAP_NAME, PREVIEW_NAME}


def _remove(folder: Path) -> None:
    try:
        if folder.exists():
            shutil.rmtree(folder)
    except OSError as error:
        raise storage_error("remove", folder, error) from error
