"""The library of light probes on disk."""

import shlex
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, StorageError, UsageError
from panokit.io import read_environment_map
from panokit.io.files import storage_error
from panokit.probes.index import IN_MEMORY, Entry, Index, ProbeFilter, entry_of
from panokit.probes.probe import Probe, probe_id
from panokit.probes.shelf import MAP_NAME, Problem, Shelf
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
    ) -> Added:
        """Add a map; one that is in the library already is left as it is.

        Args:
            source: An .exr or .hdr file, or a map.
            name: What to call it; else the file's name or the capture's key.
            report: What QA said of it; else its checks are made now.

        Raises:
            ImageError: If the file cannot be used.
            StorageError: If the library cannot be written.
        """
        envmap = source if isinstance(source, EnvironmentMap) else read_environment_map(source)
        id = probe_id(envmap)
        if self._shelf.has(id):
            return Added(probe=self._shelf.read(id), is_new=False)
        probe = self._shelf.put(envmap, name or _name_of(source), report or check(envmap))
        self._index.put([entry_of(probe)])
        return Added(probe=probe, is_new=True)

    def list(self, wanted: ProbeFilter | None = None) -> tuple[Entry, ...]:
        """The probes that a filter lets pass, by name."""
        return self._index.find(wanted or ProbeFilter())

    def show(self, id: str) -> Probe:
        """All that is known of one probe.

        Args:
            id: Its id, or so many of its first digits that no other begins so.

        Raises:
            UsageError: If there is none such, or more than one.
            RecordError: If its record is damaged.
        """
        found = self._index.with_prefix(id) if id else ()
        if len(found) == 1:
            return self._shelf.read(found[0])
        if found:
            raise UsageError(
                f"{len(found)} probes begin with {id!r}: {', '.join(found[:4])}... "
                "Give more digits."
            )
        raise UsageError(
            f"There is no probe {id!r} in {self.folder}. "
            f"See those there with: panokit probes list {_quoted(self.folder)}"
        )

    def map_path(self, id: str) -> Path:
        """The file of a probe's map; see `show` for `id`."""
        return self._shelf.folder(self.show(id).id) / MAP_NAME

    def read(self, id: str) -> EnvironmentMap:
        """A probe's map; see `show` for `id`."""
        return read_environment_map(self.map_path(id))

    def verify(self) -> Verification:
        """Hash every file, read every map again, and remove what an interruption left."""
        swept = self._shelf.sweep()
        problems = tuple(self._shelf.problems())
        return Verification(checked=len(self._shelf.ids()), problems=problems, swept=swept)

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
        self._catch_up(self._index)
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
        on_shelf, indexed = set(self._shelf.ids()), index.ids()
        if on_shelf == indexed:
            return
        index.remove(indexed - on_shelf)
        entries = []
        for id in sorted(on_shelf - indexed):
            try:
                entries.append(entry_of(self._shelf.read(id)))
            except ItemError:
                # A damaged record hides one probe, not the library; verify reports it.
                continue
        index.put(entries)


def _quoted(folder: Path) -> str:
    return shlex.quote(str(folder))


def _name_of(source: Path | EnvironmentMap) -> str:
    if not isinstance(source, EnvironmentMap):
        return Path(source).stem
    return source.capture.key if source.capture else "unnamed"
