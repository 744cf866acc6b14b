"""Pictures to serve from a folder of the user's own."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from panokit.capture import Capture, local_capture
from panokit.errors import ImageError, RecordError, UsageError
from panokit.io.files import read_bytes
from panokit.io.images import LDR_SUFFIXES, decode_image
from panokit.synthetic.pictures import ServedPicture

# Pictures without a place stand on a grid in the open Atlantic, 40 m apart.
_GRID_DEG = (44.0, -29.0)
_GRID_STEP_DEG = 0.0004
_GRID_COLUMNS = 10


def pictures_in(folder: Path) -> tuple[list[ServedPicture], list[str]]:
    """The pictures of a folder, each with the capture from its sidecar NAME.json.

    A sidecar is a record that panokit wrote, or a capture alone. A picture without one gets an
    invented place on a grid, an unknown license and the size of its file.

    Returns:
        The pictures, and the names of those whose place was invented.

    Raises:
        UsageError: If there is no picture in the folder.
        ItemError: If a picture or a sidecar cannot be used.
    """
    folder = Path(folder)
    files = sorted(
        path
        for path in (folder.iterdir() if folder.is_dir() else ())
        if path.suffix.lower() in LDR_SUFFIXES and not path.stem.endswith(".mask")
    )
    if not files:
        raise UsageError(
            f"There are no pictures in {folder}. Name a folder of equirectangular JPEG, PNG, "
            "WebP or TIFF files."
        )
    pictures, invented = [], []
    for index, path in enumerate(files):
        capture = _complete(_capture_beside(path), path)
        if capture.latitude_deg is None or capture.longitude_deg is None:
            capture = _somewhere(capture, index)
            invented.append(path.name)
        pictures.append(ServedPicture(capture=capture, image=path, sequence=folder.name))
    return pictures, invented


def read_captures(index: Path, folder: Path, sequence: str) -> Sequence[ServedPicture]:
    """The pictures of an index file: a JSON list of captures; NAME.jpg has the capture's id."""
    return [
        ServedPicture(
            capture=Capture.from_json(record),
            image=folder / f"{record['id']}.jpg",
            sequence=sequence,
        )
        for record in _json(index)
    ]


def _capture_beside(path: Path) -> Capture:
    sidecar = path.with_suffix(".json")
    if not sidecar.exists():
        return local_capture(path.stem)
    record = _json(sidecar)
    if not isinstance(record, dict):
        raise RecordError(
            f"{sidecar} is not a capture. Mend it, or remove it to serve {path.name} without one.",
            reason="bad-capture-record",
        )
    return Capture.from_json(record.get("capture", record))


def _complete(capture: Capture, path: Path) -> Capture:
    if capture.width_px is not None and capture.height_px is not None:
        return capture
    height, width = decode_image(read_bytes(path), what=str(path)).shape[:2]
    if width != 2 * height:
        raise ImageError(
            f"{path} is {width}x{height}; an equirectangular picture is twice as wide as high. "
            "Remove it from the folder, or crop it to 2:1.",
            reason="not-equirectangular",
        )
    return replace(capture, width_px=width, height_px=height)


def _somewhere(capture: Capture, index: int) -> Capture:
    row, column = divmod(index, _GRID_COLUMNS)
    return replace(
        capture,
        latitude_deg=_GRID_DEG[0] + row * _GRID_STEP_DEG,
        longitude_deg=_GRID_DEG[1] + column * _GRID_STEP_DEG,
    )


def _json(path: Path) -> Any:
    try:
        return json.loads(read_bytes(path))
    except ValueError as error:
        raise RecordError(
            f"{path} is not JSON ({error}). Mend it, or remove it.", reason="not-json"
        ) from error
