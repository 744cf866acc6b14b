"""From an LDR panorama to an HDR environment map.

stage               the stage: a network, or an analytic method
settings            its settings
reduce, features, components, component_features   what the networks see
network, spread, curve   running them, and from their answers to pixels
baselines           the analytic methods
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.expand.settings import ExpandSettings
    from panokit.expand.stage import expand

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "ExpandSettings": "panokit.expand.settings",
        "expand": "panokit.expand.stage",
    },
)
