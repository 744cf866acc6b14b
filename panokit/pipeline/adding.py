"""Maps from runs, folders and files into a probe library, as copies or in place."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from panokit.capture import license_from_spdx, local_capture
from panokit.console import Console
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, Rejection, UsageError
from panokit.io import read_environment_map
from panokit.io.probe_manifest import NAME as MANIFEST
from panokit.io.probe_manifest import ManifestRow, read_manifest
from panokit.pipeline.inputs import map_paths
from panokit.probes import Added, Library
from panokit.probes.settings import AddSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class AddResult:
    """What adding did.

    Attributes:
        added: The probes, new or there already.
        rejections: Maps that cannot be used.
    """

    added: tuple[Added, ...] = ()
    rejections: tuple[Rejection, ...] = ()


def add_maps(
    paths: Sequence[Path], folder: Path, settings: AddSettings, console: Console
) -> AddResult:
    """Put maps into a library; one that is there already is left as it is.

    A folder may have a manifest.csv that says what its files are; see
    `panokit.io.probe_manifest`. What a map's own record says goes first, then the manifest, then
    the settings.

    Args:
        paths: A run folder, or maps, or folders of them.
        folder: Of the library; it is made if need be.
        settings: How to add them.
        console: Shows progress.

    Raises:
        UsageError: If there is no map.
        RecordError: If a manifest is damaged.
        StorageError: If the library cannot be written.
    """
    maps = map_paths(paths)
    if not maps:
        told = ", ".join(map(str, paths))
        raise UsageError(f"There are no .exr or .hdr maps in {told}. Check the paths.")
    known = {
        row.path: row
        for parent in sorted({path.parent for path in maps})
        if (parent / MANIFEST).is_file()
        for row in read_manifest(parent)
    }
    added, rejections = [], []
    with Library.create(folder) as library, console.stage("probes", len(maps)) as tick:
        for path in maps:
            try:
                added.append(_add(library, path, known.get(path), settings))
                tick()
            except ItemError as error:
                rejections.append(Rejection.from_error(path.stem, "probes", error))
                console.note(f"probes: {path.stem} rejected: {error}")
                tick(rejected=True)
    return AddResult(added=tuple(added), rejections=tuple(rejections))


def _add(library: Library, path: Path, row: ManifestRow | None, settings: AddSettings) -> Added:
    envmap = read_environment_map(path, repair=settings.repair)
    if envmap.capture is None:
        envmap = _with_capture(envmap, path, row, settings)
    return library.add(
        envmap,
        name=row.name if row else path.stem,
        category=settings.category or (row.category if row else ""),
        tags=(*settings.tags, *(row.tags if row else ())),
        kind=settings.kind or "",
        in_place=path if settings.in_place else None,
    )


def _with_capture(
    envmap: EnvironmentMap, path: Path, row: ManifestRow | None, settings: AddSettings
) -> EnvironmentMap:
    """The map with what is known of where it is from; as it is where nothing is."""
    known: dict[str, object] = {"place": (row.place if row else "") or settings.place}
    if row is not None:
        known |= {
            "source_url": row.source_url,
            "latitude_deg": row.latitude_deg,
            "longitude_deg": row.longitude_deg,
        }
    if row is not None and row.license.id != "unknown":
        known["license"] = row.license
    elif settings.license or settings.attribution:
        known["license"] = license_from_spdx(settings.license or "unknown", settings.attribution)
    known = {name: value for name, value in known.items() if value not in ("", None)}
    if not known:
        return envmap
    return envmap.with_changes(capture=local_capture(path.stem, **known))
