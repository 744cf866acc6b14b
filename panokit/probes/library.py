"""The library of light probes on disk."""

from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError, UsageError
from panokit.io import read_environment_map
from panokit.io.files import storage_error
from panokit.probes.index import Entry, Index, ProbeFilter, entry_of
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
    or behind. One process writes at a time; others may read.
    """

    def __init__(self, folder: Path) -> None:
        """Use `Library.create` or `Library.open`."""
        self.folder = folder
        self._shelf = Shelf(folder / SHELF_NAME)
        self._index = Index(folder / INDEX_NAME)
        self._catch_up()

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
        """
        folder = Path(folder)
        if not (folder / SHELF_NAME).is_dir():
            raise UsageError(
                f"There is no probe library in {folder}. "
                "Make one by adding maps: panokit probes add LIBRARY MAP..."
            )
        return cls(folder)

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
        raise UsageError(f"There is no probe {id!r} in {self.folder}. See `panokit probes list`.")

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
        """
        self._shelf.sweep()
        self._index.remove(self._index.ids())
        self._catch_up()
        return len(self)

    def _catch_up(self) -> None:
        """Bring the index to what the folders are: after a kill, a copy or a deleted index."""
        on_shelf, indexed = set(self._shelf.ids()), self._index.ids()
        if on_shelf == indexed:
            return
        self._index.remove(indexed - on_shelf)
        entries = []
        for id in sorted(on_shelf - indexed):
            try:
                entries.append(entry_of(self._shelf.read(id)))
            except ItemError:
                # A damaged record hides one probe, not the library; verify reports it.
                continue
        self._index.put(entries)


def _name_of(source: Path | EnvironmentMap) -> str:
    if not isinstance(source, EnvironmentMap):
        return Path(source).stem
    return source.capture.key if source.capture else "unnamed"
