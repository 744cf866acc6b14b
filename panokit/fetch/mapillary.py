"""Mapillary: street pictures under CC BY-SA 4.0, through version 4 of its API.

A search takes a box smaller than 0.01 degrees, has no second page, and lists the less of what
is there the larger the box is; so boxes are cut into cells of 0.005 degrees at most. The
addresses of pictures are signed and end after a while: they are asked for again when they
have, and no record holds one.
"""

import json
import logging
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any
from urllib.parse import parse_qs, urlsplit

from panokit.capture import Capture, TimePrecision, capture_key, license_from_spdx
from panokit.errors import AuthError, ItemError, NetworkError, Rejection
from panokit.fetch.cells import Bbox, Listing
from panokit.fetch.geodesy import LatLon
from panokit.fetch.jpeg import check_sphere
from panokit.fetch.nearest import NearestPictures
from panokit.fetch.places import Place
from panokit.fetch.provider import Found
from panokit.fetch.settings import FetchSettings
from panokit.fetch.where import ids_of
from panokit.http import Client, Request
from panokit.poses import from_mapillary, to_gpano

ENDPOINT = "https://graph.mapillary.com"
TOKEN_VARIABLE = "MAPILLARY_TOKEN"
LARGEST_CELL_DEG = 0.005
_LIMIT = 2000
_BYTES_PER_PIXEL = 0.2
_MARGIN_S = 30.0
_THUMBS = ("thumb_original_url", "thumb_2048_url", "thumb_1024_url")
_FIELDS = (
    "id,geometry,computed_geometry,captured_at,compass_angle,computed_compass_angle,"
    "computed_rotation,camera_type,is_pano,width,height,make,model,sequence,creator,altitude,"
    "quality_score,thumb_original_url,thumb_2048_url,thumb_1024_url"
)
_log = logging.getLogger(__name__)


class Mapillary:
    """The API with the user's own free token. It charges nothing."""

    usd_per_file = 0.0
    may_store = False

    def __init__(
        self,
        settings: FetchSettings,
        client: Client,
        clock: Callable[[], float] = time.time,
    ) -> None:
        token = os.environ.get(TOKEN_VARIABLE)
        if not token:
            raise AuthError(
                "Mapillary needs a free token of your own: make an application at "
                "https://www.mapillary.com/dashboard/developers and set the environment variable "
                f"{TOKEN_VARIABLE} to its client token (MLY|...)."
            )
        self._authorization = f"OAuth {token}"
        self._endpoint = settings.endpoint or ENDPOINT
        self._settings = settings
        self._client = client
        self._clock = clock
        self._nearest = NearestPictures(self._search, settings.snap_m)

    def find(self, place: Place | None, points: Sequence[LatLon]) -> Iterator[Found | Rejection]:
        """For each point the nearest panorama of its cell that was not given yet."""
        if place is None:
            for picture_id in ids_of(self._settings):
                yield self._describe(picture_id)
            return
        yield from self._nearest.find(place, points)

    def read(self, found: Found, name: str) -> bytes:
        """The largest picture there is; its address is asked for again when it has ended."""
        address = found.address
        if is_expired(address, self._clock() + _MARGIN_S):
            address = self._new_address(found)
        try:
            return self._picture(found, address)
        except ItemError as error:
            # The storage refuses an address that it does not take for good any more.
            if error.reason != "forbidden":
                raise
        return self._picture(found, self._new_address(found))

    def _picture(self, found: Found, address: str) -> bytes:
        request = Request(
            url=address,
            expect="image",
            check=lambda body: check_sphere(body, found.capture.id),
        )
        try:
            return self._client.send(request).body
        except ItemError as error:
            raise _retired(error) from None

    def _new_address(self, found: Found) -> str:
        try:
            address = address_of(self._entity(found.capture.id))
        except ItemError as error:
            raise _retired(error) from None
        if not address:
            raise ItemError(f"{found.capture.key} has no picture any more.", reason="retired")
        return address

    def _entity(self, picture_id: str) -> Mapping[str, Any]:
        """What the service says of one picture."""
        request = Request(
            url=f"{self._endpoint}/{picture_id}",
            params={"fields": _FIELDS},
            authorization=self._authorization,
        )
        reply = self._client.send(request).json()
        return reply if isinstance(reply, dict) else {}

    def _describe(self, picture_id: str) -> Found | Rejection:
        key = capture_key("mapillary", picture_id)
        try:
            found = parse_image(self._entity(picture_id))
        except ItemError as error:
            return Rejection.from_error(key, "fetch", _retired(error))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            message = f"The description of {picture_id} is not usable ({error!r})."
            return Rejection(item=key, stage="fetch", reason="bad-metadata", message=message)
        if found is None:
            message = f"{picture_id} is no panorama of 360 degrees with a picture to fetch."
            return Rejection(item=key, stage="fetch", reason="not-360", message=message)
        return found

    def _search(self, bbox_deg: Bbox) -> Listing[Found]:
        if max(bbox_deg[2] - bbox_deg[0], bbox_deg[3] - bbox_deg[1]) > LARGEST_CELL_DEG:
            return Listing([], is_complete=False)
        params = {
            "fields": _FIELDS,
            "bbox": ",".join(f"{value:.7f}" for value in bbox_deg),
            "is_pano": "true",
            "limit": str(_LIMIT),
            **_interval(self._settings),
        }
        request = Request(
            url=f"{self._endpoint}/images", params=params, authorization=self._authorization
        )
        try:
            reply = self._client.send(request)
        except ItemError as error:
            if error.reason == "too-much":
                return Listing([], is_complete=False)
            raise NetworkError(f"{error} Check that the endpoint is Mapillary's.") from None
        return parse_images(reply.body)


