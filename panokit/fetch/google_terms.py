"""What both of Google's services have in common: the key, the terms, the month of a picture."""

import re
from datetime import UTC, datetime

from panokit.capture import License
from panokit.errors import AuthError
from panokit.fetch.terms import TERMS

KEY_VARIABLE = "GOOGLE_MAPS_API_KEY"


def require_key(key: str | None, service: str) -> str:
    """The API key, as the environment gave it.

    Args:
        key: What the environment says.
        service: What has to be enabled for it: "Map Tiles API".

    Raises:
        AuthError: If there is none.
    """
    if not key:
        raise AuthError(
            f"Google needs an API key of your own: enable the {service} in the Google Cloud "
            f"console and set the environment variable {KEY_VARIABLE}."
        )
    return key


def google_license(copyright_line: str | None) -> License:
    """The terms of every Street View picture: they permit nothing but looking."""
    return License(
        id="google-maps-platform",
        attribution=f"Google Maps, {copyright_line or '© Google'}",
        url=TERMS["google-tiles"].url,
    )


def terms_accepted() -> str:
    """What the user has accepted, for the record of each picture."""
    terms = TERMS["google-tiles"]
    return f"{terms.summary} Accepted by the user; see {terms.url}"


def month_of_date(text: str | None) -> datetime | None:
    """The first of the month that "YYYY-MM" names; Google says no more than that."""
    match = re.fullmatch(r"(\d{4})-(\d{2})", text or "")
    return datetime(int(match[1]), int(match[2]), 1, tzinfo=UTC) if match else None


def map_page(panorama_id: str) -> str:
    """The page that shows a panorama."""
    return f"https://www.google.com/maps/@?api=1&map_action=pano&pano={panorama_id}"
