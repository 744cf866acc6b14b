"""A sheet of samples to look at, as figure 4.1 of the 2018 thesis has one."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from panokit.color import tonemap
from panokit.color.transfer import srgb_encode_u8
from panokit.dataset.storage.index import index_shards, indexed_digest, read_index, shards_digest
from panokit.dataset.storage.layout import DatasetFolder
from panokit.dataset.storage.read import StereoDataset
from panokit.errors import StorageError

_CELL_PX, _GAP_PX, _HEAD_PX = 128, 4, 20
_COLUMNS = ("left", "right", "normals", "light around the left camera", "reflectance")
_PAPER, _INK = (255, 255, 255), (40, 40, 40)
_NEEDED = ("left.png", "right.png", "left_normal.exr", "env.exr")


def contact_sheet(dataset: StereoDataset, numbers: Sequence[int]) -> NDArray[np.uint8]:
    """A row for each sample: both views, normals, the aligned map and the reflectance map.

    Normals are shown as (n + 1) / 2; the map, which holds more than a screen can show, by
    Reinhard's operator; the reflectance map like the pictures.

    Args:
        dataset: Of any members.
        numbers: Which samples.

    Returns:
        (H, W, 3) uint8.
    """
    rows = [_row(dataset, number) for number in numbers]
    lefts = _lefts(rows[0])
    width = lefts[-1] + rows[0][-1].shape[1] + _GAP_PX
    sheet = Image.new("RGB", (width, _HEAD_PX + len(rows) * (_CELL_PX + _GAP_PX)), _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=12)
    for left, text in zip(lefts, _COLUMNS, strict=True):
        draw.text((left, _HEAD_PX // 2), text, fill=_INK, font=font, anchor="lm")
    for number, row in enumerate(rows):
        for left, cell in zip(lefts, row, strict=True):
            place = (left, _HEAD_PX + number * (_CELL_PX + _GAP_PX))
            sheet.paste(Image.fromarray(cell), place)
    return np.asarray(sheet)


def _lefts(row: list[NDArray[np.uint8]]) -> list[int]:
    widths = [cell.shape[1] + _GAP_PX for cell in row]
    return [_GAP_PX + sum(widths[:number]) for number in range(len(row))]


def _row(dataset: StereoDataset, number: int) -> list[NDArray[np.uint8]]:
    left, right, normal, light = (dataset.decoded(number, name) for name in _NEEDED)
    names = dataset.names(number)
    first = "reflectance.exr" if "reflectance.exr" in names else "reflectance_1.exr"
    reflectance = (
        srgb_encode_u8(dataset.decoded(number, first)) if first in names else np.zeros_like(left)
    )
    seen = (normal != 0).any(axis=-1, keepdims=True)
    colors = np.where(seen, (normal + 1) / 2, 1.0)
    shown = [left, right, np.rint(255 * np.clip(colors, 0, 1)).astype(np.uint8), tonemap(light)]
    return [_cell(picture) for picture in (*shown, reflectance)]


def _cell(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture at the height of a row."""
    height, width = picture.shape[:2]
    size = (round(width * _CELL_PX / height), _CELL_PX)
    way = Image.Resampling.BOX if height > _CELL_PX else Image.Resampling.NEAREST
    return np.asarray(Image.fromarray(picture).resize(size, way))


def spread(count: int, wanted: int) -> list[int]:
    """So many numbers below `count`, evenly spread."""
    return [int(n) for n in np.linspace(0, count - 1, min(count, wanted)).round()]


def open_for_preview(folder: Path, split: str | None = None) -> StereoDataset:
    """The samples of a dataset that may still be under way: those in shards that are complete.

    Raises:
        StorageError: If there is none yet.
    """
    place = DatasetFolder(Path(folder))
    shards = place.complete_shards()
    index: pa.Table
    if place.index.exists() and indexed_digest(place.root) == shards_digest(shards):
        index = read_index(place.root)
    else:
        index = index_shards(shards)
    dataset = StereoDataset(folder, split, members=(), index=index)
    if len(dataset) == 0:
        of = f" of {split}" if split else ""
        raise StorageError(
            f"There are no samples{of} in {folder} yet. Make some with `panokit dataset render`, "
            "or wait for the first shard."
        )
    return dataset
