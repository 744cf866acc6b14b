"""Sizes at each zoom, against those that Google's own metadata gives for ten panoramas."""

import pytest

from panokit.errors import UsageError
from panokit.fetch.zoom import deepest_zoom, grid_at_zoom, size_at_zoom, zoom_for_width

MEASURED_WIDTHS = {
    16384: [512, 1024, 2048, 4096, 8192, 16384],
    13312: [416, 832, 1664, 3328, 6656, 13312],
    5376: [336, 672, 1344, 2688, 5376],
    3328: [416, 832, 1664, 3328],
}


@pytest.mark.parametrize(("full", "widths"), MEASURED_WIDTHS.items())
def test_sizes_are_as_measured(full, widths):
    assert deepest_zoom(full) == len(widths) - 1
    for zoom, width in enumerate(widths):
        assert size_at_zoom((full, full // 2), zoom) == (width, width // 2)


@pytest.mark.parametrize(
    ("full", "zoom", "columns", "rows"),
    [
        (16384, 0, 1, 1),
        (16384, 3, 8, 4),
        (16384, 5, 32, 16),
        (13312, 3, 7, 4),
        (13312, 4, 13, 7),
        (12000, 3, 6, 3),
        (5376, 4, 11, 6),
        (3328, 3, 7, 4),
    ],
)
def test_tiles_are_counted_by_the_real_size(full, zoom, columns, rows):
    grid = grid_at_zoom((full, full // 2), (512, 512), zoom)
    assert (grid.columns, grid.rows) == (columns, rows)


def test_a_zoom_that_a_small_picture_does_not_have_becomes_its_deepest():
    grid = grid_at_zoom((3328, 1664), (512, 512), 5)
    assert (grid.zoom, grid.width_px) == (3, 3328)


@pytest.mark.parametrize(
    ("wanted", "full", "zoom"),
    [
        (4096, 16384, 3),
        (4097, 16384, 4),
        (4096, 13312, 4),
        (3328, 13312, 3),
        (9000, 3328, 3),
        (1, 512, 0),
    ],
)
def test_the_first_zoom_that_is_wide_enough(wanted, full, zoom):
    assert zoom_for_width(wanted, full) == zoom


def test_no_width_is_no_picture():
    with pytest.raises(UsageError):
        deepest_zoom(0)
