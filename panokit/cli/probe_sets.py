"""`panokit probes select` and `panokit probes export`: some of a library, for something."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.cli.probes import Filter, LibraryFolder
from panokit.console import Console
from panokit.probes.settings import ExportSettings, ProbeFilter, SelectSettings

if TYPE_CHECKING:
    from panokit.probes import Library
    from panokit.probes.exporting import Exported

_SelectionFile = Annotated[Path | None, Parameter(help="A file of `panokit probes select`.")]


def select(
    library: LibraryFolder,
    /,
    *,
    settings: Annotated[SelectSettings, Parameter(name="*")],
    out: Annotated[Path | None, Parameter(help="Where to write the selection, as JSON.")] = None,
    wanted: Filter = ProbeFilter(),
    json: Json = False,
) -> int:
    """Choose probes, as many of each category and as different as can be."""
    from panokit.probes import Library
    from panokit.probes import select as choose
    from panokit.probes.selection import write_selection

    console = Console(as_json=json)
    with Library.open(library) as shelves:
        criteria = wanted.model_dump(mode="json", exclude_defaults=True)
        selection = choose(shelves.list(wanted), shelves.descriptors(), settings, criteria)
    if out is not None:
        write_selection(selection, out)
    for id, name in zip(selection.ids, selection.names, strict=True):
        console.result(f"{id}  {name[:60]}")
    for group, (taken, there) in selection.counts.items():
        console.note(f"{group}: {taken} of {there}")
    if len(selection.ids) < settings.count:
        console.note(f"There are only {len(selection.ids)} to choose, not {settings.count}.")
    if out is not None:
        console.note(f"Written to {out}")
    console.value(selection.to_json())
    return 0


def export(
    library: LibraryFolder,
    /,
    *,
    settings: Annotated[ExportSettings, Parameter(name="*")],
    out: Annotated[Path, Parameter(help="The folder for the files and their credits.")],
    ids: Annotated[
        tuple[str, ...], Parameter(name="--id", help="A probe by id, first digits, or name.")
    ] = (),
    selection: _SelectionFile = None,
    all: Annotated[bool, Parameter(negative=(), help="Every probe of the library.")] = False,
    wanted: Filter = ProbeFilter(),
    json: Json = False,
) -> int:
    """Write probes as other tools want them, with a sheet of credits.

    Name them with --id, with --selection, by what they are, or take --all.
    """
    from panokit.probes import Library, export_probes
    from panokit.probes.exporting import Exported

    console = Console(as_json=json)
    with Library.open(library) as shelves:
        chosen = _chosen(shelves, settings, ids, selection, wanted, everything=all)
        with console.stage("export", len(chosen)) as tick:
            result = export_probes(
                shelves,
                chosen,
                out,
                settings,
                on_done=lambda one: tick(rejected=not isinstance(one, Exported)),
            )
    for rejection in result.rejections:
        console.note(f"export: {rejection.message}")
    if result.table is not None:
        console.result(f"{result.table}  {len(result.exported)} probes")
    else:
        for one in result.exported:
            console.result(f"{one.probe.id[:8]}  {out / one.files[0]}")
    console.note(f"{len(result.exported)} exported; credits in {out / 'ATTRIBUTION.md'}")
    _note_suns(console, settings, result.exported)
    console.value(
        {
            "exported": [
                {
                    "id": one.probe.id,
                    "files": [str(out / name) for name in one.files],
                    "sun": one.sun and one.sun.to_json(),
                }
                for one in result.exported
            ],
            "rejected": [rejection.to_json() for rejection in result.rejections],
        }
    )
    return 1 if result.rejections else 0


def _note_suns(console: Console, settings: ExportSettings, exported: Sequence["Exported"]) -> None:
    if settings.sun != "apart" or settings.to == "parquet":
        return
    count = sum(one.sun is not None for one in exported)
    console.note(f"{count} of {len(exported)} have a sun that is now a light of its own")


def _chosen(
    library: "Library",
    settings: ExportSettings,
    ids: tuple[str, ...],
    selection: Path | None,
    wanted: ProbeFilter,
    *,
    everything: bool,
) -> list[str]:
    """The ids that a command names, in whatever way."""
    from panokit.errors import UsageError
    from panokit.probes.selection import read_selection

    named = list(ids)
    if selection is not None:
        named += read_selection(selection).ids
    by_filter = wanted != ProbeFilter()
    if named and (by_filter or everything):
        raise UsageError("Name probes with --id or --selection, or by what they are, not both.")
    if named:
        return named
    if by_filter or everything or settings.to == "parquet":
        found = [entry.id for entry in library.list(wanted)]
        if not found:
            raise UsageError("No probe is like that. See what there is with: panokit probes list")
        return found
    raise UsageError("Say which probes: --id, --selection, --all, or by what they are.")
