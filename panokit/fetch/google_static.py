"""Google Street View through the Static API: a panorama in overlapping views of 640 px.

The views' poses are known, so they can be put together; each record says where each view
looks, and which strip of it carries Google's marks. With the user's own key and consent: the
terms are those of all Street View pictures.
"""

import base64
import binascii
import hashlib
import hmac
import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any
from urllib.parse import urlencode, urlsplit

import numpy as np

from panokit.capture import Capture, TimePrecision, View, capture_key
from panokit.errors import (
    AuthError,
    ImageError,
    ItemError,
    NetworkError,
    QuotaError,
    Rejection,
    SettingsError,
)
from panokit.fetch.geodesy import LatLon
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
from panokit.fetch.where import DEFAULT_SNAP_M, ids_of
from panokit.http import Client, Request
from panokit.io.images import decode_image

ENDPOINT = "https://maps.googleapis.com"
SECRET_VARIABLE = "GOOGLE_MAPS_SIGNING_SECRET"
PATH = "/maps/api/streetview"
SIZE_PX = 640
# Logo and copyright line stand in the lowest 20 to 25 px.
MARKS_PX = (0, SIZE_PX - 30, SIZE_PX, SIZE_PX)
NO_IMAGERY_RGB = (228, 227, 223)
_BYTES_PER_VIEW = 60_000


class GoogleStatic:
    """The Street View Static API. Metadata is free, each view has its price."""

    may_store = True  # the terms were accepted, else there is no instance

    def __init__(self, settings: FetchSettings, client: Client) -> None:
        require_consent("google-static", settings.accept_terms)
        self._endpoint = settings.endpoint or ENDPOINT
        self._settings = settings
        self._client = client
        self._key = require_key(os.environ.get(KEY_VARIABLE), "Street View Static API")
        self._secret = os.environ.get(SECRET_VARIABLE) or ""
        if self._secret:
            sign("/", self._secret)  # a secret that is none is told at once
        self._views = plan_views(settings.view_fov_deg)
        self._seen: set[str] = set()
        self.usd_per_file = price_of("google-static", settings.prices).usd_per_unit

    def find(self, place: Place | None, points: Sequence[LatLon]) -> Iterator[Found | Rejection]:
        """The panorama nearest to each point, each panorama once."""
        if place is None:
            for panorama_id in ids_of(self._settings):
                yield self._describe({"pano": panorama_id}) or _retired(panorama_id)
            return
        radius_m = place.snap_m or self._settings.snap_m or DEFAULT_SNAP_M
        for latitude, longitude in points:
            where = {"location": f"{latitude:.7f},{longitude:.7f}", "radius": f"{radius_m:.0f}"}
            if not self._settings.indoor:
                where["source"] = "outdoor"
            found = self._describe(where)
            if found is not None and found.capture.id not in self._seen:
                self._seen.add(found.capture.id)
                yield found

    def read(self, found: Found, name: str) -> bytes:
        """One view."""
        view = next(view for view in found.views if view.name == name)
        params = {
            "size": f"{view.width_px}x{view.height_px}",
            "pano": found.capture.id,
            "heading": f"{view.heading_deg:g}",
            "pitch": f"{view.pitch_deg:g}",
            "fov": f"{view.fov_deg:g}",
            "return_error_code": "true",
        }
        what = f"{name} of {found.capture.id}"
        request = replace(
            self._request(PATH, params),
            expect="image",
            check=lambda body: check_view(body, view, what),
            cost_usd=self.usd_per_file,
        )
        try:
            return self._client.send(request).body
        except ItemError as error:
            if error.reason not in ("not-found", "no-imagery"):
                raise
            raise ItemError(str(error), reason="retired", values=error.values) from None

    def _describe(self, where: Mapping[str, str]) -> Found | None:
        """The panorama at a point or with an id, or None if there is none."""
        request = replace(self._request(f"{PATH}/metadata", where), check=check_status)
        try:
            reply = self._client.send(request)
        except ItemError as error:
            raise NetworkError(f"{error} Check the endpoint.") from None
        return parse_metadata(reply.body, self._views)

    def _request(self, path: str, params: Mapping[str, str]) -> Request:
        """A request with key, and with signature where there is a secret to sign with."""
        secrets = {"key": self._key}
        if self._secret:
            path_on_server = urlsplit(self._endpoint).path + path
            signed = f"{path_on_server}?{urlencode({**params, **secrets})}"
            secrets["signature"] = sign(signed, self._secret)
        return Request(url=f"{self._endpoint}{path}", params=params, secrets=secrets)


