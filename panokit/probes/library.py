"""The library of light probes on disk."""

import shlex
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from types import TracebackType

from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, StorageError, UsageError
from panokit.io import read_environment_map
from panokit.io.files import storage_error
from panokit.probes.entry import Entry, entry_of
from panokit.probes.index import IN_MEMORY, Index
from panokit.probes.probe import Probe, probe_id
from panokit.probes.settings import ProbeFilter
from panokit.probes.shelf import Known, Problem, Shelf
from panokit.qa import Report, check

INDEX_NAME = "library.sqlite"
SHELF_NAME = "probes"


@dataclass(frozen=True, slots=True, kw_only=True)
class Added:
    """What `add` did.

    Attributes:
        probe: The probe, as it is in the library.
        is_new: False where the same map was there already; then nothing was written.
    """

    probe: Probe
    is_new: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """What `verify` found.

    Attributes:
        checked: How many probes are in the library.
        problems: What is wrong; empty if all is well.
        swept: Folders that an interrupted `add` had left, now removed.
    """

    checked: int
    problems: tuple[Problem, ...]
    swept: tuple[str, ...]


class Library:
    """Light maps with their records, previews and an index; use it in a `with` block.

    The folders are the library; the index is rebuilt from them when it is missing, damaged
    or behind. One process writes at a time; others may read. Where the index cannot be written,
    an opened library makes do with one in memory, from the records.
    """

    def __init__(self, folder: Path, *, to_read: bool = False) -> None:
        """Use `Library.create` or `Library.open`."""
        self.folder = folder
        self._shelf = Shelf(folder / SHELF_NAME)
        try:
            self._index = self._opened(folder / INDEX_NAME)
        except StorageError:
            if not to_read:
                raise
            self._index = self._opened(IN_MEMORY)

    @classmethod
    def create(cls, folder: Path) -> "Library":
        """The library in a folder, new if there is none yet.

        Raises:
            StorageError: If the folder cannot be made.
        """
        folder = Path(folder)
        try:
            (folder / SHELF_NAME).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise storage_error("make", folder / SHELF_NAME, error) from error
        return cls(folder)

    @classmethod
    def open(cls, folder: Path) -> "Library":
        """The library in a folder.

        Raises:
            UsageError: If there is none.
            StorageError: If it cannot be read.
        """
        folder = Path(folder)
        try:
            is_library = (folder / SHELF_NAME).is_dir()
        except OSError as error:
            raise storage_error("read", folder, error) from error
        if not is_library:
            raise UsageError(
                f"There is no probe library in {folder}. "
                f"Make one by adding maps: panokit probes add {_quoted(folder)} MAP..."
            )
        return cls(folder, to_read=True)

    def __enter__(self) -> "Library":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __len__(self) -> int:
        return len(self._index.ids())

    def close(self) -> None:
        """Close the index."""
        self._index.close()

    def add(
        self,
        source: Path | EnvironmentMap,
        *,
        name: str = "",
        report: Report | None = None,
        category: str = "",
        tags: Sequence[str] = (),
        kind: str = "",
        in_place: Path | None = None,
    ) -> Added:
        """Add a map; one that is in the library already is left as it is.

        Args:
            source: An .exr or .hdr file, or a map.
            name: What to call it; else the file's name or the capture's key.
            report: What QA said of it; else its checks are made now.
            category: The kind of scene; else what its capture says.
            tags: Words to find it by, besides those of its capture.
            kind: "native", "lifted" or "synthetic"; else what its provenance says.
            in_place: The file that `source` was read from, to be used where it lies: the
                library then keeps its digest, a record and a preview, and no copy.

        Raises:
            ImageError: If the file cannot be used.
            StorageError: If the library cannot be written.
        """
        envmap = source if isinstance(source, EnvironmentMap) else read_environment_map(source)
        id = probe_id(envmap)
        if self._shelf.has(id):
            return Added(probe=self._shelf.read(id), is_new=False)
        known = Known(
            name=name or _name_of(source),
            report=report or check(envmap),
            category=category,
            tags=tuple(tags),
            kind=kind,
            source=in_place,
        )
        probe = self._shelf.put(envmap, known)
        self._index.put([(entry_of(probe), probe.descriptor)])
        return Added(probe=probe, is_new=True)

    def list(self, wanted: ProbeFilter | None = None) -> tuple[Entry, ...]:
        """The probes that a filter lets pass, by name."""
        return self._index.find(wanted or ProbeFilter())

    def entries(self, ids: Sequence[str]) -> tuple[Entry, ...]:
        """The lines of these probes, by whole id, in this order; see `find_id` for parts."""
        return self._index.entries(ids)

    def descriptors(self) -> dict[str, tuple[float, ...]]:
        """Id -> what light each probe has; see `panokit.probes.descriptors`."""
        return self._index.descriptors()

    def find_id(self, wanted: str) -> str:
        """The id of a probe.

        Args:
            wanted: The id, or so many of its first digits that no other begins so, or the
                probe's name.

        Raises:
            UsageError: If there is none such, or more than one; the message names the nearest.
        """
        found = self._index.with_prefix(wanted) if wanted else ()
        found = found or (self._index.named(wanted) if wanted else ())
        if len(found) == 1:
            return found[0]
        if found:
            more = f" and {len(found) - 3} more" if len(found) > 3 else ""
            raise UsageError(
                f"{len(found)} probes begin with {wanted!r} or are called so: "
                f"{', '.join(found[:3])}{more}. Give more digits of the id."
            )
        raise UsageError(self._nothing_like(wanted))

    def show(self, id: str) -> Probe:
        """All that is known of one probe.

        Args:
            id: See `find_id`.

        Raises:
            UsageError: If there is none such, or more than one.
            RecordError: If its record is damaged.
        """
        return self._shelf.read(self.find_id(id))

    def map_path(self, id: str) -> Path:
        """The file of a probe's map, in the library or in place; see `find_id` for `id`."""
        return self._shelf.map_file(self.show(id))

    def read(self, id: str) -> EnvironmentMap:
        """A probe's map with its record; see `find_id` for `id`.

        Raises:
            RecordError: If the file is no longer what was added.
            StorageError: If it is gone.
        """
        return self._shelf.read_map(self.show(id))

    def records(self, ids: Iterable[str]) -> Iterable[Probe]:
        """The records of probes by whole id, one after the other.

        Raises:
            RecordError: If one is missing or damaged.
        """
        return (self._shelf.read(id) for id in ids)

    def verify(self, on_checked: Callable[[bool], None] | None = None) -> Verification:
        """Hash every file, read every map again, and remove what an interruption left.

        Args:
            on_checked: Called after each folder, with whether something is wrong with it.
        """
        swept = self._shelf.sweep()
        problems: list[Problem] = []
        for found in self._shelf.problems():
            problems += found
            if on_checked is not None:
                on_checked(bool(found))
        return Verification(checked=len(self._shelf.ids()), problems=tuple(problems), swept=swept)

    def reindex(self) -> int:
        """Make the index anew from the records; how many probes it has then.

        Folders that an interruption left are removed. A probe with a damaged record is left
        out; `verify` tells of it.

        Raises:
            StorageError: If the index cannot be written.
        """
        self._shelf.sweep()
        self._index.close()
        self._index = Index(self.folder / INDEX_NAME)
        self._index.remove(self._index.ids())
        self._fill(self._index, self._shelf.ids())
        return len(self)

    def _opened(self, path: Path) -> Index:
        index = Index(path)
        try:
            self._catch_up(index)
        except StorageError:
            index.close()
            raise
        return index

    def _catch_up(self, index: Index) -> None:
        """Bring the index to what the folders are: after a kill, a copy or a deleted index."""
        names, indexed = self._shelf.names(), index.ids()
        gone = indexed - names
        if gone:
            index.remove(gone)
        # Only folders that are new are looked into: ten thousand looks take longer than a list.
        new = [name for name in sorted(names - indexed) if self._shelf.has(name)]
        if new:
            self._fill(index, new)

    def _fill(self, index: Index, ids: Iterable[str]) -> None:
        entries = []
        for id in ids:
            try:
                probe = self._shelf.read(id)
                entries.append((entry_of(probe), probe.descriptor))
            except ItemError:
                # A damaged record hides one probe, not the library; verify reports it.
                continue
        index.put(entries)

    def _nothing_like(self, wanted: str) -> str:
        entries = self.list()
        if not entries:
            return (
                f"There is no probe {wanted!r}: the library {self.folder} is empty. "
                f"Add maps with: panokit probes add {_quoted(self.folder)} MAP..."
            )
        known = {name: entry for entry in entries for name in (entry.id[: len(wanted)], entry.name)}
        near = get_close_matches(wanted, known, n=1, cutoff=0.5)
        hint = f"Did you mean {known[near[0]].id[:10]} ({known[near[0]].name})? " if near else ""
        return (
            f"There is no probe {wanted!r} in {self.folder}. {hint}"
            f"See those there with: panokit probes list {_quoted(self.folder)}"
        )


def _quoted(folder: Path) -> str:
    return shlex.quote(str(folder))


def _name_of(source: Path | EnvironmentMap) -> str:
    if not isinstance(source, EnvironmentMap):
        return Path(source).stem
    return source.capture.key if source.capture else "unnamed"
