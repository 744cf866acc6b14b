"""Stored tiles or one stored picture in, a panorama that is level and faces north out.

stage     the stage: a stored capture -> a Panorama
mosaic    tiles -> one picture, with a mask of what is missing
tiles     one tile's bytes -> the pixels of its cell
black     which all-black tiles are missing ones, and which are night
reduce    a big picture -> a smaller one, row by row, in linear light
level     heading, pitch and roll -> the frame of the result
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.stitch.settings import StitchSettings
    from panokit.stitch.stage import stitch

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "StitchSettings": "panokit.stitch.settings",
        "stitch": "panokit.stitch.stage",
    },
)
