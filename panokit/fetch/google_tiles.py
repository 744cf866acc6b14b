"""Google Street View through the Map Tiles API, with the user's own key and consent.

Google's terms allow showing these pictures, not keeping, analyzing or training with them; the
license written to every record says so. Only the documented service is used.
"""

import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from panokit.capture import Capture, License, TileGrid, TimePrecision, wrap_degrees
from panokit.errors import ImageError, ItemError, LicenseError, NetworkError, Rejection
from panokit.fetch.geodesy import LatLon
from panokit.fetch.google_session import GoogleSession, require_key
from panokit.fetch.jpeg import jpeg_size
from panokit.fetch.places import Place
from panokit.fetch.provider import Found
from panokit.fetch.settings import FetchSettings
from panokit.fetch.zoom import grid_at_zoom, zoom_for_width
from panokit.http import Client, Request

ENDPOINT = "https://tile.googleapis.com"
KEY_VARIABLE = "GOOGLE_MAPS_API_KEY"
TERMS_URL = "https://cloud.google.com/maps-platform/terms"
MAX_LOCATIONS = 100
_SEARCH_RADIUS_M = 50
_BYTES_PER_PIXEL = 0.15


class GoogleTiles:
    """The Map Tiles API. Metadata is free; tiles and id searches count against the quota."""

    files_per_day = 15_000
    may_store = True  # the terms were accepted, else there is no instance

    def __init__(self, settings: FetchSettings, client: Client) -> None:
        require_terms(settings)
        self._endpoint = settings.endpoint or ENDPOINT
        self._settings = settings
        self._session = GoogleSession(
            self._endpoint, require_key(os.environ.get(KEY_VARIABLE)), client
        )
        self._seen: set[str] = set()
        self.usd_per_file = settings.usd_per_1000_tiles / 1000

    def find(self, place: Place | None, points: Sequence[LatLon]) -> Iterator[Found | Rejection]:
        """The panorama nearest to each point, each panorama once."""
        for start in range(0, len(points) if place else 0, MAX_LOCATIONS):
            for panorama_id in self._ids(points[start : start + MAX_LOCATIONS]):
                if panorama_id not in self._seen:
                    self._seen.add(panorama_id)
                    yield self._describe(panorama_id)

    def read(self, found: Found, name: str) -> bytes:
        """One tile: a full one, or one cropped at the picture's edge.

        A tile of lower resolution is asked for once more, as that passes; if it comes again
        it is taken, for `stitch` enlarges it. Whether a black tile is night or a fault only
        its neighbors can tell, which is for `stitch` too.
        """
        grid = found.grid
        if grid is None:
            raise ItemError(f"{found.capture.id} has no tiles.", reason="no-tiles")
        column, row = (int(part) for part in re.findall(r"\d+", name))
        first = self._tile(found, grid, column, row)
        if _is_of_full_resolution(first, grid, column, row):
            return first
        return self._tile(found, grid, column, row)

    def _tile(self, found: Found, grid: TileGrid, column: int, row: int) -> bytes:
        what = f"tile {column}, {row} of {found.capture.id}"
        request = Request(
            url=f"{self._endpoint}/v1/streetview/tiles/{grid.zoom}/{column}/{row}",
            params={"panoId": found.capture.id},
            expect="image",
            check=lambda body: check_tile(body, grid, what),
            cost_usd=self.usd_per_file,
        )
        return self._session.send(request).body

    def _ids(self, points: Sequence[LatLon]) -> list[str]:
        body = {
            "locations": [{"lat": lat, "lng": lng} for lat, lng in points],
            "radius": _SEARCH_RADIUS_M,
        }
        url = f"{self._endpoint}/v1/streetview/panoIds"
        try:
            request = Request(method="POST", url=url, body=body, cost_usd=self.usd_per_file)
            reply = self._session.send(request)
        except ItemError as error:
            raise NetworkError(f"{error} Check the endpoint.") from None
        return parse_ids(reply.body)

    def _describe(self, panorama_id: str) -> Found | Rejection:
        url = f"{self._endpoint}/v1/streetview/metadata"
        try:
            reply = self._session.send(Request(url=url, params={"panoId": panorama_id}))
            return parse_metadata(reply.body, self._settings)
        except ItemError as error:
            return Rejection(
                item=f"google-tiles-{panorama_id}",
                stage="fetch",
                reason="retired" if error.reason in ("not-found", "gone") else error.reason,
                message=str(error),
                values=error.values,
            )