def parse_images(body: bytes) -> Listing[Found]:
    """The panoramas of a search reply.

    Raises:
        NetworkError: If it is not one.
    """
    reply = json.loads(body)
    images = reply.get("data") if isinstance(reply, dict) else None
    if not isinstance(images, list):
        raise NetworkError("Mapillary's answer has no list of images. Check the endpoint.")
    found = []
    for image in images:
        try:
            one = parse_image(image)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            # One record that is not as the others must not cost them.
            _log.warning("An image of Mapillary is left out: %r", error)
        else:
            found += [one] if one else []
    return Listing(found, is_complete=len(images) < _LIMIT)


def parse_image(image: Mapping[str, Any]) -> Found | None:
    """The panorama that a record describes, or None if it is none or has no picture.

    All fields but the id may be absent. Where the service has computed position and rotation
    from the pictures, those are taken; what the camera said can be off by 100 degrees.
    """
    address = address_of(image)
    if not image.get("is_pano") or not address:
        return None
    geometry = image.get("computed_geometry") or image["geometry"]
    longitude, latitude = geometry["coordinates"][:2]
    heading, pitch, roll = _pose(image)
    width, height = image.get("width"), image.get("height")
    moment = _moment(image.get("captured_at"))
    name = (image.get("creator") or {}).get("username")
    author = f"@{name}" if name else "an unnamed author"
    page = f"https://www.mapillary.com/app/?pKey={image['id']}"
    capture = Capture(
        provider="mapillary",
        id=str(image["id"]),
        license=license_from_spdx(
            "CC-BY-SA-4.0", f"Photo by {author} on Mapillary (CC BY-SA 4.0), {page}"
        ),
        latitude_deg=float(latitude),
        longitude_deg=float(longitude),
        elevation_m=image.get("altitude"),
        time=moment,
        time_precision=TimePrecision.SECOND if moment else None,
        heading_deg=heading,
        pitch_deg=pitch,
        roll_deg=roll,
        width_px=width,
        height_px=height,
        source_url=page,
        details=_details(image),
    )
    shown_px = min(width or 0, _width_of(image) or width or 0)
    return Found(
        capture=capture,
        address=address,
        bytes=int(_BYTES_PER_PIXEL * shown_px * shown_px / 2),
        # Addresses are signed: they are not for keeping.
        raw={name: value for name, value in image.items() if not name.startswith("thumb_")},
    )


def address_of(image: Mapping[str, Any]) -> str:
    """Where the largest picture of a record is; the original may be missing."""
    return next((str(image[name]) for name in _THUMBS if image.get(name)), "")


def is_expired(address: str, now_s: float) -> bool:
    """Whether a signed address has ended: `oe` is its last second, in hexadecimal."""
    (text,) = parse_qs(urlsplit(address).query).get("oe", [""])[:1]
    try:
        return int(text, 16) <= now_s
    except ValueError:
        return False


def _pose(image: Mapping[str, Any]) -> tuple[float | None, float | None, float | None]:
    """Heading, pitch and roll in degrees; pitch and roll only where they were computed."""
    rotation = image.get("computed_rotation")
    # Records whose reconstruction failed have no rotation, or nulls in it.
    if isinstance(rotation, list) and len(rotation) == 3 and None not in rotation:
        # Rounded to what the numbers are worth, and without negative zeros.
        angles = [round(angle, 6) + 0.0 for angle in to_gpano(from_mapillary(rotation))]
        return angles[0], angles[1], angles[2]
    for name in ("computed_compass_angle", "compass_angle"):
        if image.get(name) is not None:
            return float(image[name]) % 360.0, None, None
    return None, None, None


def _moment(milliseconds: Any) -> datetime | None:
    if not isinstance(milliseconds, int | float):
        return None
    return datetime.fromtimestamp(milliseconds / 1000, UTC)


def _details(image: Mapping[str, Any]) -> dict[str, Any]:
    details = {
        "sequence": image.get("sequence"),
        "camera": " ".join(str(image[n]) for n in ("make", "model") if image.get(n)),
        "quality_score": image.get("quality_score"),
        "camera_heading_deg": image.get("compass_angle"),
        "reduced_to_px": _width_of(image),
    }
    return {name: value for name, value in details.items() if value}


def _width_of(image: Mapping[str, Any]) -> int | None:
    """The width of the largest picture where it is smaller than the original, else None."""
    if image.get("thumb_original_url"):
        return None
    return 2048 if image.get("thumb_2048_url") else 1024


def _interval(settings: FetchSettings) -> dict[str, str]:
    interval = {}
    if settings.date_from:
        interval["start_captured_at"] = f"{settings.date_from}T00:00:00Z"
    if settings.date_to:
        interval["end_captured_at"] = f"{settings.date_to}T23:59:59Z"
    return interval


def _retired(error: ItemError) -> ItemError:
    """The same error; what the service does not have any more is a verdict to remember."""
    if error.reason not in ("not-found", "gone"):
        return error
    return ItemError(str(error), reason="retired", values=error.values)
