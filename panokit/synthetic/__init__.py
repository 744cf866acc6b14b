"""A procedural city with true HDR, and a local server that looks like the real services.

server      Google Map Tiles and Panoramax on 127.0.0.1
folder      pictures to serve from a folder of the user's own
embedded    the city that travels with panokit: panoramas to fetch, truth for the judge
render      more panoramas of more places, from a seed (needs the `render` extra)
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.synthetic.faults import Faults, Trouble
    from panokit.synthetic.pictures import ServedPicture
    from panokit.synthetic.server import StreetServer

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Faults": "panokit.synthetic.faults",
        "ServedPicture": "panokit.synthetic.pictures",
        "StreetServer": "panokit.synthetic.server",
        "Trouble": "panokit.synthetic.faults",
    },
)
