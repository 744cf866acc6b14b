"""The maps that light the samples: probe libraries, run folders and folders of maps."""

import hashlib
import os
from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture, License, local_capture, require_right_to_train
from panokit.dataset.splits import group_by_shared_keys
from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.fetch.geodesy import distance_m
from panokit.io import HDR_SUFFIXES, read_environment_map, sha256_of_file
from panokit.io.probe_manifest import NAME as MANIFEST
from panokit.io.probe_manifest import read_manifest
from panokit.probes import Library
from panokit.probes.selection import read_selection
from panokit.probes.traits import category_of, kind_of
from panokit.provenance import Provenance
from panokit.sphere import resize_radiance

# A sun of 0.53 degrees is one pixel then; wider maps only cost time.
LIGHT_WIDTH_PX = 512
# What a sample stores of its light is as wide.
ALIGNED_WIDTH_PX = 256
# Pictures taken this near to each other show the same houses.
SAME_PLACE_M = 150.0
_KEPT = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Light:
    """A map that may light samples.

    Attributes:
        id: Unique among the lights.
        path: Of the map.
        place: The group of maps of one place; splits go by it.
        kind: "native", "lifted" (expanded from one exposure) or "synthetic".
        category: The kind of scene, "" where it is not known.
        license: Of the map.
        digest: SHA-256 of its file.
    """

    id: str
    path: Path
    place: str
    kind: str
    category: str
    license: License
    digest: str


@dataclass(slots=True)
class Lights:
    """All maps of a dataset.

    Attributes:
        all: By id.
        packed: A folder that keeps the maps at their working size, or None.
    """

    all: dict[str, Light]
    packed: Path | None = None
    _recent: "OrderedDict[str, EnvironmentMap]" = field(default_factory=OrderedDict)

    def load(self, id: str) -> EnvironmentMap:
        """The map with this id at its working size, 256 to 512 pixels wide, its energy kept."""
        if id in self._recent:
            self._recent.move_to_end(id)
            return self._recent[id]
        radiance = self._working_size(self.all[id])
        self._recent[id] = EnvironmentMap(radiance=radiance)
        if len(self._recent) > _KEPT:
            self._recent.popitem(last=False)
        return self._recent[id]

    def _working_size(self, light: Light) -> NDArray[np.float32]:
        kept = self.packed and self.packed / f"{light.digest[:16]}.npy"
        if kept and kept.is_file():
            return np.asarray(np.load(kept), np.float32)
        radiance = read_environment_map(light.path).radiance
        width = int(np.clip(radiance.shape[1], ALIGNED_WIDTH_PX, LIGHT_WIDTH_PX))
        radiance = resize_radiance(radiance, width)
        if kept:
            kept.parent.mkdir(parents=True, exist_ok=True)
            # Several workers may do this at once; each writes the same bytes.
            part = kept.with_name(f"{kept.stem}-{os.getpid()}.part.npy")
            np.save(part, radiance)
            part.replace(kept)
        return radiance


def open_lights(
    folders: Sequence[Path],
    *,
    own_right: str = "",
    selection: Path | None = None,
    packed: Path | None = None,
) -> Lights:
    """The lights in probe libraries and folders.

    Args:
        folders: Probe libraries; run folders, for their probes; or folders of .exr and .hdr maps
            with records beside them or a manifest.csv.
        own_right: As of `panokit.capture.require_right_to_train`.
        selection: A file of `panokit probes select`: only these of the libraries' probes; or
            None for all.
        packed: As of `Lights`.

    Raises:
        UsageError: If there is no map, or a folder is not there.
        LicenseError: If the license of one does not permit training.
    """
    found: dict[str, tuple[Light, Capture]] = {}
    for folder in folders:
        for light, capture in _of_folder(Path(folder)):
            found.setdefault(light.id, (light, capture))
    if selection is not None:
        found = _selected(found, selection)
    if not found:
        raise UsageError(
            f"There is no light in {', '.join(map(str, folders)) or 'no folder'}. "
            "Add maps to a library (panokit probes add LIB MAP...), or give a folder of them."
        )
    require_right_to_train([capture for _, capture in found.values()], own_right)
    near = _places_by_position(found.values())
    groups = group_by_shared_keys(
        {
            light.id: [f"place:{light.place}", f"content:{light.digest}", *near.get(light.id, [])]
            for light, _ in found.values()
        }
    )
    lights = {
        id: replace(light, place=found[groups[id]][0].place)
        for id, (light, _) in sorted(found.items())
    }
    return Lights(all=lights, packed=packed)


