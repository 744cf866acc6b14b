"""`panokit probes`: the library of light probes."""

import json as json_text
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console
from panokit.probes.settings import AddSettings, ProbeFilter

if TYPE_CHECKING:
    from panokit.probes import Entry, Probe

LibraryFolder = Annotated[Path, Parameter(help="The library's folder.")]
Filter = Annotated[ProbeFilter, Parameter(name="*")]
_LABEL_WIDTH, _WIDTH = 15, 80
_SHORT_KINDS = {"synthetic": "synth."}


def add(
    library: LibraryFolder,
    maps: list[Path],
    /,
    *,
    settings: Annotated[AddSettings, Parameter(name="*")] = AddSettings(),
    json: Json = False,
) -> int:
    """Put maps into a library; one that is there already is left as it is.

    A folder may hold a manifest.csv with a line for each file: name, category, license, ...

    Parameters
    ----------
    maps
        A run folder, or HDR maps, or folders of them.
    """
    from panokit.pipeline.adding import add_maps

    console = Console(as_json=json)
    result = add_maps(maps, library, settings, console)
    for one in result.added:
        state = "there already"
        if one.is_new:
            state = "added in place" if one.probe.source else "added"
        console.result(f"{one.probe.id}  {one.probe.name}  {state}")
    new = sum(one.is_new for one in result.added)
    if len(result.added) > 1:
        console.note(
            f"{new} added, {len(result.added) - new} there already, "
            f"{len(result.rejections)} rejected"
        )
    console.value(
        {
            "added": [
                {
                    "id": one.probe.id,
                    "name": one.probe.name,
                    "new": one.is_new,
                    "in_place": one.probe.source is not None,
                }
                for one in result.added
            ],
            "rejected": [rejection.to_json() for rejection in result.rejections],
        }
    )
    return 1 if result.rejections else 0


def list_probes(
    library: LibraryFolder,
    /,
    *,
    wanted: Filter = ProbeFilter(),
    json: Json = False,
) -> int:
    """List a library, by name; options narrow it down."""
    from panokit.probes import Library

    console = Console(as_json=json)
    with Library.open(library) as shelves:
        entries = shelves.list(wanted)
        count = len(shelves)
    if entries:
        console.table(("id", "name", "category", "kind", "stops", "sun", "qa", "license"),
                      [_row(entry) for entry in entries])  # fmt: skip
    console.note(_count_text(library, len(entries), count))
    console.value([entry.to_json() for entry in entries])
    return 0


def show(library: LibraryFolder, id: str, /, *, json: Json = False) -> int:
    """All that is known of one probe, and the chain that made it.

    Parameters
    ----------
    id
        Its id, or its first digits, or its name.
    """
    from panokit.probes import Library, chain_lines

    console = Console(as_json=json)
    with Library.open(library) as shelves:
        probe = shelves.show(id)
        path = shelves.map_path(probe.id)
    for label, text in _facts(probe, path):
        _say(console, label, text)
    console.result("")
    console.result("how it was made")
    for stage, text in chain_lines(probe):
        _say(console, f"  {stage}", text)
    console.result("")
    console.result(f"quality: {probe.report.verdict}")
    applied = [check for check in probe.report.checks if check.value is not None]
    for check in applied:
        value = f"{check.value:.4g} {check.unit}".strip()
        console.result(f"  {check.name:<18} {value:<18} {check.verdict}")
    without = [check.name for check in probe.report.checks if check.value is None]
    if without:
        _say(console, "not applicable", ", ".join(without))
    console.value(
        {**json_text.loads(json_text.dumps(probe.to_json(), default=str)), "map": str(path)}
    )
    return 0


def verify(library: LibraryFolder, /, *, json: Json = False) -> int:
    """Read and hash every probe again; exit code 1 if one is damaged."""
    from panokit.probes import Library

    console = Console(as_json=json)
    with Library.open(library) as shelves, console.stage("verify", len(shelves)) as tick:
        found = shelves.verify(lambda damaged: tick(rejected=damaged))
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


def _row(entry: "Entry") -> tuple[str, ...]:
    stops = entry.dynamic_range_stops
    return (
        entry.id[:8],
        _middle(entry.name, 17),
        _head(entry.category, 11),
        _SHORT_KINDS.get(entry.kind, entry.kind),
        "" if stops is None else f"{stops:.1f}",
        "sun" if entry.has_sun else "",
        entry.verdict,
        _head(entry.license, 12),
    )


def _count_text(library: Path, shown: int, count: int) -> str:
    if count == 0:
        return f"The library is empty. Add maps with: panokit probes add {library} MAP..."
    if shown == 0:
        return f"None of the {count} probes passes. Ask for less."
    return f"{shown} probes" if shown == count else f"{shown} of {count} probes"


def _facts(probe: "Probe", path: Path) -> list[tuple[str, str]]:
    capture, terms = probe.capture, probe.license
    permits = [act for act, allowed in (("store", terms.store), ("derive", terms.derive),
                                        ("train", terms.train)) if allowed]  # fmt: skip
    rows = [
        ("id", probe.id),
        ("name", probe.name),
        ("map", f"{path}{' (used in place)' if probe.source else ''}"),
        ("size", f"{probe.width_px}x{probe.width_px // 2}"),
        ("kind", probe.kind),
        ("category", probe.category),
        ("tags", ", ".join(probe.tags)),
        ("frame", str(probe.frame)),
        ("1.0 stands for", str(probe.anchor)),
        ("sun", _sun_text(probe)),
        ("place", capture.place if capture else ""),
        ("source", capture.source_url if capture else ""),
        ("license", f"{terms.id}, permits {', '.join(permits) or 'nothing that is known'}"),
        ("attribution", terms.attribution),
    ]
    return [(label, text) for label, text in rows if text]


def _sun_text(probe: "Probe") -> str:
    if not probe.sun:
        return "none that is sure"
    azimuth, elevation = probe.sun.get("azimuth_deg"), probe.sun.get("elevation_deg")
    return f"azimuth {azimuth}°, elevation {elevation}°, by {probe.sun.get('evidence')}"


def _say(console: Console, label: str, text: str) -> None:
    """A label and a text, which goes on below itself where the line ends."""
    lines = _wrapped(text.split(), _WIDTH - _LABEL_WIDTH - 1)
    for number, line in enumerate(lines):
        console.result(f"{label if number == 0 else '':<{_LABEL_WIDTH}} {line}")


def _wrapped(words: Sequence[str], width: int) -> list[str]:
    lines = [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append(word)
        else:
            lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


def _head(text: str, length: int) -> str:
    return text if len(text) <= length else text[: length - 1] + "…"


def _middle(text: str, length: int) -> str:
    # Names differ at both ends: maps of one provider begin alike, those of one place end alike.
    kept = length - 1
    return text if len(text) <= length else f"{text[: kept // 2]}…{text[kept // 2 - kept :]}"
