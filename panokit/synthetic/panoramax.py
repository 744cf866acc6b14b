"""A look-alike of a Panoramax instance: requests in, replies out.

Written from replies of public instances: a search without a next link, items with the heading
as `view:azimuth`, tiles of floored size under an unfloored `tileWidth`, full pictures answered
by a redirect to another host, and errors as {"message", "status_code"}.
"""

import math
from datetime import UTC, datetime
from typing import Any

import numpy as np

from panokit.io.images import encode_jpeg
from panokit.synthetic.exchange import Reply, Request, jpeg_reply, json_reply
from panokit.synthetic.faults import Faults
from panokit.synthetic.pictures import PictureStore, ServedPicture

_SD_WIDTH_PX = 2048
_THUMB_WIDTH_PX = 500
_MOST_ITEMS = 10000


def tile_columns(width_px: int) -> int:
    """How many tiles a picture is cut into from left to right; half as many from top to bottom."""
    fitting = max(min(2 * (width_px // 512 // 2), 64), 4)
    return max(columns for columns in (4, 8, 16, 32, 64) if columns <= fitting)


class Panoramax:
    """The service under /api, and the object storage that its full pictures redirect to."""

    def __init__(self, store: PictureStore, url: str, storage_url: str) -> None:
        self._store = store
        self._url = url
        self._storage_url = storage_url

    def answer(self, request: Request, faults: Faults) -> Reply:
        """The reply to any request whose path starts with /api."""
        if request.method not in ("GET", "POST"):
            return _error("Method Not Allowed", 405)
        parts = request.path.strip("/").split("/")[1:]
        match parts:
            case ["search"]:
                return self._search(request, faults)
            case ["configuration"]:
                return json_reply({"name": {"label": "panokit look-alike"}, "version": "2.15.1"})
            case ["collections"]:
                return json_reply({"collections": self._collections(), "links": []})
            case ["collections", collection, "items"]:
                return self._items(request, collection, faults)
            case ["collections", _, "items", picture_id] | ["pictures", picture_id]:
                return self._item(picture_id, faults)
            case ["pictures", picture_id, *rest]:
                return self._file(picture_id, rest, faults)
        return _error("The requested URL was not found on the server.", 404)

    def answer_storage(self, request: Request, faults: Faults) -> Reply:
        """The reply of the second host: the full picture."""
        picture_id = request.path.removeprefix("/main-pictures/").removesuffix(".jpg")
        picture = self._store.get(picture_id)
        if picture is None or picture_id in faults.retired:
            return _error("NoSuchKey", 404)
        return jpeg_reply(self._store.whole_jpeg(picture, *picture.size_px))

    def _search(self, request: Request, faults: Faults) -> Reply:
        query = dict(request.query)
        if request.method == "POST":
            posted = request.json() or {}
            query |= {
                name: ",".join(map(str, value)) if isinstance(value, list) else str(value)
                for name, value in posted.items()
            }
        limit = _whole(query.get("limit", "10"))
        if limit is None or not 1 <= limit <= _MOST_ITEMS:
            return _error(f"Parameter limit must be an integer between 1 and {_MOST_ITEMS}", 400)
        found = list(self._store)
        if "bbox" in query:
            box = _box(query["bbox"])
            if box is None:
                return _error("Parameter bbox must be in format [minX, minY, maxX, maxY]", 400)
            found = _inside(found, box)
        if "datetime" in query:
            found = _taken_in(found, query["datetime"])
        for name, value_of in (("ids", _id), ("collections", _sequence)):
            if name in query:
                wanted = set(query[name].strip("[]").replace('"', "").split(","))
                found = [picture for picture in found if value_of(picture) in wanted]
        # An instance's search has no next link: who wants more must ask for smaller boxes.
        features = [self._description(picture, faults) for picture in found[:limit]]
        return json_reply({"type": "FeatureCollection", "features": features, "links": []})

    def _collections(self) -> list[dict[str, Any]]:
        names = sorted({picture.sequence for picture in self._store})
        return [{"id": name, "type": "Collection", "title": name} for name in names]

    def _items(self, request: Request, collection: str, faults: Faults) -> Reply:
        members = [picture for picture in self._store if picture.sequence == collection]
        if not members:
            return _error("Collection doesn't exist", 404)
        limit = _whole(request.query.get("limit", "100"))
        start = _whole(request.query.get("startAfterRank", "0"))
        if limit is None or start is None or not 1 <= limit <= _MOST_ITEMS or start < 0:
            return _error(f"limit parameter should be an integer between 1 and {_MOST_ITEMS}", 400)
        page = members[start : start + limit]
        links = []
        if start + limit < len(members):
            href = (
                f"{self._url}/api/collections/{collection}/items"
                f"?limit={limit}&startAfterRank={start + limit}"
            )
            links = [{"rel": "next", "type": "application/geo+json", "href": href}]
        features = [self._description(picture, faults) for picture in page]
        return json_reply({"type": "FeatureCollection", "features": features, "links": links})

    def _item(self, picture_id: str, faults: Faults) -> Reply:
        picture = self._store.get(picture_id)
        if picture is None or picture_id in faults.retired:
            return _error("Picture doesn't exist", 404)
        return json_reply(self._description(picture, faults))

    def _file(self, picture_id: str, rest: list[str], faults: Faults) -> Reply:
        picture = self._store.get(picture_id)
        if picture is None or picture_id in faults.retired:
            return _error("Picture doesn't exist", 404)
        match rest:
            case ["hd.jpg"]:
                place = f"{self._storage_url}/main-pictures/{picture_id}.jpg"
                return Reply(status=302, headers={"Location": place})
            case ["sd.jpg"]:
                return jpeg_reply(self._shrunk(picture, _SD_WIDTH_PX))
            case ["thumb.jpg"]:
                return jpeg_reply(self._shrunk(picture, _THUMB_WIDTH_PX))
            case ["tiled", name]:
                return self._tile(picture, name)
        return _error("The requested URL was not found on the server.", 404)

    def _shrunk(self, picture: ServedPicture, width_px: int) -> bytes:
        width_px = min(width_px, picture.size_px[0])
        height_px = round(width_px * picture.size_px[1] / picture.size_px[0])
        return self._store.whole_jpeg(picture, width_px, height_px)

    def _tile(self, picture: ServedPicture, name: str) -> Reply:
        columns = tile_columns(picture.size_px[0])
        rows = columns // 2
        column, _, row = name.removesuffix(".jpg").partition("_")
        x, y = _whole(column), _whole(row)
        if x is None or y is None or not (0 <= x < columns and 0 <= y < rows):
            return _error("Invalid tile indices", 404)
        # Floored sizes: the last few columns and rows of the picture are in no tile.
        width_px, height_px = picture.size_px[0] // columns, picture.size_px[1] // rows
        box = (x * width_px, y * height_px, (x + 1) * width_px, (y + 1) * height_px)
        pixels = self._store.piece(picture, picture.size_px, box)
        return jpeg_reply(encode_jpeg(np.ascontiguousarray(pixels), quality=90))

    def _description(self, picture: ServedPicture, faults: Faults) -> dict[str, Any]:
        capture = picture.capture
        latitude_deg, longitude_deg = picture.position_deg
        root = f"{self._url}/api/pictures/{capture.id}"
        item = f"{self._url}/api/collections/{picture.sequence}/items/{capture.id}"
        return {
            "id": capture.id,
            "type": "Feature",
            "stac_version": "1.0.0",
            "bbox": [longitude_deg, latitude_deg, longitude_deg, latitude_deg],
            "geometry": {"type": "Point", "coordinates": [longitude_deg, latitude_deg]},
            "collection": picture.sequence,
            "providers": [{"name": capture.license.attribution, "roles": ["producer"]}],
            "properties": _properties(picture, sparse=faults.sparse_metadata),
            "assets": {
                name: {
                    "href": f"{root}/{name}.jpg",
                    "type": "image/jpeg",
                    "roles": [role],
                    "title": f"{name.upper()} picture",
                }
                for name, role in (("hd", "data"), ("sd", "visual"), ("thumb", "thumbnail"))
            },
            "asset_templates": {
                "tiles": {
                    "href": f"{root}/tiled/{{TileCol}}_{{TileRow}}.jpg",
                    "type": "image/jpeg",
                    "roles": ["data"],
                }
            },
            "links": [
                {"rel": "self", "type": "application/geo+json", "href": item},
                {"rel": "license", "href": capture.license.url},
            ],
        }


def _properties(picture: ServedPicture, *, sparse: bool) -> dict[str, Any]:
    capture = picture.capture
    width_px, height_px = picture.size_px
    columns = tile_columns(width_px)
    known: dict[str, Any] = {
        "datetime": capture.time and capture.time.astimezone(UTC).isoformat(),
        "license": capture.license.id,
        "geovisio:status": "ready",
        "geovisio:producer": capture.license.attribution,
        "tiles:tile_matrix_sets": {
            "geovisio": {
                "type": "TileMatrixSetType",
                "identifier": f"geovisio-{capture.id}",
                "tileMatrix": [
                    {
                        "type": "TileMatrixType",
                        "identifier": "0",
                        "scaleDenominator": 1,
                        "topLeftCorner": [0, 0],
                        # Not floored, unlike the tiles themselves.
                        "tileWidth": width_px / columns,
                        "tileHeight": height_px / (columns // 2),
                        "matrixWidth": columns,
                        "matrixHeight": columns // 2,
                    }
                ],
            }
        },
    }
    if capture.details.get("synthetic") is True:
        # Not a field of real instances: reports must be able to say that this is no photograph.
        known["panokit:synthetic"] = True
    interior: dict[str, Any] = {"camera_model": "panokit", "field_of_view": 360}
    if not sparse:
        interior["sensor_array_dimensions"] = [width_px, height_px]
        known |= {
            "view:azimuth": capture.heading_deg,
            "pers:pitch": capture.pitch_deg,
            "pers:roll": capture.roll_deg,
            "original_file:name": picture.image.name,
        }
    known["pers:interior_orientation"] = interior
    return {name: value for name, value in known.items() if value is not None}


def _inside(
    pictures: list[ServedPicture], box: tuple[float, float, float, float]
) -> list[ServedPicture]:
    """The pictures in a box, nearest to its center first."""
    west, south, east, north = box
    inside = [
        picture
        for picture in pictures
        if south <= picture.position_deg[0] <= north and west <= picture.position_deg[1] <= east
    ]
    center = (south + north) / 2, (west + east) / 2
    return sorted(inside, key=lambda picture: picture.distance_m(*center))


def _taken_in(pictures: list[ServedPicture], interval: str) -> list[ServedPicture]:
    start, _, end = interval.partition("/")
    low = None if start in ("", "..") else datetime.fromisoformat(start)
    high = None if end in ("", "..") else datetime.fromisoformat(end)
    return [
        picture
        for picture in pictures
        if (time := picture.capture.time) is not None
        and (low is None or time >= low)
        and (high is None or time <= high)
    ]


def _id(picture: ServedPicture) -> str:
    return picture.capture.id


def _sequence(picture: ServedPicture) -> str:
    return picture.sequence


def _box(text: str) -> tuple[float, float, float, float] | None:
    try:
        west, south, east, north = (float(part) for part in text.strip("[]").split(","))
    except ValueError:
        return None
    sane = all(map(math.isfinite, (west, south, east, north))) and west <= east and south <= north
    return (west, south, east, north) if sane else None


def _whole(text: str) -> int | None:
    try:
        return int(text)
    except ValueError:
        return None


def _error(message: str, status: int) -> Reply:
    return json_reply({"message": message, "status_code": status}, status)
