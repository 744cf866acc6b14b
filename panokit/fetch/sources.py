"""The sources that `fetch` knows. To add one, write its file and a line here."""

from collections.abc import Callable

from panokit.fetch.folder import Folder
from panokit.fetch.google_static import GoogleStatic
from panokit.fetch.google_tiles import GoogleTiles
from panokit.fetch.mapillary import Mapillary
from panokit.fetch.panoramax import Panoramax
from panokit.fetch.provider import Provider
from panokit.fetch.settings import FetchSettings
from panokit.http import Client

SOURCES: dict[str, Callable[[FetchSettings, Client], Provider]] = {
    "panoramax": Panoramax,
    "mapillary": Mapillary,
    "google-tiles": GoogleTiles,
    "google-static": GoogleStatic,
    "folder": Folder,
}
