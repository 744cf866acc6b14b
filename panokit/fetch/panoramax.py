"""Panoramax: street pictures under open licenses, from a catalog or from one instance.

Written for the STAC API of GeoVisio (the software behind Panoramax): /api/search lists items,
sorted by distance from the middle of the box, without a link to a next page; each item links
to its full-size picture. The full picture is one request and keeps every pixel, while the
tiles of the viewer lose a few columns and rows.
"""

import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any
from urllib.parse import urljoin

from panokit.capture import (
    Capture,
    License,
    TimePrecision,
    capture_key,
    license_from_spdx,
    wrap_degrees,
)
from panokit.errors import ItemError, NetworkError, Rejection
from panokit.fetch.cells import Bbox, Listing
from panokit.fetch.geodesy import LatLon
from panokit.fetch.jpeg import check_sphere
from panokit.fetch.nearest import NearestPictures
from panokit.fetch.places import Place
from panokit.fetch.provider import Found
from panokit.fetch.settings import FetchSettings
from panokit.fetch.where import ids_of
from panokit.http import Client, Request

_log = logging.getLogger(__name__)
ENDPOINT = "https://api.panoramax.xyz"
_LIMIT = 100
_GONE = ("not-found", "gone")
_BYTES_PER_PIXEL = 0.1


class Panoramax:
    """The default provider: free of charge, no key."""

    usd_per_file = 0.0
    may_store = False

    def __init__(self, settings: FetchSettings, client: Client) -> None:
        self._endpoint = settings.endpoint or ENDPOINT
        self._client = client
        self._settings = settings
        self._interval = _interval(settings)
        self._nearest = NearestPictures(self._search, settings.snap_m)

    def find(self, place: Place | None, points: Sequence[LatLon]) -> Iterator[Found | Rejection]:
        """For each point the nearest 360 degree picture of its cell that was not given yet."""
        if place is None:
            for picture_id in ids_of(self._settings):
                yield self._describe(picture_id)
            return
        yield from self._nearest.find(place, points)

    def read(self, found: Found, name: str) -> bytes:
        """The full-size picture."""
        request = Request(
            url=found.address,
            expect="image",
            check=lambda body: check_sphere(body, found.capture.id),
        )
        try:
            return self._client.send(request).body
        except ItemError as error:
            if error.reason not in _GONE:
                raise
            raise ItemError(str(error), reason="retired", values=error.values) from None

    def _describe(self, picture_id: str) -> Found | Rejection:
        """One picture by its id."""
        url = f"{self._endpoint}/api/pictures/{picture_id}"
        try:
            item = self._client.send(Request(url=url)).json()
            found = parse_item(item, url)
        except ItemError as error:
            reason = "retired" if error.reason in _GONE else error.reason
            return _rejection(picture_id, reason, str(error))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            return _rejection(picture_id, "bad-metadata", f"{url} is no picture ({error!r}).")
        if found is None:
            return _rejection(picture_id, "not-360", f"{url} is no full picture of 360 degrees.")
        return found

    def _search(self, bbox_deg: Bbox) -> Listing[Found]:
        params = {"bbox": ",".join(f"{value:.7f}" for value in bbox_deg), "limit": str(_LIMIT)}
        if self._interval:
            params["datetime"] = self._interval
        url = f"{self._endpoint}/api/search"
        try:
            reply = self._client.send(Request(url=url, params=params))
        except ItemError as error:
            raise NetworkError(f"{error} Check that the endpoint is a Panoramax server.") from None
        return parse_search(reply.body, url)


def parse_search(body: bytes, url: str) -> Listing[Found]:
    """The 360 degree pictures of a search reply.

    Args:
        body: A GeoJSON feature collection of STAC items.
        url: Where it came from; addresses in it may be relative.

    Raises:
        NetworkError: If it is not such a collection.
    """
    reply = json.loads(body)
    features = reply.get("features") if isinstance(reply, dict) else None
    if not isinstance(features, list):
        raise NetworkError(
            f"{url} answered without a list of features. Check that it is a Panoramax server."
        )
    found = []
    for feature in features:
        try:
            one = parse_item(feature, url)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            # One item that is not as the standard says must not cost the others.
            _log.warning("%s: an item is left out: %r", url, error)
        else:
            found += [one] if one else []
    return Listing(found, is_complete=len(features) < _LIMIT)


