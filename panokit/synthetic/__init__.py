"""A procedural city with true HDR, and a local server that looks like the real services.

    server      Google, Panoramax, Mapillary and Poly Haven on 127.0.0.1, with faults on demand
    folder      pictures to serve from a folder of the user's own
    embedded    the city that travels with panokit: panoramas to fetch, truth for the judge
    true_light  maps of true range without pictures, of places that nobody fetches
    generate    more panoramas of more places, from a seed (needs the `render` extra)

How a city comes about: `shots` says where and when, `places` plans a `city.PlacePlan`,
`building_site` builds it with `facades`, `furniture` and `vehicles` into `shapes`, `sky` lights
it, `scene` and `render` hand it to Mitsuba, and `photograph` takes the picture.
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.synthetic.embedded import embedded_city, embedded_truth
    from panokit.synthetic.fault_language import parse_faults
    from panokit.synthetic.faults import Faults, Trouble
    from panokit.synthetic.folder import pictures_in
    from panokit.synthetic.generate import render_city
    from panokit.synthetic.pictures import ServedPicture
    from panokit.synthetic.server import StreetServer
    from panokit.synthetic.serving import serve
    from panokit.synthetic.settings import CitySettings, ServeSettings
    from panokit.synthetic.true_light import reference_maps

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "CitySettings": "panokit.synthetic.settings",
        "Faults": "panokit.synthetic.faults",
        "ServeSettings": "panokit.synthetic.settings",
        "ServedPicture": "panokit.synthetic.pictures",
        "StreetServer": "panokit.synthetic.server",
        "Trouble": "panokit.synthetic.faults",
        "embedded_city": "panokit.synthetic.embedded",
        "embedded_truth": "panokit.synthetic.embedded",
        "parse_faults": "panokit.synthetic.fault_language",
        "pictures_in": "panokit.synthetic.folder",
        "reference_maps": "panokit.synthetic.true_light",
        "render_city": "panokit.synthetic.generate",
        "serve": "panokit.synthetic.serving",
    },
)
