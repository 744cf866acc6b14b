"""A look-alike of Poly Haven's public API for HDR maps: requests in, replies out.

The maps are made of the served pictures, whose brightest parts are made brighter than a
picture can show: good for trying out downloads, not for judging light.
"""

import hashlib
import tempfile
import threading
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from panokit.color import srgb_decode_u8
from panokit.io.exr import write_exr
from panokit.io.radiance import write_radiance
from panokit.synthetic.exchange import Reply, Request, json_reply
from panokit.synthetic.faults import Faults
from panokit.synthetic.pictures import PictureStore, ServedPicture

STORAGE_PATH = "/file/ph-assets/HDRIs/"
RESOLUTIONS_PX = {"1k": 1024, "2k": 2048}
_WRITERS = {"exr": write_exr, "hdr": write_radiance}
_CONTENT_TYPES = {"exr": "image/x-exr", "hdr": "image/vnd.radiance"}
_CLIPPED, _CLIPPED_GAIN = 0.9, 30.0


class PolyHaven:
    """The service at /assets, /info/ID and /files/ID, and the host of its files."""

    def __init__(self, store: PictureStore, storage_url: str) -> None:
        self._store = store
        self._storage_url = storage_url
        self._made: dict[tuple[str, str, str], bytes] = {}
        self._lock = threading.Lock()

    def answer(self, request: Request, faults: Faults) -> Reply:
        """The reply to /types, /assets, /info/ID or /files/ID."""
        match request.path.strip("/").split("/"):
            case ["types"]:
                return json_reply(["hdris", "textures", "models"])
            case ["assets"]:
                kind = request.query.get("t", request.query.get("type", "all"))
                served = self._store if kind in ("hdris", "all") else ()
                wanted = set(filter(None, request.query.get("categories", "").split(",")))
                found = {one.capture.id: _info(one) for one in served}
                return json_reply(
                    {id: info for id, info in found.items() if wanted <= set(info["categories"])}
                )
            case ["info", name]:
                picture = self._picture(name, faults)
                return _unknown(name) if picture is None else json_reply(_info(picture))
            case ["files", name]:
                picture = self._picture(name, faults)
                return _unknown(name) if picture is None else json_reply(self._files(picture))
        return Reply(status=404, body=b"Not found", content_type="text/plain")

    def answer_storage(self, request: Request, faults: Faults) -> Reply:
        """The reply of the second host: a map."""
        suffix, _, rest = request.path.removeprefix(STORAGE_PATH).partition("/")
        resolution, _, file = rest.partition("/")
        picture = self._picture(file.removesuffix(f"_{resolution}.{suffix}"), faults)
        if picture is None or suffix not in _WRITERS or resolution not in RESOLUTIONS_PX:
            return Reply(status=404, body=b"Not found", content_type="text/plain")
        body = self._file(picture, resolution, suffix)
        return Reply(body=body, content_type=_CONTENT_TYPES[suffix])

    def _picture(self, name: str, faults: Faults) -> ServedPicture | None:
        return None if name in faults.retired else self._store.get(name)

    def _files(self, picture: ServedPicture) -> dict[str, Any]:
        return {
            "hdri": {
                resolution: {
                    suffix: self._entry(picture, resolution, suffix) for suffix in _WRITERS
                }
                for resolution in RESOLUTIONS_PX
            }
        }

    def _entry(self, picture: ServedPicture, resolution: str, suffix: str) -> dict[str, Any]:
        body = self._file(picture, resolution, suffix)
        name = f"{picture.capture.id}_{resolution}.{suffix}"
        return {
            "size": len(body),
            "md5": hashlib.md5(body, usedforsecurity=False).hexdigest(),
            "url": f"{self._storage_url}{STORAGE_PATH}{suffix}/{resolution}/{name}",
        }

    def _file(self, picture: ServedPicture, resolution: str, suffix: str) -> bytes:
        # Captures that show one image have one file; a service of hundreds is made of a few.
        key = (str(picture.image), resolution, suffix)
        with self._lock:
            if key not in self._made:
                self._made[key] = self._make(picture, RESOLUTIONS_PX[resolution], suffix)
            return self._made[key]

    def _make(self, picture: ServedPicture, width_px: int, suffix: str) -> bytes:
        pixels = self._store.pixels(picture, width_px)
        linear = srgb_decode_u8(pixels)
        linear = np.where(linear > _CLIPPED, linear * _CLIPPED_GAIN, linear).astype(np.float32)
        size = width_px, width_px // 2
        if linear.shape[1] != width_px:
            linear = np.asarray(cv2.resize(linear, size, interpolation=cv2.INTER_LINEAR))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"map.{suffix}"
            _WRITERS[suffix](path, linear)
            return path.read_bytes()


def _info(picture: ServedPicture) -> dict[str, Any]:
    capture = picture.capture
    largest_px = max(RESOLUTIONS_PX.values())
    known: dict[str, Any] = {
        "name": capture.id.replace("-", " ").replace("_", " ").title(),
        "type": 0,
        "authors": {capture.license.attribution or "somebody": "All"},
        "categories": list(capture.details.get("categories") or ("outdoor", "urban")),
        "tags": list(capture.details.get("tags") or ("street", "look-alike")),
        "download_count": capture.details.get("download_count"),
        "max_resolution": [largest_px, largest_px // 2],
        "coords": list(picture.position_deg),
        "date_taken": capture.time and round(capture.time.timestamp()),
        "date_published": capture.details.get("date_published")
        or (capture.time and round(capture.time.timestamp())),
        "evs_cap": 12,
        "whitebalance": 5500,
    }
    return {name: value for name, value in known.items() if value is not None}


def _unknown(name: str) -> Reply:
    return Reply(status=404, body=f"No asset with id {name}".encode(), content_type="text/plain")