def parse_item(item: Mapping[str, Any], url: str) -> Found | None:
    """The picture that a STAC item describes, or None if it is no full, ready 360 picture."""
    properties = item.get("properties") or {}
    interior = properties.get("pers:interior_orientation") or {}
    is_ready = properties.get("geovisio:status", "ready") == "ready"
    is_whole = not any(interior.get("visible_area") or ())
    href = ((item.get("assets") or {}).get("hd") or {}).get("href")
    if interior.get("field_of_view") != 360 or not (is_ready and is_whole and href):
        return None
    longitude, latitude = item["geometry"]["coordinates"][:2]
    width, height = _size(properties, interior)
    moment = _moment(properties.get("datetime"))
    roll = properties.get("pers:roll")
    capture = Capture(
        provider="panoramax",
        id=str(item["id"]),
        license=_license(item, properties),
        latitude_deg=float(latitude),
        longitude_deg=float(longitude),
        time=moment,
        time_precision=TimePrecision.SECOND if moment else None,
        heading_deg=properties.get("view:azimuth"),
        pitch_deg=properties.get("pers:pitch"),
        roll_deg=None if roll is None else wrap_degrees(float(roll)),
        width_px=width,
        height_px=height,
        source_url=_link(item, "self"),
        details=_details(item, properties, interior),
    )
    size = properties.get("original_file:size") or _BYTES_PER_PIXEL * (width or 0) * (height or 0)
    return Found(capture=capture, address=urljoin(url, href), bytes=int(size), raw=item)


def _rejection(picture_id: str, reason: str, message: str) -> Rejection:
    key = capture_key("panoramax", picture_id)
    return Rejection(item=key, stage="fetch", reason=reason, message=message)


def _license(item: Mapping[str, Any], properties: Mapping[str, Any]) -> License:
    names = [str(one["name"]) for one in item.get("providers") or () if one.get("name")]
    producer = properties.get("geovisio:producer") or (names[0] if names else "unknown author")
    spdx = str(properties.get("license") or "unknown")
    return license_from_spdx(spdx, f"{producer} via Panoramax ({spdx})", _link(item, "license"))


def _link(item: Mapping[str, Any], rel: str) -> str:
    hrefs = [link.get("href") for link in item.get("links") or () if link.get("rel") == rel]
    return str(hrefs[0]) if hrefs and hrefs[0] else ""


def _size(
    properties: Mapping[str, Any], interior: Mapping[str, Any]
) -> tuple[int, int] | tuple[None, None]:
    """Width and height, said outright by newer servers, by older ones only through the tiles."""
    size = interior.get("sensor_array_dimensions")
    if size:
        return int(size[0]), int(size[1])
    try:
        (matrix,) = properties["tiles:tile_matrix_sets"]["geovisio"]["tileMatrix"]
        return (
            round(matrix["tileWidth"] * matrix["matrixWidth"]),
            round(matrix["tileHeight"] * matrix["matrixHeight"]),
        )
    except (KeyError, TypeError, ValueError):
        return None, None


def _moment(text: str | None) -> datetime | None:
    if not text:
        return None
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).astimezone(UTC)


def _details(
    item: Mapping[str, Any], properties: Mapping[str, Any], interior: Mapping[str, Any]
) -> dict[str, Any]:
    details = {
        "sequence": item.get("collection"),
        "camera": interior.get("camera_model"),
        "local_time": properties.get("datetimetz"),
        "position_accuracy_m": properties.get("quality:horizontal_accuracy"),
        "instance": _link(item, "via"),
        "synthetic": properties.get("panokit:synthetic"),
    }
    return {name: value for name, value in details.items() if value}


def _interval(settings: FetchSettings) -> str:
    """The time span to search, "" for any time (RFC 3339, ".." for an open end)."""
    if settings.date_from is None and settings.date_to is None:
        return ""
    start = f"{settings.date_from}T00:00:00Z" if settings.date_from else ".."
    end = f"{settings.date_to}T23:59:59Z" if settings.date_to else ".."
    return f"{start}/{end}"