def _of_folder(folder: Path) -> Iterable[tuple[Light, Capture]]:
    if not folder.is_dir():
        raise UsageError(f"There is no folder {folder}. Give a probe library or a folder of maps.")
    if (folder / "probes").is_dir():
        read = _of_run if (folder / "run.json").is_file() else _of_library
    else:
        read = _of_manifest if (folder / MANIFEST).is_file() else _of_maps
    return read(folder)


def _of_library(folder: Path) -> Iterable[tuple[Light, Capture]]:
    with Library.open(folder) as library:
        for entry in library.list():
            probe = library.show(entry.id)
            capture = probe.capture or local_capture(probe.name)
            path = library.map_path(entry.id)
            light = _light(probe.id, path, capture, probe.provenance)
            yield replace(light, kind=probe.kind, category=probe.category), capture


def _of_run(folder: Path) -> Iterable[tuple[Light, Capture]]:
    return _of_maps(folder / "probes")


def _of_maps(folder: Path) -> Iterable[tuple[Light, Capture]]:
    for path in sorted(p for p in folder.iterdir() if p.suffix.lower() in HDR_SUFFIXES):
        envmap = read_environment_map(path)
        capture = envmap.capture or local_capture(path.stem)
        yield _light(path.stem, path, capture, envmap.provenance), capture


def _of_manifest(folder: Path) -> Iterable[tuple[Light, Capture]]:
    for row in read_manifest(folder):
        if row.usable_for != "training":
            continue
        capture = Capture(provider="folder", id=row.name, license=row.license, place=row.group)
        light = Light(
            id=row.name,
            path=row.path,
            place=row.group,
            kind="native",
            category=row.category,
            license=row.license,
            digest=sha256_of_file(row.path),
        )
        yield light, capture


def _light(id: str, path: Path, capture: Capture, provenance: Provenance) -> Light:
    """A light with records; where no position is known, its place is the area it is filed under."""
    placed = capture.latitude_deg is not None and capture.longitude_deg is not None
    return Light(
        id=id,
        path=path,
        place=capture.key if placed else capture.place or capture.key,
        kind=kind_of(capture, provenance),
        category=category_of(capture),
        license=capture.license,
        digest=sha256_of_file(path),
    )


def _selected(
    found: Mapping[str, tuple[Light, Capture]], selection: Path
) -> dict[str, tuple[Light, Capture]]:
    """What of the lights a selection names.

    Raises:
        UsageError: If it names one that is not there.
    """
    ids = read_selection(selection).ids
    missing = [id for id in ids if id not in found]
    if missing:
        raise UsageError(
            f"{selection} names {missing[0]} and {len(missing) - 1} more that are not in these "
            "folders. Give the library that it was made from, or select again."
        )
    return {id: found[id] for id in ids}


def _places_by_position(found: Iterable[tuple[Light, Capture]]) -> dict[str, list[str]]:
    """For each light with a position, a key that it shares with each light nearby."""
    placed = sorted(
        (capture.latitude_deg, capture.longitude_deg or 0.0, light.id)
        for light, capture in found
        if capture.latitude_deg is not None and capture.longitude_deg is not None
    )
    keys: dict[str, list[str]] = {id: [] for _, _, id in placed}
    for position, (latitude, longitude, id) in enumerate(placed):
        for other_latitude, other_longitude, other in placed[position + 1 :]:
            # They are sorted by latitude: what comes later is at least so far north.
            if distance_m((latitude, longitude), (other_latitude, longitude)) > SAME_PLACE_M:
                break
            if distance_m((latitude, longitude), (other_latitude, other_longitude)) <= SAME_PLACE_M:
                keys[id].append(f"near:{id}:{other}")
                keys[other].append(f"near:{id}:{other}")
    return keys


def digest_of_file_list(lights: Lights) -> str:
    """SHA-256 over the ids and contents of all lights, for the dataset's key."""
    digest = hashlib.sha256()
    for light in lights.all.values():
        digest.update(f"{light.id} {light.digest} {light.place}\n".encode())
    return digest.hexdigest()
