"""`panokit app`: a local web application with three places.

settings     where it listens, what it takes
security     who may talk to it
uploads      files that a browser sends
desks        what belongs to one open tab
work         long work, away from the loop that answers the browser
routes       pictures, downloads and uploads of a tab
server       everything put together and started
shell        the page around the three places
widgets      what the places are made of; film, drop: with scripts of their own
expanding    what Expand does, without a browser; expand_place is what one sees of it
browsing     what Probe library does, without a browser; probes_place and probe_page show it
reading      what Lighting does, without a browser; lighting_place and its parts show it
insertion    a relit ball in a frame

NiceGUI and what it brings are imported here alone, and only when the application is started.
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.app.server import build, serve
    from panokit.app.settings import AppSettings

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "AppSettings": "panokit.app.settings",
        "build": "panokit.app.server",
        "serve": "panokit.app.server",
    },
)
