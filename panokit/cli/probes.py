"""`panokit probes`: the library of light probes."""

import json as json_text
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console

LibraryFolder = Annotated[Path, Parameter(help="The library's folder.")]


def add(
    library: LibraryFolder, maps: list[Path], /, *, repair: bool = False, json: Json = False
) -> int:
    """Put maps into a library; one that is there already is left as it is.

    Parameters
    ----------
    maps
        A run folder, or HDR maps, or folders of them.
    repair
        Clean values that are not physical instead of rejecting the map.
    """
    from panokit.errors import ItemError, Rejection, UsageError
    from panokit.io import read_environment_map
    from panokit.pipeline.inputs import map_paths
    from panokit.probes import Library

    console = Console(as_json=json)
    paths = map_paths(maps)
    if not paths:
        raise UsageError("There are no .exr or .hdr maps here. Check the paths.")
    added, rejections = [], []
    with Library.create(library) as shelves, console.stage("probes", len(paths)) as tick:
        for path in paths:
            try:
                envmap = read_environment_map(path, repair=repair)
                added.append(shelves.add(envmap, name=path.stem))
                tick()
            except ItemError as error:
                rejections.append(Rejection.from_error(path.stem, "probes", error))
                console.note(f"probes: {path.stem} rejected: {error}")
                tick(rejected=True)
    for one in added:
        state = "added" if one.is_new else "there already"
        console.result(f"{one.probe.id}  {one.probe.name}  {state}")
    console.value(
        {
            "added": [{"id": a.probe.id, "name": a.probe.name, "new": a.is_new} for a in added],
            "rejected": [rejection.to_json() for rejection in rejections],
        }
    )
    return 1 if rejections else 0


def list_probes(
    library: LibraryFolder,
    /,
    *,
    name: str | None = None,
    place: str | None = None,
    license: str | None = None,
    trainable: bool | None = None,
    verdict: str | None = None,
    json: Json = False,
) -> int:
    """List a library.

    Parameters
    ----------
    name
        Only probes whose name has this in it.
    place
        Only probes of this city or area.
    license
        Only probes with this license id.
    trainable
        Only probes whose license lets models be trained with them.
    verdict
        Only probes that QA let "pass", or "fail".
    """
    from panokit.probes import Library, ProbeFilter

    console = Console(as_json=json)
    wanted = ProbeFilter(
        name=name, place=place, license=license, trainable=trainable, verdict=verdict
    )
    with Library.open(library) as shelves:
        entries = shelves.list(wanted)
    console.table(
        ("id", "name", "place", "stops", "qa", "license"),
        [
            (
                entry.id[:10],
                _tail(entry.name, 26),
                _head(entry.place, 12),
                "" if entry.dynamic_range_stops is None else f"{entry.dynamic_range_stops:.1f}",
                entry.verdict,
                entry.license,
            )
            for entry in entries
        ],
    )
    console.note(f"{len(entries)} probes")
    console.value([asdict(entry) for entry in entries])
    return 0


def show(library: LibraryFolder, id: str, /, *, json: Json = False) -> int:
    """All that is known of one probe.

    Parameters
    ----------
    id
        Its id, or its first digits.
    """
    from panokit.probes import Library

    console = Console(as_json=json)
    with Library.open(library) as shelves:
        probe = shelves.show(id)
        path = shelves.map_path(probe.id)
    capture = probe.capture
    rows = [("id", probe.id), ("name", probe.name), ("map", str(path))]
    rows += [("size", f"{probe.width_px}x{probe.width_px // 2}"), ("frame", str(probe.frame))]
    rows += [("1.0 stands for", str(probe.anchor)), ("license", probe.license.id)]
    rows += [("attribution", probe.license.attribution)] if probe.license.attribution else []
    rows += [("source", f"{capture.provider} {capture.id}")] if capture else []
    rows += [("place", capture.place)] if capture and capture.place else []
    rows += [("steps", " > ".join(step.stage for step in probe.provenance.steps))]
    for check in probe.report.checks:
        rows.append((f"qa {check.name}", f"{_figure(check.value)} {check.unit} {check.verdict}"))
    for label, text in rows:
        console.result(f"{label:20} {text}")
    console.value(json_text.loads(json_text.dumps(probe.to_json(), default=str)))
    return 0


def verify(library: LibraryFolder, /, *, json: Json = False) -> int:
    """Read and hash every probe again; exit code 1 if one is damaged."""
    from panokit.probes import Library

    console = Console(as_json=json)
    with Library.open(library) as shelves:
        found = shelves.verify()
    for problem in found.problems:
        console.result(f"damaged: {problem.folder}: {problem.message}")
    for name in found.swept:
        console.note(f"removed what an interruption had left: {name}")
    console.result(f"{found.checked} probes, {len(found.problems)} damaged")
    console.value(
        {
            "checked": found.checked,
            "problems": [asdict(p) for p in found.problems],
            "swept": list(found.swept),
        }
    )
    return 1 if found.problems else 0


def reindex(library: LibraryFolder, /, *, json: Json = False) -> int:
    """Build a library's index anew from its records."""
    from panokit.probes import Library

    console = Console(as_json=json)
    with Library.open(library) as shelves:
        count = shelves.reindex()
    console.result(f"{count} probes indexed")
    console.value({"indexed": count})
    return 0


def _head(text: str, length: int) -> str:
    return text if len(text) <= length else text[: length - 1] + "…"


def _tail(text: str, length: int) -> str:
    # Names differ at their ends: what stands before is the provider.
    return text if len(text) <= length else "…" + text[1 - length :]


def _figure(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
