"""A look-alike of the Google Map Tiles API for Street View: requests in, replies out.

Written from the public documentation and from replies seen in the wild: string expiry times,
"" for places without a picture, roll in [0, 360), a tilt of 90 for a level camera, sizes that
are not powers of two, and edge tiles padded with black.
"""

import math
import threading
import time
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.io.images import encode_jpeg
from panokit.synthetic.exchange import Reply, Request, jpeg_reply, json_reply
from panokit.synthetic.faults import Faults
from panokit.synthetic.google_errors import error, invalid, not_found, too_many
from panokit.synthetic.pictures import PictureStore, RecentBodies, ServedPicture
from panokit.synthetic.quota import QuotaCounter
from panokit.synthetic.views import view_of

TILE_PX = 512
HIGHEST_ZOOM = 5
_MOST_LOCATIONS = 100
_LINK_RADIUS_M = 60.0


def highest_zoom(width_px: int) -> int:
    """The zoom at which a panorama has its full size."""
    return max(0, math.ceil(math.log2(width_px / TILE_PX)))


def size_at_zoom(size_px: tuple[int, int], zoom: int) -> tuple[int, int]:
    """Width and height of a panorama at a zoom, `ceil(full / 2^(zmax - z))`."""
    shrink = 2 ** (highest_zoom(size_px[0]) - zoom)
    return math.ceil(size_px[0] / shrink), math.ceil(size_px[1] / shrink)


