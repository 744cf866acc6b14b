"""Places in, stored captures out: street panoramas from services and folders.

stage         the stage: settings -> captures on disk, within budgets
settings      what to fetch, from where, how much of it
where         settings -> areas (`places`, `cities`, `place_files`) and ids (`picture_ids`)
sampling      areas -> reproducible points that can be extended
provider      what every source offers; `sources` is the table of them
panoramax     a Panoramax catalog or instance (open licenses; the default)
mapillary     Mapillary (CC BY-SA, a free token)
google_tiles  the Google Map Tiles API (own key and terms)
google_static the Street View Static API, as overlapping views (own key and terms)
folder        equirectangular pictures on this disk
polyhaven     HDR maps of Poly Haven, for `panokit probes pull`
terms         what each source permits; `prices` what it charges, `plan` what that comes to
selection     which of the pictures found are taken; `thinning` keeps them apart
store         one picture found -> its files on disk, record last
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.fetch.cities import find_city
    from panokit.fetch.places import Place
    from panokit.fetch.plan import FetchPlan
    from panokit.fetch.result import FetchEvent, FetchResult
    from panokit.fetch.settings import FetchSettings, PlaceSettings
    from panokit.fetch.stage import fetch

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "FetchEvent": "panokit.fetch.result",
        "FetchPlan": "panokit.fetch.plan",
        "FetchResult": "panokit.fetch.result",
        "FetchSettings": "panokit.fetch.settings",
        "Place": "panokit.fetch.places",
        "PlaceSettings": "panokit.fetch.settings",
        "fetch": "panokit.fetch.stage",
        "find_city": "panokit.fetch.cities",
    },
)
