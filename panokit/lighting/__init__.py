"""Views of an object in, the light of its scene out.

model            a released network, from two views to an estimate
estimate         what is read: the map, how sure it is, what to mind
assumptions      whether two views are what a network was trained for
confidence       how far off an estimate is likely to be, direction by direction
representations  the same light as lat-long map, lights, Gaussians, harmonics
fuse             several estimates as one
outputs          everything as files
settings         of all that
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.lighting.assumptions import view_warnings as view_warnings
    from panokit.lighting.confidence import Confidence as Confidence
    from panokit.lighting.estimate import LightEstimate as LightEstimate
    from panokit.lighting.fuse import fuse_estimates as fuse_estimates
    from panokit.lighting.model import LightingModel as LightingModel
    from panokit.lighting.outputs import read_outputs as read_outputs
    from panokit.lighting.outputs import write_outputs as write_outputs
    from panokit.lighting.settings import EstimateSettings as EstimateSettings
    from panokit.lighting.settings import OutputSettings as OutputSettings

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Confidence": "panokit.lighting.confidence",
        "EstimateSettings": "panokit.lighting.settings",
        "LightEstimate": "panokit.lighting.estimate",
        "LightingModel": "panokit.lighting.model",
        "OutputSettings": "panokit.lighting.settings",
        "fuse_estimates": "panokit.lighting.fuse",
        "read_outputs": "panokit.lighting.outputs",
        "view_warnings": "panokit.lighting.assumptions",
        "write_outputs": "panokit.lighting.outputs",
    },
)
