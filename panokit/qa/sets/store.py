"""What is known of each map of a set, kept by the content of its file.

Describing a map takes longer than comparing it with a thousand others, so descriptions are kept in
one JSON-lines file beside the report: a second run reads them instead of the maps.
"""

import base64
import binascii
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.io import read_environment_map, write_bytes
from panokit.io.files import read_bytes, sha256_of_file
from panokit.qa.sets.classes import LightClass, light_class
from panokit.qa.sets.descriptors import DESCRIPTORS, describe
from panokit.qa.sets.measured import Measured, measure
from panokit.sphere import (
    harmonics_degrees,
    project_harmonics,
    resize_radiance,
    row_solid_angles,
)
from panokit.sphere.extension import pad_sphere

VERSION = "1"
STORE_NAME = "descriptions.jsonl"
THUMBNAIL_WIDTH_PX = 64
SIGNATURE_ORDER = 8
DETAIL_WIDTH_PX = 128
_LEAST_STOPS = 14.0
_DETAIL_UNIT = 127
# What is coarser than this, 7 degrees, is light and not detail.
_DETAIL_SIGMA_PX = 2.5
_DETAIL_PAD_PX = 12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Description:
    """What one map's light is like.

    Attributes:
        digest: SHA-256 of its file.
        values: The figures of `DESCRIPTORS`.
        light_class: The kind of light.
        power: (17,) float64, luminance power by degree of harmonics.
        signature: (44,) float64, amplitudes of the stops in each degree 1 to 8 and each
            |order|: the same for any yaw, exposure and mirror image.
        thumbnail: (32, 64) float32, luminance in stops; its mean over the sphere is 0.
        detail: (64, 128) float32, fine detail in stops, -1 to 1, without what is the same all
            around: two maps share it only if they show the same things.
    """

    digest: str
    values: Mapping[str, float | None]
    light_class: LightClass
    power: NDArray[np.float64]
    signature: NDArray[np.float64]
    thumbnail: NDArray[np.float32]
    detail: NDArray[np.float32]

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dumps`."""
        return {
            "version": VERSION,
            "digest": self.digest,
            "values": dict(self.values),
            "class": str(self.light_class),
            "power": self.power.tolist(),
            "signature": self.signature.tolist(),
            "thumbnail": _text(self.thumbnail.astype("<f2")),
            "detail": _text(np.rint(self.detail * _DETAIL_UNIT).astype(np.int8)),
        }

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> "Description":
        """What `to_json` wrote.

        Raises:
            KeyError, TypeError, ValueError: If it is anything else.
        """
        if record["version"] != VERSION or set(record["values"]) != {d.name for d in DESCRIPTORS}:
            raise ValueError("of another version")
        detail = _numbers(record["detail"], np.dtype(np.int8), DETAIL_WIDTH_PX)
        return cls(
            digest=str(record["digest"]),
            values={d.name: record["values"][d.name] for d in DESCRIPTORS},
            light_class=LightClass(record["class"]),
            power=np.asarray(record["power"], np.float64),
            signature=np.asarray(record["signature"], np.float64),
            thumbnail=_numbers(record["thumbnail"], np.dtype("<f2"), THUMBNAIL_WIDTH_PX),
            detail=detail / np.float32(_DETAIL_UNIT),
        )


class DescriptionStore:
    """Descriptions by the digest of their file.

    Args:
        path: The file; None keeps them in memory only. A damaged line is as good as none.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path
        self._kept: dict[str, Description] = dict(_stored(path)) if path else {}
        self._fresh = False

    def describe(self, map_path: Path) -> Description:
        """The description of a map, from the store if its file is the same.

        Raises:
            ItemError: If the map cannot be read, or is black.
        """
        digest = sha256_of_file(map_path)
        if digest not in self._kept:
            measured = measure(read_environment_map(map_path))
            self._kept[digest] = description_of(measured, digest)
            self._fresh = True
        return self._kept[digest]

    def save(self) -> None:
        """Write the file, if there is one and something new to write.

        Raises:
            StorageError: If it cannot be written.
        """
        if self._path is None or not self._fresh:
            return
        lines = [
            json.dumps(self._kept[digest].to_json(), sort_keys=True, allow_nan=False)
            for digest in sorted(self._kept)
        ]
        write_bytes(self._path, ("\n".join(lines) + "\n").encode())
        self._fresh = False


def description_of(measured: Measured, digest: str = "") -> Description:
    """Everything that sets of maps are compared by, of one map."""
    thumbnail = _thumbnail(measured)
    return Description(
        digest=digest,
        values=describe(measured),
        light_class=light_class(measured),
        power=measured.power,
        signature=_signature(thumbnail),
        thumbnail=thumbnail,
        detail=_detail(measured),
    )


def _thumbnail(measured: Measured) -> NDArray[np.float32]:
    stops, weights = _stops(measured, THUMBNAIL_WIDTH_PX)
    return np.asarray((stops - (stops * weights).sum()).astype("<f2"), np.float32)


def _detail(measured: Measured) -> NDArray[np.float32]:
    stops, _ = _stops(measured, DETAIL_WIDTH_PX)
    padded = pad_sphere(np.ascontiguousarray(stops, np.float32), _DETAIL_PAD_PX)
    inside = slice(_DETAIL_PAD_PX, -_DETAIL_PAD_PX)
    coarse = cv2.GaussianBlur(padded, (0, 0), _DETAIL_SIGMA_PX)[inside, inside]
    fine = np.clip(stops - coarse, -1, 1)
    fine = np.clip(fine - fine.mean(axis=1, keepdims=True), -1, 1)
    return np.asarray(np.rint(fine * _DETAIL_UNIT) / _DETAIL_UNIT, np.float32)


def _stops(measured: Measured, width_px: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Luminance in stops at a small width, and the share of the sphere of its pixels."""
    light = np.asarray(luminance(resize_radiance(measured.envmap.radiance, width_px)), np.float64)
    weights = row_solid_angles(*light.shape)[:, None] / (4 * np.pi)
    floor = float((light * weights).sum()) * 2.0**-_LEAST_STOPS
    return np.log2(np.maximum(light, floor)), weights


def _signature(thumbnail: NDArray[np.float32]) -> NDArray[np.float64]:
    coefficients = project_harmonics(thumbnail[..., None], SIGNATURE_ORDER)[:, 0]
    degrees = harmonics_degrees(SIGNATURE_ORDER)
    orders = np.abs(np.arange(len(degrees)) - degrees * (degrees + 1))
    place = degrees * (SIGNATURE_ORDER + 1) + orders
    power = np.bincount(place, coefficients**2, (SIGNATURE_ORDER + 1) ** 2)
    used = np.unique(place[degrees > 0])
    return np.sqrt(power[used] / (4 * np.pi))


def _text(numbers: NDArray[np.generic]) -> str:
    return base64.b64encode(numbers.tobytes()).decode()


def _numbers(text: str, dtype: np.dtype[Any], width_px: int) -> NDArray[np.float32]:
    stored = np.frombuffer(base64.b64decode(text, validate=True), dtype)
    return stored.reshape(width_px // 2, width_px).astype(np.float32)


def _stored(path: Path) -> Iterator[tuple[str, Description]]:
    if not path.is_file():
        return
    for line in read_bytes(path).splitlines():
        try:
            found = Description.from_json(json.loads(line))
        except (KeyError, TypeError, ValueError, binascii.Error):
            continue
        yield found.digest, found
