"""Places in, stored captures out: street panoramas from services and folders.

stage         the stage: settings -> captures on disk, within budgets
settings      what to fetch, from where, how much of it
places        city names, boxes and discs -> areas
sampling      areas -> reproducible points that can be extended
provider      what every source offers; `sources` is the table of them
panoramax     a Panoramax catalog or instance (open licenses; the default)
google_tiles  the Google Map Tiles API (own key and terms)
folder        equirectangular pictures on this disk
selection     which of the pictures found are taken
store         one picture found -> its files on disk, record last
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.fetch.places import Place, find_city
    from panokit.fetch.result import FetchEvent, FetchPlan, FetchResult
    from panokit.fetch.settings import FetchSettings, PlaceSettings
    from panokit.fetch.stage import fetch

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "FetchEvent": "panokit.fetch.result",
        "FetchPlan": "panokit.fetch.result",
        "FetchResult": "panokit.fetch.result",
        "FetchSettings": "panokit.fetch.settings",
        "Place": "panokit.fetch.places",
        "PlaceSettings": "panokit.fetch.settings",
        "fetch": "panokit.fetch.stage",
        "find_city": "panokit.fetch.places",
    },
)
