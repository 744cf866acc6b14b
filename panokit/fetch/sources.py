"""The sources that `fetch` knows. To add one, write its file and a line here."""

from collections.abc import Callable

from panokit.fetch.folder import Folder
from panokit.fetch.google_tiles import GoogleTiles
from panokit.fetch.panoramax import Panoramax
from panokit.fetch.provider import Provider
from panokit.fetch.settings import FetchSettings
from panokit.http import Client

SOURCES: dict[str, Callable[[FetchSettings, Client], Provider]] = {
    "panoramax": Panoramax,
    "google-tiles": GoogleTiles,
    "folder": Folder,
}
