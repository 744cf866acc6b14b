"""Stored tiles, views or photos in, a panorama that is level and faces north out.

stage         the stage: a stored capture -> a Panorama
mosaic        tiles -> one picture, with a mask of what is missing
tiles         one tile's bytes -> the pixels of its cell
black         which all-black tiles are missing ones, and which are night
deblock       the steps between tiles
reduce        a big picture -> a smaller one, row by row, in linear light
overlapping   captures and VIEWS.json of overlapping pictures -> a panorama or radiance
view_files    what a VIEWS.json says
views         overlapping views with poses -> one picture: exposure, pose, blend
layout        where a panorama's pixels lie in its views; kept
overlaps      what views show of the same directions
agreement     whether they show the same at all
photometry    exposure and vignetting
refine        poses
blend         the weighted mean, or bands with soft seams
matching      photos without poses -> views
brackets      exposures of one picture -> its radiance
level         heading, pitch and roll -> the frame of the result
upright       pitch and roll from the picture's own upright lines
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.stitch.brackets import MergedBrackets, merge_brackets
    from panokit.stitch.matching import Matched, match_photos
    from panokit.stitch.overlapping import stitch_view_set
    from panokit.stitch.settings import StitchSettings
    from panokit.stitch.stage import stitch
    from panokit.stitch.upright import Upright, find_upright
    from panokit.stitch.view_files import ViewSet, read_view_set
    from panokit.stitch.views import StitchedViews, stitch_views

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Matched": "panokit.stitch.matching",
        "MergedBrackets": "panokit.stitch.brackets",
        "StitchSettings": "panokit.stitch.settings",
        "StitchedViews": "panokit.stitch.views",
        "Upright": "panokit.stitch.upright",
        "ViewSet": "panokit.stitch.view_files",
        "find_upright": "panokit.stitch.upright",
        "match_photos": "panokit.stitch.matching",
        "merge_brackets": "panokit.stitch.brackets",
        "read_view_set": "panokit.stitch.view_files",
        "stitch": "panokit.stitch.stage",
        "stitch_view_set": "panokit.stitch.overlapping",
        "stitch_views": "panokit.stitch.views",
    },
)
