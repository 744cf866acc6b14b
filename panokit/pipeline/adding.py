"""Maps from runs, folders and files into a probe library, as copies or in place."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from panokit.console import Console
from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, Rejection, UsageError
from panokit.io import read_environment_map
from panokit.pipeline.inputs import map_paths
from panokit.probes import Added, Library
from panokit.probes.manifest import Line, capture_for, read_manifest
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
    `panokit.probes.manifest`. What a map's own record says goes before what the settings say.

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
    manifests = {parent: read_manifest(parent) for parent in {path.parent for path in maps}}
    added, rejections = [], []
    with Library.create(folder) as library, console.stage("probes", len(maps)) as tick:
        for path in maps:
            line = manifests[path.parent].get(path.name)
            try:
                added.append(_add(library, path, line, settings))
                tick()
            except ItemError as error:
                rejections.append(Rejection.from_error(path.stem, "probes", error))
                console.note(f"probes: {path.stem} rejected: {error}")
                tick(rejected=True)
    return AddResult(added=tuple(added), rejections=tuple(rejections))


def _add(library: Library, path: Path, line: Line | None, settings: AddSettings) -> Added:
    envmap = read_environment_map(path, repair=settings.repair)
    if envmap.capture is None:
        envmap = _with_capture(envmap, path, line, settings)
    return library.add(
        envmap,
        name=(line.name if line else "") or path.stem,
        category=settings.category or (line.category if line else ""),
        tags=(*settings.tags, *(line.tags if line else ())),
        kind=settings.kind or "",
        in_place=path if settings.in_place else None,
    )


def _with_capture(
    envmap: EnvironmentMap, path: Path, line: Line | None, settings: AddSettings
) -> EnvironmentMap:
    """The map with what is known of where it is from; as it is where nothing is."""
    known = dict(line.known) if line else {}
    if settings.place:
        known.setdefault("place", settings.place)
    if not (known or settings.license or settings.attribution):
        return envmap
    capture = capture_for(path, known, settings.license, settings.attribution)
    return envmap.with_changes(capture=capture)
