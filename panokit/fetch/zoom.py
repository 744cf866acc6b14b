"""How large a Street View panorama is at each zoom.

Sizes are not 512 x 2^zoom: the full picture is halved from its own size, rounding up, and the
deepest zoom is the first at which tiles of 512 px reach it. A picture 13312 px wide is 3328 px
wide at zoom 3, not 4096; asking for the latter brings black bands.
"""

from panokit.capture import TileGrid
from panokit.errors import UsageError


def deepest_zoom(width_px: int, tile_width_px: int = 512) -> int:
    """The zoom that holds the picture at its full width: ceil(log2(width / tile width))."""
    if width_px < 1 or tile_width_px < 1:
        raise UsageError(f"A picture of {width_px} px in tiles of {tile_width_px} px has no zoom.")
    return (-(-width_px // tile_width_px) - 1).bit_length()


def size_at_zoom(size_px: tuple[int, int], zoom: int, tile_width_px: int = 512) -> tuple[int, int]:
    """Width and height at a zoom: the full size halved once for each zoom below the deepest."""
    shrink = 1 << (deepest_zoom(size_px[0], tile_width_px) - zoom)
    return -(-size_px[0] // shrink), -(-size_px[1] // shrink)


def zoom_for_width(width_px: int, full_width_px: int, tile_width_px: int = 512) -> int:
    """The smallest zoom at which the picture is at least so wide; else the deepest."""
    deepest = deepest_zoom(full_width_px, tile_width_px)
    for zoom in range(deepest):
        if size_at_zoom((full_width_px, 1), zoom, tile_width_px)[0] >= width_px:
            return zoom
    return deepest


def grid_at_zoom(size_px: tuple[int, int], tile_size_px: tuple[int, int], zoom: int) -> TileGrid:
    """The tiles at a zoom, or at the deepest one if the picture does not go that deep."""
    zoom = min(zoom, deepest_zoom(size_px[0], tile_size_px[0]))
    width, height = size_at_zoom(size_px, zoom, tile_size_px[0])
    return TileGrid(
        width_px=width,
        height_px=height,
        tile_width_px=tile_size_px[0],
        tile_height_px=tile_size_px[1],
        zoom=zoom,
    )
