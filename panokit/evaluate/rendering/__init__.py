"""The light that explains both views when the object's shape is known, by differentiable rendering.

known    the object of a sample, rebuilt from what its record says
inverse  light, and if need be material, that make a renderer show what was seen
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.evaluate.rendering.inverse import (
        DifferentiableRendering as DifferentiableRendering,
    )
    from panokit.evaluate.rendering.known import KnownGeometry as KnownGeometry

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "DifferentiableRendering": "panokit.evaluate.rendering.inverse",
        "KnownGeometry": "panokit.evaluate.rendering.known",
    },
)
