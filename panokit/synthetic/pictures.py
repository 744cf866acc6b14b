"""The pictures that the look-alike services serve, at any size and in any piece."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.errors import UsageError
from panokit.io.images import decode_image, encode_jpeg

_EARTH_RADIUS_M = 6371008.8
_JPEG_QUALITY = 90


@dataclass(frozen=True, slots=True, kw_only=True)
class ServedPicture:
    """One picture to serve.

    Attributes:
        capture: What the services say of it. Needs latitude, longitude, width and height; the
            pixels are in the camera's frame where pitch and roll are given.
        image: An equirectangular JPEG, PNG, ...; it need not have the size that `capture`
            declares, the services resize what is asked for.
        sequence: The Panoramax collection it belongs to.
    """

    capture: Capture
    image: Path
    sequence: str = "panokit-pictures"

    def __post_init__(self) -> None:
        for name in ("latitude_deg", "longitude_deg", "width_px", "height_px"):
            if getattr(self.capture, name) is None:
                raise UsageError(
                    f"Picture {self.capture.id!r} cannot be served without {name}; "
                    "say it in its sidecar."
                )

    @property
    def size_px(self) -> tuple[int, int]:
        """Declared width and height."""
        return int(self.capture.width_px or 0), int(self.capture.height_px or 0)

    @property
    def position_deg(self) -> tuple[float, float]:
        """Latitude and longitude."""
        return float(self.capture.latitude_deg or 0), float(self.capture.longitude_deg or 0)

    def distance_m(self, latitude_deg: float, longitude_deg: float) -> float:
        """Great-circle distance to a place (haversine)."""
        here = np.radians(self.position_deg)
        there = np.radians([latitude_deg, longitude_deg])
        half = np.sin((there - here) / 2) ** 2
        chord = half[0] + np.cos(here[0]) * np.cos(there[0]) * half[1]
        return float(2 * _EARTH_RADIUS_M * np.arcsin(np.sqrt(min(1.0, chord))))


class PictureStore:
    """Pictures by id, and pieces of them as JPEG; decoded pixels are kept within a budget.

    A piece that is larger than the file's own pixels is interpolated for itself alone, so a
    16384x8192 panorama can be served from a small file in little memory.
    """

    def __init__(self, pictures: Sequence[ServedPicture], budget_bytes: int = 256 << 20) -> None:
        self._pictures = {picture.capture.id: picture for picture in pictures}
        if len(self._pictures) != len(pictures):
            raise UsageError("Two pictures to serve have the same id; ids must differ.")
        self._in_order = list(pictures)
        places = [picture.position_deg for picture in pictures]
        self._places = np.radians(np.array(places, np.float64).reshape(-1, 2))
        self._levels = _RecentArrays(budget_bytes)

    def __iter__(self) -> Any:
        return iter(self._pictures.values())

    def get(self, picture_id: str) -> ServedPicture | None:
        """The picture with this id, or None."""
        return self._pictures.get(picture_id)

    def nearest(
        self, latitude_deg: float, longitude_deg: float, radius_m: float
    ) -> ServedPicture | None:
        """The nearest picture within a radius, or None."""
        distances_m = self._distances_m(latitude_deg, longitude_deg)
        if not len(distances_m):
            return None
        index = int(np.argmin(distances_m))
        return self._in_order[index] if distances_m[index] <= radius_m else None

    def around(
        self, latitude_deg: float, longitude_deg: float, radius_m: float
    ) -> list[ServedPicture]:
        """All pictures within a radius."""
        within = self._distances_m(latitude_deg, longitude_deg) <= radius_m
        return [self._in_order[index] for index in np.flatnonzero(within)]

    def _distances_m(self, latitude_deg: float, longitude_deg: float) -> NDArray[np.float64]:
        there = np.radians([latitude_deg, longitude_deg])
        half = np.sin((self._places - there) / 2) ** 2
        chord = half[:, 0] + np.cos(self._places[:, 0]) * np.cos(there[0]) * half[:, 1]
        return np.asarray(2 * _EARTH_RADIUS_M * np.arcsin(np.sqrt(np.minimum(1.0, chord))))

    def whole_jpeg(self, picture: ServedPicture, width_px: int, height_px: int) -> bytes:
        """The whole picture at a size; the file's own bytes where that is its size."""
        if (width_px, height_px) == picture.size_px and picture.image.suffix.lower() in (
            ".jpg",
            ".jpeg",
        ):
            pixels = self._level(picture, width_px, height_px)
            if pixels.shape[:2] == (height_px, width_px):
                return picture.image.read_bytes()
        box = (0, 0, width_px, height_px)
        return encode_jpeg(self.piece(picture, (width_px, height_px), box), quality=_JPEG_QUALITY)

    def pixels(self, picture: ServedPicture, width_px: int) -> NDArray[np.uint8]:
        """(H, W, 3) uint8 RGB: the picture at this width, or as it is if it has less."""
        height_px = round(width_px * picture.size_px[1] / picture.size_px[0])
        return self._level(picture, width_px, height_px)

    def piece(
        self, picture: ServedPicture, size_px: tuple[int, int], box_px: tuple[int, int, int, int]
    ) -> NDArray[np.uint8]:
        """A rectangle of the picture as it looks at a size.

        Args:
            picture: The picture.
            size_px: Width and height of the whole picture.
            box_px: Left, top, right and bottom of the rectangle, within that size.

        Returns:
            (bottom - top, right - left, 3) uint8 RGB.
        """
        pixels = self._level(picture, *size_px)
        left, top, right, bottom = box_px
        if pixels.shape[:2] == (size_px[1], size_px[0]):
            return pixels[top:bottom, left:right]
        if box_px == (0, 0, *size_px):
            # The same values as below, without two coordinates for each of its pixels.
            return np.asarray(cv2.resize(pixels, size_px, interpolation=cv2.INTER_LINEAR))
        scale_x, scale_y = pixels.shape[1] / size_px[0], pixels.shape[0] / size_px[1]
        columns = (np.arange(left, right) + 0.5) * scale_x - 0.5
        rows = np.clip((np.arange(top, bottom) + 0.5) * scale_y - 0.5, 0, pixels.shape[0] - 1)
        grid_x, grid_y = np.meshgrid(columns.astype(np.float32), rows.astype(np.float32))
        return np.asarray(
            cv2.remap(pixels, grid_x, grid_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        )

    def _level(self, picture: ServedPicture, width_px: int, height_px: int) -> NDArray[np.uint8]:
        """The picture averaged down to a size, or as it is where it has fewer pixels."""

        def decode() -> NDArray[np.uint8]:
            return decode_image(picture.image.read_bytes(), what=picture.image.name)

        own = self._levels.get((picture.capture.id,), decode)
        if own.shape[1] <= width_px:
            return own

        def shrink() -> NDArray[np.uint8]:
            size = (width_px, height_px)
            return np.asarray(cv2.resize(own, size, interpolation=cv2.INTER_AREA))

        return self._levels.get((picture.capture.id, width_px), shrink)


class _RecentArrays:
    """The arrays used last, as many as fit a budget; the newest is kept even if it does not."""

    def __init__(self, budget_bytes: int) -> None:
        self._budget_bytes = budget_bytes
        self._arrays: OrderedDict[tuple[object, ...], NDArray[np.uint8]] = OrderedDict()
        self._lock = threading.RLock()

    def get(
        self, key: tuple[object, ...], make: Callable[[], NDArray[np.uint8]]
    ) -> NDArray[np.uint8]:
        # Making under the lock means that many requests for one picture decode it once.
        with self._lock:
            if key not in self._arrays:
                self._arrays[key] = make()
                self._drop_oldest()
            self._arrays.move_to_end(key)
            return self._arrays[key]

    def _drop_oldest(self) -> None:
        total = sum(array.nbytes for array in self._arrays.values())
        while total > self._budget_bytes and len(self._arrays) > 1:
            _, dropped = self._arrays.popitem(last=False)
            total -= dropped.nbytes


class RecentBodies:
    """The encoded pictures used last, as many as fit a budget; threads may share it."""

    def __init__(self, budget_bytes: int = 64 << 20) -> None:
        self._left_bytes = budget_bytes
        self._bodies: OrderedDict[Hashable, bytes] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, key: Hashable) -> bytes | None:
        """What was put there, or None."""
        with self._lock:
            if key in self._bodies:
                self._bodies.move_to_end(key)
            return self._bodies.get(key)

    def put(self, key: Hashable, body: bytes) -> None:
        """Keep a body, in place of the oldest ones if need be."""
        with self._lock:
            self._left_bytes += len(self._bodies.pop(key, b"")) - len(body)
            self._bodies[key] = body
            while self._left_bytes < 0 and len(self._bodies) > 1:
                self._left_bytes += len(self._bodies.popitem(last=False)[1])
