"""The page engine: figures as text, pictures as data."""

import base64

import jinja2
import numpy as np
import pytest

from panokit.io import decode_image
from panokit.qa.report.html import format_figure, format_limit, picture, render_page


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (None, "stops", "–"),
        (0.0, "", "0"),
        (12.3456, "stops", "12.3 stops"),
        (0.123456, "", "0.123"),
        (1234.56, "", "1235"),
        (24.0, "°", "24°"),
        (3.14159, "×", "3.14×"),
        (0.005172, "%", "0.00517 %"),
        (2.5e-7, "", "2.5·10⁻⁷"),
        (1e6, "", "10⁶"),
        (-2.5, "dB", "-2.50 dB"),
    ],
)
def test_figures_read_as_a_person_would_write_them(value, unit, text):
    assert format_figure(value, unit) == text


def test_limits_have_no_idle_zeros():
    assert [format_limit(v) for v in (4.0, 0.003, 1e-4, 0)] == ["4", "0.003", "10⁻⁴", "0"]


def test_a_picture_travels_inside_the_page():
    pixels = np.full((20, 40, 3), (200, 100, 50), np.uint8)
    made = picture(pixels, alt="an orange field")
    head, data = made.uri.split(",")
    assert head == "data:image/jpeg;base64"
    assert (made.width_px, made.height_px) == (40, 20)
    found = decode_image(base64.b64decode(data), what="picture").astype(int)
    assert np.abs(found - pixels).max() < 8


def test_a_name_that_the_context_lacks_is_an_error():
    with pytest.raises(jinja2.UndefinedError):
        render_page("page.html.j2", title="no version given")


def test_any_report_can_stand_on_the_page_alone():
    page = render_page("page.html.j2", title="Dataset <1>", version="9.9")
    assert "<h1>Dataset &lt;1&gt;</h1>" in page
    assert "panokit 9.9" in page
