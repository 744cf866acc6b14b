"""A look-alike of the Mapillary API v4: requests in, replies out.

Written from the documentation and from error bodies that were measured: a missing token is a
500 and an unknown picture a 400, only the named fields are returned, a box must be smaller
than 0.01 degrees, dense ones are refused with a 500, large ones are answered thinned out, and
the addresses of pictures are signed and expire.
"""

import hashlib
import math
import time
from datetime import UTC, datetime
from typing import Any

import cv2
import numpy as np

from panokit.synthetic.exchange import Reply, Request, jpeg_reply, json_reply
from panokit.synthetic.faults import Faults
from panokit.synthetic.pictures import PictureStore, ServedPicture

STORAGE_PATH = "/m1/v/t6/"
_LARGEST_BOX_DEG = 0.01
_THINNED_BOX_DEG = 0.005
_MOST_IMAGES = 2000
_LARGEST_RADIUS_M = 50.0
_THUMB_WIDTHS_PX = {"thumb_256_url": 256, "thumb_1024_url": 1024, "thumb_2048_url": 2048}
_SIGNING_KEY = "look-alike"
# World: x east, y up, z south -> east, north, up; camera: x right, y up, z back -> right, down,
# forward.
_ENU_FROM_WORLD = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float64)
_IMAGE_FROM_CAMERA = np.diag([1.0, -1.0, -1.0])


class Mapillary:
    """The service at /images and /ID, and the storage that its signed addresses lead to."""

    def __init__(self, store: PictureStore, token: str, storage_url: str) -> None:
        self._store = store
        self._token = token
        self._storage_url = storage_url

    def answer(self, request: Request, faults: Faults) -> Reply:
        """The reply to /images or to /ID."""
        refusal = self._refuse_token(request)
        if refusal is not None:
            return refusal
        name = request.path.strip("/")
        if name == "images":
            return self._search(request, faults)
        picture = self._store.get(name)
        if picture is None or name in faults.retired:
            return _unknown(name)
        return json_reply(self._fields(picture, request, faults))

    def answer_storage(self, request: Request, faults: Faults) -> Reply:
        """The reply of the second host to a signed address."""
        name, _, size = request.path.removeprefix(STORAGE_PATH).removesuffix(".jpg").rpartition("/")
        expiry = request.query.get("oe", "")
        if request.query.get("oh") != _signature(request.path, expiry):
            return _text("Bad URL hash", 403)
        if time.time() >= int(expiry, 16):
            return _text("URL signature expired", 403)
        picture = self._store.get(name)
        if picture is None or name in faults.retired:
            return _text("Content not found", 404)
        width_px = picture.size_px[0] if size == "original" else int(size)
        height_px = round(width_px * picture.size_px[1] / picture.size_px[0])
        return jpeg_reply(self._store.whole_jpeg(picture, width_px, height_px))

    def _refuse_token(self, request: Request) -> Reply | None:
        header = request.headers.get("authorization", "")
        token = header.removeprefix("OAuth ") or request.query.get("access_token", "")
        if not token:
            # Not a 401: the real service answers so.
            return _error(500, "Invalid OAuth 2.0 Access Token", "MLYApiException", 190)
        if not token.startswith("MLY|"):
            return _error(401, "Failed to decode", "OAuthException", 190)
        if token != self._token:
            status = 401 if header else 400
            return _error(status, "Error validating application", "OAuthException", 190)
        return None

    def _search(self, request: Request, faults: Faults) -> Reply:
        query = request.query
        limit = int(query.get("limit", _MOST_IMAGES)) if _is_whole(query, "limit") else 0
        if not 1 <= limit <= _MOST_IMAGES:
            return _invalid(f"Param limit must be between 1 and {_MOST_IMAGES}")
        found = [picture for picture in self._store if picture.capture.id not in faults.retired]
        if "bbox" in query:
            box = _box(query["bbox"])
            if box is None:
                return _invalid("Param bbox must be west,south,east,north")
            side_deg = max(box[2] - box[0], box[3] - box[1])
            if side_deg >= _LARGEST_BOX_DEG:
                return _invalid(f"Param bbox must be smaller than {_LARGEST_BOX_DEG} degrees")
            found = [picture for picture in found if _is_inside(picture, box)]
            if faults.dense_box is not None and len(found) > faults.dense_box:
                message = (
                    "Please reduce the amount of data you're asking for, then retry your request"
                )
                return json_reply({"error": {"code": 1, "message": message}}, 500)
            if faults.thinned and side_deg >= _THINNED_BOX_DEG:
                found = found[::2]
        elif "lat" in query and "lng" in query:
            radius_m = float(query.get("radius", _LARGEST_RADIUS_M))
            if radius_m > _LARGEST_RADIUS_M:
                return _invalid(f"Param radius must be at most {_LARGEST_RADIUS_M:.0f}")
            here = float(query["lat"]), float(query["lng"])
            found = [picture for picture in found if picture.distance_m(*here) <= radius_m]
        found = [picture for picture in found if _is_in_time(picture, query)]
        if query.get("is_pano") == "false":
            found = []
        return json_reply({"data": [self._fields(one, request, faults) for one in found[:limit]]})

    def _fields(self, picture: ServedPicture, request: Request, faults: Faults) -> dict[str, Any]:
        """The fields that were asked for; those that are not known are absent."""
        known = self._description(picture, faults)
        asked = set(request.query.get("fields", "").split(","))
        return {name: value for name, value in known.items() if name in asked | {"id"}}

    def _description(self, picture: ServedPicture, faults: Faults) -> dict[str, Any]:
        capture = picture.capture
        latitude_deg, longitude_deg = picture.position_deg
        point = {"type": "Point", "coordinates": [longitude_deg, latitude_deg]}
        known: dict[str, Any] = {
            "id": capture.id,
            "geometry": point,
            "captured_at": capture.time and round(capture.time.timestamp() * 1000),
            "camera_type": "spherical",
            "is_pano": True,
            "width": picture.size_px[0],
            "height": picture.size_px[1],
            "sequence": picture.sequence,
            "creator": {"username": capture.license.attribution or "somebody", "id": "1"},
            **{
                name: self._address(picture, str(width), faults)
                for name, width in _THUMB_WIDTHS_PX.items()
            },
        }
        if not faults.sparse_metadata:
            known |= {
                "thumb_original_url": self._address(picture, "original", faults),
                "computed_geometry": point,
                "compass_angle": capture.heading_deg,
                "computed_compass_angle": capture.heading_deg,
                "computed_rotation": _axis_angle(picture),
                "altitude": capture.elevation_m,
                "computed_altitude": capture.elevation_m,
                "exif_orientation": 1,
                "make": "panokit",
                "model": "look-alike",
            }
        return {name: value for name, value in known.items() if value is not None}

    def _address(self, picture: ServedPicture, size: str, faults: Faults) -> str:
        path = f"{STORAGE_PATH}{picture.capture.id}/{size}.jpg"
        expiry = f"{math.ceil(time.time() + faults.url_lifetime_s):X}"
        return (
            f"{self._storage_url}{path}?ccb=10-5&oh={_signature(path, expiry)}&oe={expiry}"
            "&_nc_sid=201bca"
        )