class GoogleTiles:
    """The service under /v1: sessions, panoIds, metadata and tiles."""

    def __init__(self, store: PictureStore, key: str) -> None:
        self._store = store
        self._key = key
        self._sessions: dict[str, float] = {}
        self._uses: Counter[str] = Counter()
        self._quota = QuotaCounter()
        self._bodies = RecentBodies()
        self._lock = threading.Lock()

    def answer(self, request: Request, faults: Faults) -> Reply:
        """The reply to any request whose path starts with /v1/."""
        refusal = self._refuse_key(request, faults)
        if refusal is not None:
            return refusal
        if request.path == "/v1/createSession":
            return self._create_session(request, faults)
        refusal = self._refuse_session(request, faults)
        if refusal is not None:
            return refusal
        if request.path == "/v1/streetview/metadata":
            return self._metadata(request, faults)  # free of any quota
        exceeded = self._quota.spend(faults.quota_per_minute, faults.quota_per_day)
        if exceeded is not None:
            return too_many(exceeded.period, exceeded.retry_after_s)
        if request.path == "/v1/streetview/panoIds":
            return self._pano_ids(request)
        if request.path == "/v1/streetview/thumbnail":
            return self._thumbnail(request, faults)
        if request.path.startswith("/v1/streetview/tiles/"):
            return self._tile(request, faults)
        return error(404, "Requested entity was not found.", "NOT_FOUND")

    def _refuse_key(self, request: Request, faults: Faults) -> Reply | None:
        key = request.query.get("key")
        if not key:
            return error(
                403,
                "Method doesn't allow unregistered callers. Please use API Key or other form "
                "of API consumer identity to call this API.",
                "PERMISSION_DENIED",
            )
        if key != self._key:
            # A wrong key arrives as 400, not as 401 or 403.
            message = "API key not valid. Please pass a valid API key."
            return error(400, message, "INVALID_ARGUMENT", "API_KEY_INVALID")
        if faults.api_disabled:
            message = (
                "Map Tiles API has not been used in project 123456789012 before or it is "
                "disabled. Enable it in the console, then retry."
            )
            return error(403, message, "PERMISSION_DENIED", "SERVICE_DISABLED")
        return None

    def _create_session(self, request: Request, faults: Faults) -> Reply:
        asked = request.json()
        if request.method != "POST" or not isinstance(asked, dict):
            return invalid("Invalid JSON payload received.")
        if asked.get("mapType") != "streetview":
            return invalid(f"Invalid value at 'map_type': {asked.get('mapType')!r}.")
        expiry = time.time() + faults.session_lifetime_s
        with self._lock:
            token = f"lookalike-session-{len(self._sessions) + 1}"
            self._sessions[token] = expiry
        return json_reply(
            {
                "session": token,
                "expiry": str(int(expiry)),
                "tileWidth": TILE_PX,
                "tileHeight": TILE_PX,
                "imageFormat": "jpeg",
            }
        )

    def _refuse_session(self, request: Request, faults: Faults) -> Reply | None:
        token = request.query.get("session", "")
        with self._lock:
            expiry = self._sessions.get(token)
            self._uses[token] += 1
            is_used_up = faults.session_uses is not None and self._uses[token] > faults.session_uses
        if expiry is None:
            return invalid("The session token is missing or not valid.")
        if time.time() >= expiry or is_used_up:
            return invalid("The session token has expired.")
        return None

    def _pano_ids(self, request: Request) -> Reply:
        asked = request.json()
        if request.method != "POST" or not isinstance(asked, dict):
            return invalid("Invalid JSON payload received.")
        locations = asked.get("locations") or []
        if not 1 <= len(locations) <= _MOST_LOCATIONS:
            return invalid(f"Between 1 and {_MOST_LOCATIONS} locations are allowed.")
        radius_m = float(asked.get("radius", 50))
        found = [
            self._store.nearest(float(place["lat"]), float(place["lng"]), radius_m)
            for place in locations
        ]
        return json_reply({"panoIds": [near.capture.id if near else "" for near in found]})

    def _metadata(self, request: Request, faults: Faults) -> Reply:
        query = request.query
        try:
            picture = (
                self._store.get(query["panoId"])
                if "panoId" in query
                else self._store.nearest(
                    float(query["lat"]), float(query["lng"]), float(query.get("radius", 50))
                )
            )
        except (KeyError, ValueError):
            return invalid("Specify either a panoId or a lat and a lng.")
        if picture is None or picture.capture.id in faults.retired:
            return not_found()
        return json_reply(self._description(picture, sparse=faults.sparse_metadata))

    def _description(self, picture: ServedPicture, *, sparse: bool) -> dict[str, Any]:
        capture = picture.capture
        latitude_deg, longitude_deg = picture.position_deg
        known: dict[str, Any] = {
            "panoId": capture.id,
            "lat": latitude_deg,
            "lng": longitude_deg,
            "imageHeight": picture.size_px[1],
            "imageWidth": picture.size_px[0],
            "tileHeight": TILE_PX,
            "tileWidth": TILE_PX,
        }
        if sparse:
            return known
        optional = {
            "copyright": capture.license.attribution or None,
            "date": capture.time and capture.time.strftime("%Y-%m"),
            "imageryType": "outdoor",
            "heading": capture.heading_deg,
            "tilt": None if capture.pitch_deg is None else 90 + capture.pitch_deg,
            "roll": None if capture.roll_deg is None else capture.roll_deg % 360,
            "originalLat": latitude_deg,
            "originalLng": longitude_deg,
            "originalElevationAboveEgm96": capture.elevation_m,
            "links": self._links(picture),
        }
        return known | {name: value for name, value in optional.items() if value is not None}

    def _links(self, picture: ServedPicture) -> list[dict[str, Any]]:
        here = np.radians(picture.position_deg)
        links = []
        for other in self._store.around(*picture.position_deg, _LINK_RADIUS_M):
            if other is picture:
                continue
            north, east = np.radians(other.position_deg) - here
            heading_deg = math.degrees(math.atan2(east * math.cos(here[0]), north)) % 360
            links.append({"panoId": other.capture.id, "heading": round(heading_deg, 5)})
        return links

    def _thumbnail(self, request: Request, faults: Faults) -> Reply:
        query = request.query
        picture = self._store.get(query.get("panoId", ""))
        if picture is None or picture.capture.id in faults.retired:
            return not_found()
        try:
            width_px, height_px = int(query["width"]), int(query["height"])
            heading_deg = float(query.get("yaw", query.get("heading", 0)))
            pitch_deg, fov_deg = float(query.get("pitch", 0)), float(query.get("fov", 120))
        except (KeyError, ValueError):
            return invalid("A thumbnail needs width and height.")
        if not (16 <= width_px <= 600 and 16 <= height_px <= 250 and 0 < fov_deg < 180):
            return invalid("A thumbnail is 16x16 to 600x250 px.")
        view = view_of(
            self._store,
            picture,
            (width_px, height_px),
            heading_deg=heading_deg,
            pitch_deg=pitch_deg,
            fov_deg=fov_deg,
        )
        return jpeg_reply(encode_jpeg(view, quality=90))

    def _tile(self, request: Request, faults: Faults) -> Reply:
        try:
            zoom, column, row = (int(part) for part in request.path.split("/")[4:])
        except ValueError:
            return invalid("A tile is named by three whole numbers, z/x/y.")
        if not 0 <= zoom <= HIGHEST_ZOOM:
            return invalid(f"Zoom must be between 0 and {HIGHEST_ZOOM}.")
        picture = self._store.get(request.query.get("panoId", ""))
        if picture is None or picture.capture.id in faults.retired:
            return not_found()
        if (zoom, column, row) in faults.missing_tiles:
            return not_found()
        state = (
            faults.out_of_range,
            faults.edge_tiles,
            faults.tile_body_px,
            (zoom, column, row) in faults.black_tiles,
        )
        key = (picture.capture.id, zoom, column, row, *state)
        body = self._bodies.get(key)
        if body is None:
            body = self._encoded_tile(picture, (zoom, column, row), faults)
            self._bodies.put(key, body)
        return jpeg_reply(body) if body else not_found()

    def _encoded_tile(
        self, picture: ServedPicture, cell: tuple[int, int, int], faults: Faults
    ) -> bytes:
        """The JPEG of a tile, b"" where there is none."""
        pixels = self._tile_pixels(picture, *cell)
        if pixels is None and faults.out_of_range == "not-found":
            return b""
        if pixels is None or cell in faults.black_tiles:
            pixels = np.zeros((0, 0, 3), np.uint8)
        if faults.edge_tiles == "padded" or not pixels.size:
            pixels = _padded(pixels)
        step = TILE_PX // faults.tile_body_px
        return encode_jpeg(np.ascontiguousarray(pixels[::step, ::step]), quality=90)

    def _tile_pixels(
        self, picture: ServedPicture, zoom: int, column: int, row: int
    ) -> NDArray[np.uint8] | None:
        """The part of a tile that lies in the picture, or None where nothing does."""
        if zoom > highest_zoom(picture.size_px[0]):
            return None
        width_px, height_px = size_at_zoom(picture.size_px, zoom)
        left, top = column * TILE_PX, row * TILE_PX
        if not (0 <= left < width_px and 0 <= top < height_px):
            return None
        box = (left, top, min(left + TILE_PX, width_px), min(top + TILE_PX, height_px))
        return self._store.piece(picture, (width_px, height_px), box)


def _padded(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    tile = np.zeros((TILE_PX, TILE_PX, 3), np.uint8)
    tile[: pixels.shape[0], : pixels.shape[1]] = pixels
    return tile
