"""What is kept of a few samples so that figures can be drawn without dataset or models.

OUT/kept/samples/<key>/left.png, right.png, normals.png, truth.npy
OUT/kept/predictions/<digest>/<key>.npy
"""

import hashlib
import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.evaluate.lighting.sample import StereoSample
from panokit.io.files import read_bytes, write_bytes
from panokit.io.images import decode_image, encode_png

_HALF_MAX = 65504.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KeptSample:
    """What figures show of a sample.

    Attributes:
        key: Of the sample.
        left: (H, W, 3) uint8.
        right: (H, W, 3) uint8.
        normals: (H, W, 3) uint8, (n + 1) / 2, white beside the object.
        truth: (64, 64, 3) float32 radiance, anamorphic.
    """

    key: str
    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    normals: NDArray[np.uint8]
    truth: NDArray[np.float32]


class Kept:
    """The folder of kept samples and predictions.

    Args:
        out: The evaluation's folder.
    """

    def __init__(self, out: Path) -> None:
        self._samples = out / "kept" / "samples"
        self._predictions = out / "kept" / "predictions"

    def add_sample(self, sample: StereoSample) -> None:
        """Keep a sample's pictures and truth, if they are not kept yet; truth comes last."""
        folder = self._samples / sample.key
        if (folder / "truth.npy").is_file():
            return
        views = sample.views
        seen = (views.normals != 0).any(axis=-1, keepdims=True)
        shown = np.where(seen, (views.normals.astype(np.float32) + 1) / 2, 1.0)
        normals = np.rint(255 * np.clip(shown, 0, 1)).astype(np.uint8)
        for name, pixels in (("left", views.left), ("right", views.right), ("normals", normals)):
            write_bytes(folder / f"{name}.png", encode_png(pixels))
        write_bytes(folder / "truth.npy", _packed(sample.truth, np.float32))

    def add_prediction(self, digest: str, key: str, radiance: NDArray[np.float32]) -> None:
        """Keep a predicted map, as half."""
        data = _packed(np.clip(radiance, 0, _HALF_MAX), np.float16)
        write_bytes(self._predictions / _folder(digest) / f"{key}.npy", data)

    def sample_keys(self) -> list[str]:
        """Of the kept samples, in order."""
        return sorted(path.parent.name for path in self._samples.glob("*/truth.npy"))

    def sample(self, key: str) -> KeptSample:
        """A kept sample.

        Raises:
            StorageError: If it is not there.
        """
        folder = self._samples / key
        paths = [folder / f"{name}.png" for name in ("left", "right", "normals")]
        pictures = [decode_image(read_bytes(path), what=str(path)) for path in paths]
        return KeptSample(
            key=key, left=pictures[0], right=pictures[1], normals=pictures[2],
            truth=_unpacked(folder / "truth.npy"),
        )  # fmt: skip

    def prediction(self, digest: str, key: str) -> NDArray[np.float32] | None:
        """(64, 64, 3), or None if it was not kept."""
        path = self._predictions / _folder(digest) / f"{key}.npy"
        return _unpacked(path) if path.is_file() else None

    def predictions(self, digest: str) -> Iterator[tuple[str, NDArray[np.float32]]]:
        """All kept predictions of a model, by key."""
        for key in self.sample_keys():
            found = self.prediction(digest, key)
            if found is not None:
                yield key, found


def _folder(digest: str) -> str:
    """A name for a folder, of any text."""
    return hashlib.sha256(digest.encode()).hexdigest()[:16]


def _packed(values: NDArray[np.floating], kind: type) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.asarray(values, kind), allow_pickle=False)
    return buffer.getvalue()


def _unpacked(path: Path) -> NDArray[np.float32]:
    values = np.load(io.BytesIO(read_bytes(path)), allow_pickle=False)
    return np.asarray(values, np.float32)