def require_terms(settings: FetchSettings) -> None:
    """Check that the user has accepted Google's terms.

    Raises:
        LicenseError: If not; the message says what they are about.
    """
    if "google" not in settings.accept_terms:
        raise LicenseError(
            "Google's terms do not allow storing Street View pictures, deriving new works from "
            f"them or training with them. Read {TERMS_URL}; if your use is allowed, say so with "
            "--accept-terms google. The source panoramax has open licenses."
        )


def parse_ids(body: bytes) -> list[str]:
    """The ids of a panoIds reply, without the "" of points that have no panorama near."""
    reply = json.loads(body)
    ids = reply.get("panoIds") if isinstance(reply, dict) else None
    return [str(one) for one in ids or () if one]


def parse_metadata(body: bytes, settings: FetchSettings) -> Found:
    """The panorama that a metadata reply describes. Everything but id and size may be absent.

    Raises:
        ItemError: If id or size are absent (reason "bad-metadata").
    """
    reply: Mapping[str, Any] = json.loads(body)
    try:
        size = int(reply["imageWidth"]), int(reply["imageHeight"])
        tile = int(reply.get("tileWidth") or 512), int(reply.get("tileHeight") or 512)
        capture = _capture(reply, size)
        zoom = settings.zoom
        if zoom is None:
            zoom = zoom_for_width(settings.width_px, size[0], tile[0])
        grid = grid_at_zoom(size, tile, zoom)
    except (KeyError, TypeError, ValueError) as error:
        raise ItemError(
            f"The metadata of a panorama is not usable ({error!r}).", reason="bad-metadata"
        ) from None
    pixels = grid.width_px * grid.height_px
    return Found(capture=capture, grid=grid, bytes=int(pixels * _BYTES_PER_PIXEL), raw=dict(reply))


def check_tile(body: bytes, grid: TileGrid, what: str) -> None:
    """Check that a body is a whole JPEG, no larger than a tile.

    Raises:
        ImageError: If not ("not-an-image", "truncated", "wrong-size").
    """
    width, height = jpeg_size(body, what)
    if not (0 < width <= grid.tile_width_px and 0 < height <= grid.tile_height_px):
        raise ImageError(
            f"The {what} is {width}x{height}, larger than a tile. Fetch it again.",
            reason="wrong-size",
            values={"width_px": width, "height_px": height},
        )


def _capture(reply: Mapping[str, Any], size: tuple[int, int]) -> Capture:
    month = _month(reply.get("date"))
    tilt, roll, heading = reply.get("tilt"), reply.get("roll"), reply.get("heading")
    details = {
        "copyright": reply.get("copyright"),
        "imagery_type": reply.get("imageryType"),
        "report_url": reply.get("reportProblemLink"),
    }
    return Capture(
        provider="google-tiles",
        id=str(reply["panoId"]),
        license=License(
            id="google-maps-platform",
            attribution=f"Google Maps, {reply.get('copyright') or '© Google'}",
            url=TERMS_URL,
        ),
        latitude_deg=reply.get("lat"),
        longitude_deg=reply.get("lng"),
        elevation_m=reply.get("originalElevationAboveEgm96"),
        time=month,
        time_precision=TimePrecision.MONTH if month else None,
        heading_deg=None if heading is None else float(heading),
        # Google counts the tilt from straight down; 90 is level.
        pitch_deg=None if tilt is None else float(tilt) - 90.0,
        roll_deg=None if roll is None else wrap_degrees(float(roll)),
        width_px=size[0],
        height_px=size[1],
        source_url=f"https://www.google.com/maps/@?api=1&map_action=pano&pano={reply['panoId']}",
        details={name: value for name, value in details.items() if value},
    )


def _month(text: str | None) -> datetime | None:
    match = re.fullmatch(r"(\d{4})-(\d{2})", text or "")
    return datetime(int(match[1]), int(match[2]), 1, tzinfo=UTC) if match else None


def _is_of_full_resolution(body: bytes, grid: TileGrid, column: int, row: int) -> bool:
    """Whether a tile is as large as its cell, padded or cropped at the edge of the picture."""
    cell = (
        min(grid.tile_width_px, grid.width_px - column * grid.tile_width_px),
        min(grid.tile_height_px, grid.height_px - row * grid.tile_height_px),
    )
    width, height = jpeg_size(body, "tile")
    return width >= cell[0] and height >= cell[1]
