"""What QA judges: maps on disk, with the pictures that earlier stages made on the way."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from panokit.capture import Capture
from panokit.errors import RecordError, StorageError, UsageError
from panokit.io import HDR_SUFFIXES, read_json
from panokit.io.files import storage_error
from panokit.io.pictures import record_path
from panokit.records import require_folder

_LDR_SUFFIX = ".jpg"


@dataclass(frozen=True, slots=True, kw_only=True)
class QaItem:
    """One map to judge.

    Attributes:
        name: What the report calls it; a reference of this name, or of the capture's id, is
            its truth.
        map_path: The .exr or .hdr file.
        panorama_path: The panorama as stitched, for the report; None if there is none.
        filled_path: The panorama with its holes filled, for the report; None if there is none.
        truth_path: The map it should be; None to look for one of the same name.
        capture: Where it is from; None to take what the map's own record says.
    """

    name: str
    map_path: Path
    panorama_path: Path | None = None
    filled_path: Path | None = None
    truth_path: Path | None = None
    capture: Capture | None = None


def find_items(paths: Iterable[Path]) -> list[QaItem]:
    """The maps that these paths name: a run folder, a folder of maps, or a map.

    A picture NAME.jpg beside a map NAME.exr is taken for the panorama it was made from.

    Raises:
        UsageError: If a path does not exist or holds no maps.
        StorageError: If a folder cannot be read.
    """
    found: list[QaItem] = []
    for path in map(Path, paths):
        try:
            found += _items_at(path)
        except StorageError:
            raise
        except OSError as error:
            raise storage_error("read", path, error) from error
    return found


def find_maps(folder: Path) -> dict[str, Path]:
    """Name -> file of every map in a folder, by name; .exr goes before .hdr.

    Raises:
        StorageError: If the folder cannot be read.
    """
    files = sorted(p for p in require_folder(folder).iterdir() if p.suffix.lower() in HDR_SUFFIXES)
    found: dict[str, Path] = {}
    for file in files:
        found.setdefault(file.stem, file)
    return found


def _items_at(path: Path) -> list[QaItem]:
    if not path.exists():
        raise UsageError(f"There is no {path}. Give a run folder, a folder of maps, or a map.")
    if path.is_file():
        return [_item(path, path.parent, path.parent)]
    require_folder(path)
    probes = path / "probes"
    if probes.is_dir() and (path / "run.json").exists():
        maps, panoramas, filled = probes, path / "panoramas", path / "filled"
    else:
        maps, panoramas, filled = path, path, path / "filled"
    found = find_maps(maps)
    if not found:
        raise UsageError(
            f"There are no .exr or .hdr maps in {maps}. Make some with `panokit expand`."
        )
    return [_item(file, panoramas, filled) for file in found.values()]


def _item(map_path: Path, panoramas: Path, filled: Path) -> QaItem:
    name = map_path.stem
    stitched = panoramas / f"{name}{_LDR_SUFFIX}"
    mended = filled / f"{name}{_LDR_SUFFIX}"
    return QaItem(
        name=name,
        map_path=map_path,
        panorama_path=stitched if stitched.exists() else None,
        filled_path=mended if mended.exists() and mended != stitched else None,
        capture=_capture_of(map_path),
    )


def _capture_of(map_path: Path) -> Capture | None:
    """What the map's record says of its picture; a damaged record is told of when it is read."""
    record = record_path(map_path)
    try:
        return Capture.from_json(read_json(record)["capture"]) if record.exists() else None
    except (RecordError, KeyError, TypeError):
        return None
