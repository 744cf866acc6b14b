"""The folders of the library: LIB/probes/<id>/{probe.exr, probe.json, preview.jpg}.

A probe is filled into a folder of another name, which then takes its place by one rename, so
that after a kill or on a full disk a probe is whole or not there. What was left half-way is
swept up later. Only one process at a time may write to a library.
"""

import shutil
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import OpenEXR

from panokit.color import tonemap
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, StorageError
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
from panokit.probes.probe import Probe, probe_id
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

    def ids(self) -> tuple[str, ...]:
        """Every probe, in order; folders without a record are not probes."""
        try:
            names = sorted(path.name for path in self.root.iterdir())
        except OSError as error:
            raise storage_error("read", self.root, error) from error
        return tuple(n for n in names if not n.startswith(".") and self.has(n))

    def put(self, envmap: EnvironmentMap, name: str, report: Report) -> Probe:
        """Store a map that is not there yet.

        Raises:
            StorageError: If the disk is full or the folder cannot be written.
        """
        id = probe_id(envmap)
        unfinished = self.root / f"{_UNFINISHED}{id}"
        _remove(unfinished)
        try:
            record = _fill(unfinished, envmap, id, name, report)
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

    def problems(self) -> Iterator[Problem]:
        """Everything that is wrong with the probes, one folder after the other.

        Hashes every file, reads every map through the OpenEXR package and computes its id.
        """
        for folder in self._folders():
            try:
                yield from _problems_of(folder)
            except (ItemError, StorageError) as error:
                reason = error.reason if isinstance(error, ItemError) else "unreadable"
                yield Problem(folder=folder.name, reason=reason, message=str(error))

    def _folders(self) -> list[Path]:
        try:
            return sorted(path for path in self.root.iterdir() if path.is_dir())
        except OSError as error:
            raise storage_error("read", self.root, error) from error


def _fill(
    folder: Path, envmap: EnvironmentMap, id: str, name: str, report: Report
) -> dict[str, Any]:
    """Write all files of a probe into a new folder; its record."""
    write_environment_map(envmap, folder / MAP_NAME)
    write_bytes(folder / PREVIEW_NAME, _preview(envmap))
    # The record of the map becomes that of the probe, so that any reader of maps finds the
    # frame, the license and the provenance beside the file.
    record = read_json(folder / RECORD_NAME)
    record["files"][PREVIEW_NAME] = file_entry(folder / PREVIEW_NAME)
    record["probe"] = {
        "id": id,
        "name": name,
        "width_px": envmap.width_px,
        "report": report.to_json(),
    }
    write_json(folder / RECORD_NAME, record)
    return dict(record)


def _preview(envmap: EnvironmentMap) -> bytes:
    width = min(_PREVIEW_WIDTH_PX, envmap.width_px)
    return encode_jpeg(tonemap(resize_radiance(envmap.radiance, width)), quality=88)


def _problems_of(folder: Path) -> Iterator[Problem]:
    probe = Probe.from_record(read_json(folder / RECORD_NAME))
    for name, entry in probe.files.items():
        problem = _problem_of_file(folder, name, entry["sha256"])
        if problem:
            yield problem
            return
    found = probe_id(read_environment_map(folder / MAP_NAME))
    if found != folder.name or probe.id != folder.name:
        message = (
            f"{folder} holds the probe {found}, and its record says {probe.id}. "
            "Move it out of the library and add it again."
        )
        yield Problem(folder=folder.name, reason="wrong-id", message=message)
    with OpenEXR.File(str(folder / MAP_NAME), header_only=True) as file:
        if file.header().get("envmap") != OpenEXR.ENVMAP_LATLONG:
            message = f"{folder / MAP_NAME} is not marked as a lat-long map. Add the map again."
            yield Problem(folder=folder.name, reason="no-envmap-attribute", message=message)


def _problem_of_file(folder: Path, name: str, sha256: str) -> Problem | None:
    path = folder / name
    if not path.exists():
        message = f"{path} is missing. Add the map again, or restore the file from a copy."
        return Problem(folder=folder.name, reason="missing-file", message=message)
    if sha256_of_file(path) != sha256:
        message = f"{path} has changed since it was added. Restore it from a copy, or delete it."
        return Problem(folder=folder.name, reason="changed-on-disk", message=message)
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
