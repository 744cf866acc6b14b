"""The page engine: a template and a context become one HTML file that needs nothing else.

It knows nothing of QA. Any report extends the template `page.html.j2`, which brings the style,
the heading and the footer, and shows `Picture` values with the macros of `parts.html.j2`.
"""

import base64
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import jinja2
import numpy as np
from numpy.typing import NDArray

from panokit.io import encode_jpeg

_MISSING = "–"


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """An image inside the page.

    Attributes:
        uri: A data URI.
        width_px: Of the pixels.
        height_px: Of the pixels.
        alt: What it shows, for those who cannot see it.
        caption: The line below it.
        disc: Whether it is cut to a disc.
    """

    uri: str
    width_px: int
    height_px: int
    alt: str
    caption: str = ""
    disc: bool = False


def picture(
    pixels: NDArray[np.uint8],
    *,
    alt: str,
    caption: str = "",
    quality: int = 80,
    disc: bool = False,
) -> Picture:
    """A picture for the page from (H, W, 3) display-encoded pixels, as JPEG."""
    height, width = pixels.shape[:2]
    encoded = base64.b64encode(encode_jpeg(pixels, quality=quality)).decode()
    return Picture(
        uri=f"data:image/jpeg;base64,{encoded}",
        width_px=width,
        height_px=height,
        alt=alt,
        caption=caption,
        disc=disc,
    )


def render_page(template: str, **context: Any) -> str:
    """The page of a template of this package; a name missing from the context is an error."""
    return _environment().get_template(template).render(**context)


def format_figure(value: float | None, unit: str = "") -> str:
    """A figure with three significant digits and its unit, as a person would write it."""
    if value is None:
        return _MISSING
    if value == 0 or (float(value).is_integer() and abs(value) < 1e4):
        text = f"{value:.0f}"
    elif 1e-3 <= abs(value) < 1e4:
        digits = max(0, 2 - int(np.floor(np.log10(abs(value)))))
        text = f"{value:.{digits}f}"
    else:
        text = _power_of_ten(value)
    gap = "" if unit in ("", "°", "×") else " "
    return f"{text}{gap}{unit}"


def format_limit(value: float) -> str:
    """A threshold, which is a round number, without idle zeros."""
    return f"{value:g}" if value == 0 or 1e-3 <= abs(value) < 1e4 else _power_of_ten(value)


def _power_of_ten(value: float) -> str:
    mantissa, exponent = f"{value:.1e}".replace(".0e", "e").split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{raised}" if mantissa == "1" else f"{mantissa}·10{raised}"


@lru_cache(maxsize=1)
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("panokit.qa.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["figure"] = format_figure
    return environment
