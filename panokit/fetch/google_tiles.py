"""Google Street View through the Map Tiles API, with the user's own key and consent.

Google's terms allow showing these pictures, not keeping, analyzing or training with them; the
license written to every record says so. Only the documented service is used.
"""

import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from panokit.capture import Capture, TileGrid, TimePrecision, capture_key, wrap_degrees
from panokit.errors import ImageError, ItemError, NetworkError, Rejection
from panokit.fetch.geodesy import LatLon
from panokit.fetch.google_session import GoogleSession
from panokit.fetch.google_terms import (
    KEY_VARIABLE,
    google_license,
    map_page,
    month_of_date,
    require_key,
    terms_accepted,
)
from panokit.fetch.jpeg import jpeg_size
from panokit.fetch.places import Place
from panokit.fetch.prices import price_of
from panokit.fetch.provider import Found
from panokit.fetch.settings import FetchSettings
from panokit.fetch.terms import require_consent
from panokit.fetch.where import ids_of
from panokit.fetch.zoom import grid_at_zoom, zoom_for_width
from panokit.http import Client, Request

ENDPOINT = "https://tile.googleapis.com"
MAX_LOCATIONS = 100
_RADII_M = (50.0, 200.0)  # the second for points that have nothing within the first
_BYTES_PER_PIXEL = 0.15
_SMALL_BODIES = 3  # so many of lower resolution in a row are what the service has


class GoogleTiles:
    """The Map Tiles API. Metadata is free; tiles and id searches count against the quota."""

    may_store = True  # the terms were accepted, else there is no instance

    def __init__(self, settings: FetchSettings, client: Client) -> None:
        require_consent("google-tiles", settings.accept_terms)
        self._endpoint = settings.endpoint or ENDPOINT
        self._settings = settings
        key = require_key(os.environ.get(KEY_VARIABLE), "Map Tiles API")
        self._session = GoogleSession(self._endpoint, key, client)
        self._seen: set[str] = set()
        self.usd_per_file = price_of("google-tiles", settings.prices).usd_per_unit

    def find(self, place: Place | None, points: Sequence[LatLon]) -> Iterator[Found | Rejection]:
        """The panorama nearest to each point, each panorama once."""
        if place is None:
            yield from self._describe_new(ids_of(self._settings))
            return
        for start in range(0, len(points), MAX_LOCATIONS):
            yield from self._describe_new(
                self._near(points[start : start + MAX_LOCATIONS], self._radii_m(place))
            )

    def read(self, found: Found, name: str) -> bytes:
        """One tile: a full one, or one cropped at the picture's edge.

        A tile of lower resolution is asked for again, as that passes; if it comes every time
        it is taken, for `stitch` enlarges it.
        """
        grid = found.grid
        if grid is None:
            raise ItemError(f"{found.capture.id} has no tiles.", reason="no-tiles")
        column, row = (int(part) for part in re.findall(r"\d+", name))
        for _ in range(_SMALL_BODIES):
            body = self._tile(found, grid, column, row)
            if _is_of_full_resolution(body, grid, column, row):
                return body
        return body

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

    def _radii_m(self, place: Place) -> tuple[float, ...]:
        if place.points:
            return (place.snap_m,)
        return _RADII_M if self._settings.snap_m is None else (self._settings.snap_m,)

    def _near(self, points: Sequence[LatLon], radii_m: Sequence[float]) -> list[str]:
        """The ids nearest to points, in their order; wider circles for those without any."""
        ids = self._ids(points, radii_m[0])
        without = [index for index, one in enumerate(ids) if not one]
        if without and len(radii_m) > 1:
            wider = self._near([points[index] for index in without], radii_m[1:])
            for index, one in zip(without, wider, strict=True):
                ids[index] = one
        return ids

    def _ids(self, points: Sequence[LatLon], radius_m: float) -> list[str]:
        body = {
            "locations": [{"lat": lat, "lng": lng} for lat, lng in points],
            "radius": round(radius_m),
        }
        url = f"{self._endpoint}/v1/streetview/panoIds"
        try:
            request = Request(method="POST", url=url, body=body, cost_usd=self.usd_per_file)
            reply = self._session.send(request)
        except ItemError as error:
            raise NetworkError(f"{error} Check the endpoint.") from None
        return parse_ids(reply.body, len(points))

    def _describe_new(self, ids: Iterable[str]) -> Iterator[Found | Rejection]:
        for panorama_id in ids:
            if panorama_id and panorama_id not in self._seen:
                self._seen.add(panorama_id)
                yield self._describe(panorama_id)

    def _describe(self, panorama_id: str) -> Found | Rejection:
        url = f"{self._endpoint}/v1/streetview/metadata"
        try:
            reply = self._session.send(Request(url=url, params={"panoId": panorama_id}))
            return parse_metadata(reply.body, self._settings)
        except ItemError as error:
            return Rejection(
                item=capture_key("google-tiles", panorama_id),
                stage="fetch",
                reason="retired" if error.reason in ("not-found", "gone") else error.reason,
                message=str(error),
                values=error.values,
            )


def parse_ids(body: bytes, count: int) -> list[str]:
    """The ids of a panoIds reply, one for each point; "" for points without a panorama near.

    Raises:
        NetworkError: If it is not such a reply, or not for so many points.
    """
    reply = json.loads(body)
    ids = reply.get("panoIds") if isinstance(reply, dict) else None
    # Services of this kind leave out empty fields.
    ids = [""] * count if reply == {} else ids
    if not isinstance(ids, list) or len(ids) != count:
        raise NetworkError(
            f"Google's answer to panoIds does not have {count} ids. Check the endpoint."
        )
    return [str(one or "") for one in ids]


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
    month = month_of_date(reply.get("date"))
    tilt, roll, heading = reply.get("tilt"), reply.get("roll"), reply.get("heading")
    details = {
        "copyright": reply.get("copyright"),
        "imagery_type": reply.get("imageryType"),
        "report_url": reply.get("reportProblemLink"),
        "terms": terms_accepted(),
    }
    return Capture(
        provider="google-tiles",
        id=str(reply["panoId"]),
        license=google_license(reply.get("copyright")),
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
        source_url=map_page(str(reply["panoId"])),
        details={name: value for name, value in details.items() if value},
    )


def _is_of_full_resolution(body: bytes, grid: TileGrid, column: int, row: int) -> bool:
    """Whether a tile is as large as its cell, padded or cropped at the edge of the picture."""
    cell = (
        min(grid.tile_width_px, grid.width_px - column * grid.tile_width_px),
        min(grid.tile_height_px, grid.height_px - row * grid.tile_height_px),
    )
    width, height = jpeg_size(body, "tile")
    return width >= cell[0] and height >= cell[1]
