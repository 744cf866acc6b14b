"""A split of a dataset as arrays: decoded once, then read as fast as memory.

Decoding PNG and EXR for each step would take longer than the step. A pack is a folder of .npy
files that are mapped into memory, so several trainings share them.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.dataset.storage.read import StereoDataset
from panokit.errors import UsageError
from panokit.io.files import read_json, write_json
from panokit.provenance import digest_of

PICTURES = ("left", "right", "left_object", "right_object", "background")
MAPS = ("env64", "reflectance")
REFLECTANCE_PX = 64
_SCHEMA = "panokit.pack/1"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pack:
    """A split in memory-mapped arrays, N samples.

    Attributes:
        keys: (N,), of the samples.
        places: (N,), where their light is from.
        arrays: "left", "right", "left_object", "right_object", "background": (N, S, S, 3) uint8;
            "env64", "reflectance": (N, 64, 64, 3) float32; "normal": (N, S, S, 3) float16;
            "part": (N, S, S) uint8, the material's number plus one on the object.
    """

    keys: NDArray[np.str_]
    places: NDArray[np.str_]
    arrays: Mapping[str, NDArray[np.generic]]

    def __len__(self) -> int:
        return len(self.keys)


def open_pack(dataset: Path, split: str, input_px: int, work: Path, limit: int = 0) -> Pack:
    """The pack of a split, made if it is not there.

    Args:
        dataset: The dataset's folder.
        split: "train", "validation" or "test".
        input_px: To which pictures are made smaller.
        work: Where packs are kept.
        limit: At most so many samples, the first ones; all if 0.

    Raises:
        UsageError: If the split is empty, or its pictures are smaller than `input_px`.
    """
    source = StereoDataset(
        dataset,
        split,
        members=(
            *(f"{name}.png" for name in PICTURES), "left_mask.png", "left_normal.exr",
            "env64.exr", "meta.json",
        ),
    )  # fmt: skip
    count = min(limit, len(source)) if limit else len(source)
    if count == 0:
        raise UsageError(f"{dataset} has no samples for {split}. Render more of them.")
    name = digest_of([_SCHEMA, source.keys[:count].tolist(), str(dataset.resolve()), input_px])
    folder = work / "packs" / f"{split}-{name[:12]}"
    if not (folder / "pack.json").is_file():
        _write(folder, source, count, input_px)
    return _read(folder)


def _write(folder: Path, source: StereoDataset, count: int, size: int) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    shapes: dict[str, tuple[tuple[int, ...], type]] = {
        **dict.fromkeys(PICTURES, ((size, size, 3), np.uint8)),
        **dict.fromkeys(MAPS, ((REFLECTANCE_PX, REFLECTANCE_PX, 3), np.float32)),
        "normal": ((size, size, 3), np.float16),
        "part": ((size, size), np.uint8),
    }
    arrays = {
        name: np.lib.format.open_memmap(
            folder / f"{name}.npy", mode="w+", dtype=kind, shape=(count, *shape)
        )
        for name, (shape, kind) in shapes.items()
    }
    keys, places = [], []
    for number in range(count):
        files = source[number]
        for name in PICTURES:
            arrays[name][number] = _smaller(files[name], size)
        arrays["env64"][number] = files["env64"]
        arrays["reflectance"][number] = _reflectance(source, number)
        arrays["normal"][number] = _normals(files["left_normal"], size)
        arrays["part"][number] = _parts(source, number, files["left_mask"], size)
        keys.append(files["key"])
        places.append(files["meta"]["probe"]["place"])
    for array in arrays.values():
        array.flush()
    record = {"schema": _SCHEMA, "keys": keys, "places": places, "arrays": sorted(arrays)}
    write_json(folder / "pack.json", record)


def _read(folder: Path) -> Pack:
    record = read_json(folder / "pack.json")
    return Pack(
        keys=np.array(record["keys"]),
        places=np.array(record["places"]),
        arrays={name: np.load(folder / f"{name}.npy", mmap_mode="r") for name in record["arrays"]},
    )


def _smaller(picture: NDArray[np.uint8], size: int) -> NDArray[np.uint8]:
    if picture.shape[0] < size:
        raise UsageError(
            f"The pictures are {picture.shape[0]} pixels wide, less than input_px = {size}."
        )
    if picture.shape[0] == size:
        return picture
    return np.asarray(cv2.resize(picture, (size, size), interpolation=cv2.INTER_AREA), np.uint8)


def _normals(normals: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    """Normals at the centers of larger pixels: means, made unit again."""
    if normals.shape[0] != size:
        normals = np.asarray(
            cv2.resize(normals, (size, size), interpolation=cv2.INTER_AREA), np.float32
        )
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return np.where(length > 0.5, normals / np.maximum(length, 1e-6), 0).astype(np.float32)


def _parts(
    source: StereoDataset, number: int, mask: NDArray[np.uint8], size: int
) -> NDArray[np.uint8]:
    part = (mask >= 128).astype(np.uint8)
    if "left_material.png" in source.names(number):
        part = part * np.maximum(source.decoded(number, "left_material.png"), 1)
    return np.asarray(cv2.resize(part, (size, size), interpolation=cv2.INTER_NEAREST), np.uint8)


def _reflectance(source: StereoDataset, number: int) -> NDArray[np.float32]:
    """The reflectance map of the sample's first material."""
    names = source.names(number)
    name = "reflectance.exr" if "reflectance.exr" in names else "reflectance_1.exr"
    return np.asarray(source.decoded(number, name), np.float32)
