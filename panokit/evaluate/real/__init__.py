"""Photographs of real objects with the light that was measured there, as stereo samples.

Nobody has published two parallel views of an object with its light. Data sets for inverse
rendering have many views of an object, with poses; some of them are nearly side by side.

stanford_orb           14 objects in 7 places, 418 light maps
objects_with_lighting  objects by several cameras' photographs, a light map for each place
scenes                 what both have: views with poses, and light
pairs                  which two views are nearly side by side
rectify                two photographs as parallel cameras would have taken them
read                   a folder in, samples out
settings               of all that
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.evaluate.real.read import read_pairs as read_pairs
    from panokit.evaluate.real.settings import PairSettings as PairSettings

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "PairSettings": "panokit.evaluate.real.settings",
        "read_pairs": "panokit.evaluate.real.read",
    },
)
