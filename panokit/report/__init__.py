"""The report engine: a list of sections becomes one HTML file that asks nothing of any server.

It knows nothing of QA, data sets or scores; each of them writes its report in these words.

values    what a report is made of: counts, text, tables, charts, pictures, galleries of maps
layers    a map or a photograph, packed for the viewer in the page
entries   a map with its thumbnail and its layers
bfloat    the coding of radiance in the page
pictures  pictures inside the page
charts    the drawing of histograms and cumulative curves; axis, their numbers
plain     any JSON as sections
wording   figures as a person would write them
page      the file itself
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.report.entries import light_map
    from panokit.report.layers import Layer, layer_width_px, photo_layer, radiance_layer
    from panokit.report.page import render_page, render_viewer, write_page
    from panokit.report.pictures import Picture, picture
    from panokit.report.plain import sections_of
    from panokit.report.values import (
        Badge,
        Cell,
        Chart,
        Charts,
        Column,
        Count,
        Counts,
        Gallery,
        Group,
        MapEntry,
        Mark,
        Page,
        Pictures,
        Section,
        Series,
        Table,
        Text,
    )
    from panokit.report.wording import format_figure, format_limit

_VALUES = (
    "Badge",
    "Cell",
    "Chart",
    "Charts",
    "Column",
    "Count",
    "Counts",
    "Gallery",
    "Group",
    "MapEntry",
    "Mark",
    "Page",
    "Pictures",
    "Section",
    "Series",
    "Table",
    "Text",
)

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        **dict.fromkeys(_VALUES, "panokit.report.values"),
        "Layer": "panokit.report.layers",
        "Picture": "panokit.report.pictures",
        "format_figure": "panokit.report.wording",
        "format_limit": "panokit.report.wording",
        "layer_width_px": "panokit.report.layers",
        "light_map": "panokit.report.entries",
        "photo_layer": "panokit.report.layers",
        "picture": "panokit.report.pictures",
        "radiance_layer": "panokit.report.layers",
        "render_page": "panokit.report.page",
        "render_viewer": "panokit.report.page",
        "sections_of": "panokit.report.plain",
        "write_page": "panokit.report.page",
    },
)
