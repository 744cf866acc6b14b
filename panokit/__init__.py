"""panokit: HDR light probes from street panoramas.

The package root exports the values that flow through panokit; the functions that make one
from another live in the subpackage named after the verb:

    Capture         where, when and under which license a picture was taken
    Panorama        display-encoded equirectangular pixels (LDR)
    EnvironmentMap  linear radiance over the sphere (HDR)
    Rotation        a rotation between two named frames
    License         what may be done with a picture, and whom to credit
    Provenance      the steps that made a file

    from panokit.io import read_panorama, write_environment_map
    from panokit.expand import expand

Importing panokit loads no numerical library; each value is loaded when first used.
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.capture import Capture, License
    from panokit.envmap import EnvironmentMap
    from panokit.errors import PanokitError, Rejection
    from panokit.frames import Rotation
    from panokit.panorama import Panorama
    from panokit.provenance import Provenance

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Capture": "panokit.capture",
        "EnvironmentMap": "panokit.envmap",
        "License": "panokit.capture",
        "PanokitError": "panokit.errors",
        "Panorama": "panokit.panorama",
        "Provenance": "panokit.provenance",
        "Rejection": "panokit.errors",
        "Rotation": "panokit.frames",
    },
)
