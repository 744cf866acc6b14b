"""A split of a dataset as arrays: decoded once, then read as fast as memory.

Decoding PNG and EXR for each step would take longer than the step. A pack is a folder of .npy
files that are mapped into memory, so several trainings share them.
"""

import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.dataset.storage.index import indexed_digest
from panokit.dataset.storage.read import StereoDataset
from panokit.errors import UsageError
from panokit.io.files import read_json, storage_error, write_json
from panokit.provenance import digest_of
from panokit.reflectance.smaller import smaller_normals, smaller_picture, unit_normals

PICTURES = ("left", "right", "left_object", "right_object", "background")
MAPS = ("env64", "reflectance")
REFLECTANCE_PX = 64
_SCHEMA = "panokit.pack/1"
# Samples that are copied at a time.
_BLOCK = 256


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pack:
    """A split in memory-mapped arrays, N samples.

    Attributes:
        keys: (N,), of the samples.
        places: (N,), where their light is from.
        arrays: "left", "right", "left_object", "right_object", "background": (N, S, S, 3) uint8;
            "env64", "reflectance": (N, 64, 64, 3) float32; "normal": (N, S, S, 3) float16;
            "part": (N, S, S) uint8, the number of the material from 1 on the object, else 0.
            Pictures are display-encoded, maps linear with 1.0 the white of the pictures; maps
            and normals are in the left camera's frame.
        digest: Of where it was made from.
    """

    keys: NDArray[np.str_]
    places: NDArray[np.str_]
    arrays: Mapping[str, NDArray[np.generic]]
    digest: str = ""

    def __len__(self) -> int:
        return len(self.keys)


def open_pack(dataset: Path, split: str, input_px: int, work: Path, limit: int = 0) -> Pack:
    """The pack of a split, made if it is not there.

    Args:
        dataset: The dataset's folder.
        split: "train", "validation" or "test".
        input_px: Width and height to which pictures are made smaller.
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
    # By what the shards hold: a dataset that was rendered anew has the same keys.
    name = digest_of([_SCHEMA, source.keys[:count].tolist(), indexed_digest(dataset), input_px])
    folder = work / "packs" / f"{split}-{name[:12]}"
    if not folder.is_dir():
        _make(folder, lambda unfinished: _write(unfinished, source, count, input_px))
    return _read(folder)


def _make(folder: Path, write: Callable[[Path], None]) -> None:
    """Write a pack aside and rename it: nobody, in any process, ever sees a part of it."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    unfinished = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        write(unfinished)
        unfinished.chmod(0o755)
        _put(unfinished, folder)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def _put(finished: Path, folder: Path) -> None:
    try:
        finished.rename(folder)
    except OSError as error:
        # Another process may have been faster with the same pack.
        if not folder.is_dir():
            raise storage_error("write", folder, error) from error


def join_packs(parts: Sequence[tuple[Pack, NDArray[np.int64]]], work: Path) -> Pack:
    """One pack of chosen samples of several, made if it is not there.

    Args:
        parts: Packs of one size, each with the numbers of its samples that are taken.
        work: Where packs are kept.

    Raises:
        UsageError: If nothing is taken.
    """
    count = sum(len(chosen) for _, chosen in parts)
    if count == 0:
        raise UsageError("None of the recipe's sources has a training sample. Look at its places.")
    name = digest_of([_SCHEMA, [[pack.digest, chosen.tolist()] for pack, chosen in parts]])
    folder = work / "packs" / f"joined-{name[:12]}"
    if not folder.is_dir():
        _make(folder, lambda unfinished: _join(unfinished, parts, count))
    return _read(folder)


def _join(folder: Path, parts: Sequence[tuple[Pack, NDArray[np.int64]]], count: int) -> None:
    arrays = parts[0][0].arrays
    for name, like in arrays.items():
        target = np.lib.format.open_memmap(
            folder / f"{name}.npy", mode="w+", dtype=like.dtype, shape=(count, *like.shape[1:])
        )
        first = 0
        for pack, chosen in parts:
            for block in np.array_split(chosen, max(1, len(chosen) // _BLOCK)):
                target[first : first + len(block)] = pack.arrays[name][block]
                first += len(block)
        target.flush()
    keys = [str(pack.keys[number]) for pack, chosen in parts for number in chosen]
    places = [str(pack.places[number]) for pack, chosen in parts for number in chosen]
    _record(folder, keys, places, arrays)


def _write(folder: Path, source: StereoDataset, count: int, size: int) -> None:
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
        _check_size(files["left"], size)
        for name in PICTURES:
            arrays[name][number] = smaller_picture(files[name], size)
        arrays["env64"][number] = files["env64"]
        arrays["reflectance"][number] = _reflectance(source, number)
        # Half-precision normals of the dataset are unit to a thousandth only.
        arrays["normal"][number] = unit_normals(smaller_normals(files["left_normal"], size))
        arrays["part"][number] = _parts(source, number, files["left_mask"], size)
        keys.append(files["key"])
        places.append(files["meta"]["probe"]["place"])
    for array in arrays.values():
        array.flush()
    _record(folder, keys, places, arrays)


def _record(
    folder: Path, keys: list[str], places: list[str], arrays: Mapping[str, NDArray[np.generic]]
) -> None:
    """What says that a pack is complete; written last."""
    record = {"schema": _SCHEMA, "keys": keys, "places": places, "arrays": sorted(arrays)}
    write_json(folder / "pack.json", record)


def _read(folder: Path) -> Pack:
    record = read_json(folder / "pack.json")
    return Pack(
        keys=np.array(record["keys"]),
        places=np.array(record["places"]),
        arrays={name: np.load(folder / f"{name}.npy", mmap_mode="r") for name in record["arrays"]},
        digest=folder.name,
    )


def _check_size(picture: NDArray[np.uint8], size: int) -> None:
    if picture.shape[0] < size:
        raise UsageError(
            f"The pictures are {picture.shape[0]} pixels wide, less than input_px = {size}. Render "
            "larger ones (--rig.width-px), or choose a smaller size."
        )


def _parts(
    source: StereoDataset, number: int, mask: NDArray[np.uint8], size: int
) -> NDArray[np.uint8]:
    """The number of the material from 1 on the object, 0 beside it, (size, size)."""
    part = (mask >= 128).astype(np.uint8)
    if "left_material.png" in source.names(number):
        part = part * np.maximum(source.decoded(number, "left_material.png"), 1)
    return np.asarray(cv2.resize(part, (size, size), interpolation=cv2.INTER_NEAREST), np.uint8)


def _reflectance(source: StereoDataset, number: int) -> NDArray[np.float32]:
    """The reflectance map of the sample's first material."""
    names = source.names(number)
    name = "reflectance.exr" if "reflectance.exr" in names else "reflectance_1.exr"
    return np.asarray(source.decoded(number, name), np.float32)
