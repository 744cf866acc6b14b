"""A look-alike of the Street View Static API: views of at most 640x640 px, and their metadata.

Written from the documentation and from the pictures that come with the service's open
specification: a grey picture with status 200 where there is no imagery, marks in both lower
corners, metadata that is always a 200, and signatures over path and query.
"""

import base64
import hashlib
import hmac
import math
from collections.abc import Mapping
from typing import Any
from urllib.parse import urlsplit

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.io.images import encode_jpeg
from panokit.synthetic.exchange import Reply, Request, jpeg_reply, json_reply
from panokit.synthetic.faults import Faults
from panokit.synthetic.pictures import PictureStore, ServedPicture
from panokit.synthetic.quota import QuotaCounter
from panokit.synthetic.views import view_of

PATH = "/maps/api/streetview"
# The secret of the vendor's own test vector; it opens nothing.
SIGNING_SECRET = "vNIXE0xscrmjlyV-12Nj_BvUPaw="
NO_IMAGERY_RGB = (228, 227, 223)
_LARGEST_PX = 640
_WIDEST_DEG = 120.0


class GoogleStatic:
    """The service under /maps/api/streetview."""

    def __init__(self, store: PictureStore, key: str) -> None:
        self._store = store
        self._key = key
        self._quota = QuotaCounter()

    def answer(self, request: Request, faults: Faults) -> Reply:
        """The reply to any request whose path starts with /maps/api/streetview."""
        if request.path == f"{PATH}/metadata":
            return json_reply(self._metadata(request, faults))
        if request.path != PATH:
            return _text("Not Found", 404)
        refusal = self._refuse(request, faults)
        if refusal:
            return _text(refusal, 403)
        over = self._quota.spend(faults.quota_per_minute, faults.quota_per_day)
        if over is not None:
            return _text("You have exceeded your rate-limit for this API.", 429)
        return self._view(request, faults)

    def _refuse(self, request: Request, faults: Faults) -> str:
        key, signature = request.query.get("key"), request.query.get("signature")
        if not key:
            return "You must use an API key to authenticate each request."
        if key != self._key:
            return "The provided API key is invalid."
        if faults.api_disabled:
            return "This API project is not authorized to use this API."
        if signature is None and faults.signature_required:
            return "You must use a valid signature: this project does not allow unsigned requests."
        if signature is not None and signature != signature_of(request.target, SIGNING_SECRET):
            return "Unable to authenticate the request. Provided 'signature' is not valid."
        return ""

    def _metadata(self, request: Request, faults: Faults) -> Mapping[str, Any]:
        refusal = self._refuse(request, faults)
        if refusal:
            return {"error_message": refusal, "status": "REQUEST_DENIED"}
        if "pano" not in request.query and "location" not in request.query:
            return {"status": "INVALID_REQUEST"}
        if "pano" not in request.query and _place(request.query["location"]) is None:
            return {"status": "NOT_FOUND"}
        picture = self._picture(request, faults)
        if picture is None:
            return {"status": "ZERO_RESULTS"}
        latitude_deg, longitude_deg = picture.position_deg
        known = {
            "copyright": picture.capture.license.attribution or "© Google",
            "date": picture.capture.time and picture.capture.time.strftime("%Y-%m"),
            "location": {"lat": latitude_deg, "lng": longitude_deg},
            "pano_id": picture.capture.id,
            "status": "OK",
        }
        if faults.sparse_metadata:
            known.pop("date")
        return {name: value for name, value in known.items() if value is not None}

    def _picture(self, request: Request, faults: Faults) -> ServedPicture | None:
        query = request.query
        if "pano" in query:
            picture = self._store.get(query["pano"])
        else:
            place = _place(query.get("location", ""))
            radius_m = float(query.get("radius", 50))
            picture = None if place is None else self._store.nearest(*place, radius_m)
        return None if picture is None or picture.capture.id in faults.retired else picture

    def _view(self, request: Request, faults: Faults) -> Reply:
        query = request.query
        strict = query.get("return_error_code", "").lower() == "true"
        size = _size(query.get("size", ""))
        angles = _angles(query)
        if size is None or angles is None or not ("pano" in query or "location" in query):
            return _text("Error: invalid or missing parameter.", 400)
        picture = self._picture(request, faults)
        if picture is None:
            return _text("", 404) if strict else _jpeg(_no_imagery(size))
        heading_deg, pitch_deg, fov_deg = angles
        if heading_deg is None:
            heading_deg = _bearing_deg(picture.position_deg, _place(query.get("location", "")))
        view = view_of(
            self._store,
            picture,
            size,
            heading_deg=heading_deg,
            pitch_deg=pitch_deg,
            fov_deg=fov_deg,
        )
        return _jpeg(_marked(view, picture))