def plan_views(fov_deg: float) -> tuple[View, ...]:
    """Views that cover the sphere, nearly all of it twice: 22 of 75 degrees.

    Rows of views from the horizon to straight up and down, at most two thirds of a view apart in
    pitch; each row has as many as its parallel nearest to the horizon needs.
    """
    steps = math.ceil(90 / (0.66 * fov_deg))
    rows = [(0.0, math.ceil(360 / (0.6 * fov_deg)))]
    for step in range(1, steps):
        pitch = 90 * step / steps
        nearest_deg = max(pitch - fov_deg / 2, 0.0)
        count = math.ceil(360 / (0.8 * fov_deg) * math.cos(math.radians(nearest_deg)))
        rows += [(pitch, count), (-pitch, count)]
    rows += [(90.0, 1), (-90.0, 1)]
    poses = [(360 / count * i, pitch) for pitch, count in rows for i in range(count)]
    return tuple(
        View(
            name=f"views/{number:02}.jpg",
            heading_deg=round(heading, 4),
            pitch_deg=round(pitch, 4),
            fov_deg=fov_deg,
            width_px=SIZE_PX,
            height_px=SIZE_PX,
            masked_px=(MARKS_PX,),
        )
        for number, (heading, pitch) in enumerate(poses)
    )


def sign(path_and_query: str, secret: str) -> str:
    """The signature of a request: HMAC-SHA1 over path and query, in URL-safe base64.

    (developers.google.com/maps/documentation/streetview/digital-signature)

    Raises:
        SettingsError: If the secret is not URL-safe base64.
    """
    try:
        key = base64.b64decode(secret.encode(), altchars=b"-_", validate=True)
    except (binascii.Error, ValueError):
        raise SettingsError(
            f"The signing secret in {SECRET_VARIABLE} is not one: copy it whole from the "
            "Credentials page of the Google Cloud console."
        ) from None
    digest = hmac.new(key, path_and_query.encode(), hashlib.sha1).digest()
    return base64.urlsafe_b64encode(digest).decode()


def check_status(body: bytes) -> None:
    """Check that a metadata reply is an answer; it comes with HTTP 200 whatever it says.

    Raises:
        ItemError: If the service asks to try again (reason "server-error").
    """
    if _status(body) == "UNKNOWN_ERROR":
        raise ItemError("Google's metadata service has a passing error.", reason="server-error")


def parse_metadata(body: bytes, views: tuple[View, ...]) -> Found | None:
    """The panorama that a metadata reply describes, or None if there is none.

    Raises:
        AuthError: If the key was refused.
        QuotaError: If the quota is used up.
        NetworkError: If it is no such reply.
    """
    reply: Mapping[str, Any] = json.loads(body)
    match _status(body):
        case "OK":
            return _found(reply, views)
        case "ZERO_RESULTS" | "NOT_FOUND":
            return None
        case "OVER_QUERY_LIMIT":
            raise QuotaError(
                "Google says that the quota is used up; what is fetched is kept, run again later."
            )
        case "REQUEST_DENIED":
            said = reply.get("error_message") or "no reason given"
            raise AuthError(
                f"Google refused the request: {said} Check the API key, that the Street View "
                "Static API is enabled for it, its billing, and its signing secret."
            )
        case other:
            raise NetworkError(
                f"Google's metadata service answered {other or 'nothing'!r}. Check the endpoint."
            )


def check_view(body: bytes, view: View, what: str) -> None:
    """Check that a body is a view and not the grey picture that says there is none.

    Raises:
        ImageError: If not ("no-imagery", "wrong-size", "truncated", "not-an-image").
    """
    size = jpeg_size(body, what)
    if size != (view.width_px, view.height_px):
        raise ImageError(
            f"The {what} is {size[0]}x{size[1]}, not {view.width_px}x{view.height_px}. "
            "Fetch it again.",
            reason="wrong-size",
            values={"width_px": size[0], "height_px": size[1]},
        )
    pixels = decode_image(body, what=what)
    is_grey = np.abs(pixels[::4, ::4].astype(np.int16) - NO_IMAGERY_RGB).max(axis=-1) <= 3
    if is_grey.mean() > 0.9:
        raise ImageError(
            f"Instead of {what} Google sent its picture for missing imagery.", reason="no-imagery"
        )


def _found(reply: Mapping[str, Any], views: tuple[View, ...]) -> Found:
    try:
        location = reply["location"]
        position = float(location["lat"]), float(location["lng"])
        panorama_id = str(reply["pano_id"])
    except (KeyError, TypeError, ValueError) as error:
        raise NetworkError(f"Google's metadata is not usable ({error!r}).") from None
    month = month_of_date(reply.get("date"))
    details = {
        "copyright": reply.get("copyright"),
        "terms": terms_accepted(),
        # The service levels its views by the car, which may stand on a slope.
        "pitch_reference": "vehicle",
    }
    capture = Capture(
        provider="google-static",
        id=panorama_id,
        license=google_license(reply.get("copyright")),
        latitude_deg=position[0],
        longitude_deg=position[1],
        time=month,
        time_precision=TimePrecision.MONTH if month else None,
        source_url=map_page(panorama_id),
        details={name: value for name, value in details.items() if value},
    )
    return Found(capture=capture, views=views, bytes=len(views) * _BYTES_PER_VIEW, raw=dict(reply))


def _status(body: bytes) -> str:
    reply = json.loads(body)
    return str(reply.get("status") or "") if isinstance(reply, dict) else ""


def _retired(panorama_id: str) -> Rejection:
    return Rejection(
        item=capture_key("google-static", panorama_id),
        stage="fetch",
        reason="retired",
        message=f"Google has no panorama {panorama_id} (any more); their ids change.",
    )
