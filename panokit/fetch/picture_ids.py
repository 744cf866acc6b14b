"""Pictures named one by one: by the id of their service, or by the address of its page."""

import base64
import re
from collections.abc import Iterable
from urllib.parse import parse_qs, unquote, urlsplit

from panokit.errors import PlaceError

_UUID = r"[0-9a-fA-F]{8}(?:-[0-9a-fA-F]{4}){3}-[0-9a-fA-F]{12}"
_ID = r"[A-Za-z0-9_.=-]{3,100}"
# Where an id stands in the path of an address, and under which names in its query.
_SHAPES = {
    "panoramax": ((rf"/(?:pictures|items)/({_UUID})",), ("pic", "picture")),
    "mapillary": ((r"/(?:im|map/im)/(\d+)",), ("pKey", "image_key")),
    "google": (
        (r"!1s([A-Za-z0-9_-]{10,})(?:!2e|$)", r"/panoid/([A-Za-z0-9_-]+)"),
        ("pano", "panoid"),
    ),
}
_KIND = {"google-tiles": "google", "google-static": "google"}


def picture_ids(source: str, texts: Iterable[str]) -> tuple[str, ...]:
    """The ids that these texts name, in order, each once.

    Args:
        source: Whose ids they are: "panoramax", "mapillary", "google-tiles", "google-static".
        texts: Ids, or addresses of the service's pages as a browser shows them.

    Raises:
        PlaceError: If one of them names no picture of this source.
    """
    return tuple(dict.fromkeys(picture_id(source, text) for text in texts))


def picture_id(source: str, text: str) -> str:
    """The id that one text names.

    Raises:
        PlaceError: If it names none of this source.
    """
    kind = _KIND.get(source, source)
    if kind not in _SHAPES:
        raise PlaceError(f"The source {source!r} has no ids to ask for.")
    paths, parameters = _SHAPES[kind]
    text = text.strip()
    found = _of_address(text, paths, parameters) if "://" in text else text
    if not re.fullmatch(_ID, found):
        raise PlaceError(
            f"{text[:80]!r} is neither an id of {source} nor the address of one of its pictures. "
            "Copy the address from the browser while the picture is shown."
        )
    return for_tiles(found) if kind == "google" else found


def for_tiles(panorama_id: str) -> str:
    """The id by which Google's documented services know a panorama.

    Pages of pictures that people took show an id that begins with "AF1Qip"; the services
    want it packed into a message of two fields, the kind 10 and the id, in URL-safe base64
    (so that it begins with "CAoS"). Other ids stay as they are.
    """
    if not panorama_id.startswith("AF1Qip"):
        return panorama_id
    name = panorama_id.encode()
    packed = b"\x08\x0a\x12" + bytes([len(name)]) + name
    return base64.urlsafe_b64encode(packed).decode().rstrip("=")


def _of_address(text: str, paths: Iterable[str], parameters: Iterable[str]) -> str:
    parts = urlsplit(text)
    # Viewers keep their state in the query, or behind the #, as parameters too.
    for query in (parts.query, parts.fragment.rpartition("?")[2]):
        values = parse_qs(query)
        for name in parameters:
            if values.get(name):
                return values[name][0]
    for pattern in paths:
        match = re.search(pattern, unquote(f"{parts.path}?{parts.query}#{parts.fragment}"))
        if match:
            return match[1]
    return ""