def signature_of(target: str, secret: str) -> str:
    """The signature of a path with its query: HMAC-SHA1, in URL-safe base64.

    Args:
        target: As it is sent, URL-encoded; a signature in it is left out.
        secret: In URL-safe base64.
    """
    parts = urlsplit(target)
    query = "&".join(part for part in parts.query.split("&") if not part.startswith("signature="))
    key = base64.urlsafe_b64decode(secret)
    digest = hmac.new(key, f"{parts.path}?{query}".encode(), hashlib.sha1).digest()
    return base64.urlsafe_b64encode(digest).decode()


def _size(text: str) -> tuple[int, int] | None:
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        return None
    return min(int(width), _LARGEST_PX), min(int(height), _LARGEST_PX)


def _angles(query: Mapping[str, str]) -> tuple[float | None, float, float] | None:
    """Heading, pitch and field of view in degrees, or None where they are not numbers."""
    try:
        heading = float(query["heading"]) if "heading" in query else None
        pitch, fov = float(query.get("pitch", 0)), float(query.get("fov", 90))
    except ValueError:
        return None
    return (heading, pitch, min(fov, _WIDEST_DEG)) if abs(pitch) <= 90 and fov > 0 else None


def _place(text: str) -> tuple[float, float] | None:
    latitude, _, longitude = text.partition(",")
    try:
        return float(latitude), float(longitude)
    except ValueError:
        return None  # an address in words, which the look-alike does not know


def _bearing_deg(here: tuple[float, float], there: tuple[float, float] | None) -> float:
    if there is None:
        return 0.0
    north = there[0] - here[0]
    east = (there[1] - here[1]) * math.cos(math.radians(here[0]))
    return math.degrees(math.atan2(east, north)) % 360


def _no_imagery(size_px: tuple[int, int]) -> NDArray[np.uint8]:
    picture = np.full((size_px[1], size_px[0], 3), NO_IMAGERY_RGB, np.uint8)
    text, scale = "Sorry, we have no imagery here.", size_px[0] / 1100
    (width, _), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 1)
    place = (size_px[0] - width) // 2, size_px[1] // 2
    cv2.putText(picture, text, place, cv2.FONT_HERSHEY_SIMPLEX, scale, (160, 160, 160), 1)
    return picture


def _marked(view: NDArray[np.uint8], picture: ServedPicture) -> NDArray[np.uint8]:
    """The view with a logo in its lower left and a credit in its lower right corner."""
    marked = np.ascontiguousarray(view)
    height, width = marked.shape[:2]
    # Not the real logo, but as large and where it is.
    cv2.putText(marked, "LOGO", (6, height - 8), cv2.FONT_HERSHEY_DUPLEX, 0.7, (255, 255, 255), 2)
    year = picture.capture.time and picture.capture.time.year
    text = f"(c){year or ''} look-alike"
    (text_width, text_height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.35, 1)
    marked[height - text_height - 8 :, width - text_width - 8 :] //= 2
    place = width - text_width - 4, height - 4
    cv2.putText(marked, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.35, (255, 255, 255), 1)
    return marked


def _jpeg(pixels: NDArray[np.uint8]) -> Reply:
    return jpeg_reply(encode_jpeg(pixels, quality=90))


def _text(message: str, status: int) -> Reply:
    return Reply(status=status, body=message.encode(), content_type="text/plain; charset=UTF-8")
