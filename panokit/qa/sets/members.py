"""The maps of a set, with what is known of them besides their pixels."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from panokit.capture import Capture
from panokit.errors import RecordError, UsageError
from panokit.io import read_json
from panokit.io.pictures import record_path
from panokit.io.probe_manifest import NAME as MANIFEST
from panokit.io.probe_manifest import ManifestRow, read_manifest
from panokit.qa.items import find_maps
from panokit.qa.sets.places import CLUSTER_M, near_on_the_ground
from panokit.qa.sets.resampling import TwoSets, two_sets


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """One map of a set.

    Attributes:
        name: Unique in its set. A map of the same name in the other set shows the same scene.
        path: Of the map.
        capture: Where and when, or None.
        category: The kind of scene, if a manifest says so, else "".
        group: Maps of one group show one place; "" for none.
    """

    name: str
    path: Path
    capture: Capture | None = None
    category: str = ""
    group: str = ""


def members_of(folder: Path) -> list[Member]:
    """Every map of a folder, with the category and group that its manifest.csv gives, if any.

    For the manifest see `panokit.io.probe_manifest`; maps that it calls usable for anything but
    training are left out.

    Raises:
        UsageError: If there is no map to take.
        RecordError: If the manifest is damaged.
        StorageError: If the folder cannot be read.
    """
    rows = manifest_rows(folder)
    found = []
    for name, path in find_maps(folder).items():
        row = rows.get(path.name)
        if row is not None and row.usable_for != "training":
            continue
        found.append(
            Member(
                name=name if row is None else row.name,
                path=path,
                capture=_capture_beside(path),
                category="" if row is None else row.category,
                group="" if row is None else row.group,
            )
        )
    if not found:
        raise UsageError(f"There are no .exr or .hdr maps in {folder} to make a set of.")
    return found


def groups_of(augmented: Sequence[Member], reference: Sequence[Member]) -> TwoSets:
    """Which maps show one place: by their names, their manifest's groups, or within 50 m.

    Raises:
        UsageError: If a set is empty.
    """
    members = [*augmented, *reference]
    parent = list(range(len(members)))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    first: dict[tuple[str, str], int] = {}
    for i, member in enumerate(members):
        for key in (("name", member.name), ("group", member.group)):
            if key[1]:
                parent[root(i)] = root(first.setdefault(key, i))
    for i, j in near_on_the_ground([member.capture for member in members], CLUSTER_M):
        parent[root(j)] = root(i)
    names = [str(root(i)) for i in range(len(members))]
    return two_sets(names[: len(augmented)], names[len(augmented) :])


def manifest_rows(folder: Path) -> dict[str, ManifestRow]:
    """The rows of a folder's manifest.csv by the file's name; empty if there is none.

    Raises:
        RecordError: If it is damaged.
        StorageError: If it cannot be read.
    """
    if not (folder / MANIFEST).is_file():
        return {}
    return {row.path.name: row for row in read_manifest(folder)}


def _capture_beside(path: Path) -> Capture | None:
    record = record_path(path)
    try:
        return Capture.from_json(read_json(record)["capture"]) if record.exists() else None
    except (RecordError, KeyError, TypeError):
        return None