def _axis_angle(picture: ServedPicture) -> list[float] | None:
    """`computed_rotation`: from east-north-up to right-down-forward, as axis times angle."""
    pose = picture.capture.world_from_camera
    if pose is None:
        return None
    matrix = _IMAGE_FROM_CAMERA @ pose.matrix.T @ _ENU_FROM_WORLD.T
    return [float(value) for value in cv2.Rodrigues(matrix)[0].ravel()]


def _signature(path: str, expiry: str) -> str:
    return hashlib.sha256(f"{_SIGNING_KEY} {path} {expiry}".encode()).hexdigest()[:32]


def _box(text: str) -> tuple[float, float, float, float] | None:
    try:
        west, south, east, north = (float(part) for part in text.split(","))
    except ValueError:
        return None
    return (west, south, east, north) if west <= east and south <= north else None


def _is_inside(picture: ServedPicture, box: tuple[float, float, float, float]) -> bool:
    latitude_deg, longitude_deg = picture.position_deg
    return box[1] <= latitude_deg <= box[3] and box[0] <= longitude_deg <= box[2]


def _is_in_time(picture: ServedPicture, query: Any) -> bool:
    moment = picture.capture.time
    bounds = [query.get(name) for name in ("start_captured_at", "end_captured_at")]
    if not any(bounds):
        return True
    if moment is None:
        return False
    start, end = (_aware(datetime.fromisoformat(text)) if text else moment for text in bounds)
    return start <= moment <= end


def _aware(moment: datetime) -> datetime:
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)


def _is_whole(query: Any, name: str) -> bool:
    return str(query.get(name, "1")).isdecimal()


def _unknown(name: str) -> Reply:
    message = (
        f"Unsupported get request. Object with ID '{name}' does not exist, cannot be loaded due "
        "to missing permissions, or does not support this operation"
    )
    return _error(400, message, "MLYApiException", 100, error_subcode=33)


def _invalid(message: str) -> Reply:
    return _error(400, message, "MLYApiException", 100)


def _error(status: int, message: str, kind: str, code: int, **more: Any) -> Reply:
    error = {"message": message, "type": kind, "code": code, **more, "fbtrace_id": "look-alike"}
    return json_reply({"error": error}, status)


def _text(message: str, status: int) -> Reply:
    return Reply(status=status, body=message.encode(), content_type="text/plain")
