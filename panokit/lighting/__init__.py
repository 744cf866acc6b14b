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
    pass

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {},
)
