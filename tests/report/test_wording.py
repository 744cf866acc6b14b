"""Figures as text."""

import pytest

from panokit.report import format_figure, format_limit
from panokit.report.wording import words_of


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (None, "stops", "–"),
        (float("nan"), "", "–"),
        (float("inf"), "dB", "∞ dB"),
        (0.0, "", "0"),
        (12.3456, "stops", "12.3 stops"),
        (0.123456, "", "0.123"),
        (1234.56, "", "1235"),
        (24.0, "°", "24°"),
        (3.14159, "×", "3.14×"),
        (0.005172, "%", "0.00517 %"),
        (2.5e-7, "", "2.5·10⁻⁷"),
        (1e6, "", "10⁶"),
        (-2.5, "dB", "−2.50 dB"),
    ],
)
def test_figures_read_as_a_person_would_write_them(value, unit, text):
    assert format_figure(value, unit) == text


def test_limits_have_no_idle_zeros():
    assert [format_limit(v) for v in (4.0, 0.003, 1e-4, 0)] == ["4", "0.003", "10⁻⁴", "0"]


def test_keys_become_words():
    assert [words_of(k) for k in ("wrap-seam", "top_share", "PU21", "")] == [
        "Wrap seam",
        "Top share",
        "PU21",
        "",
    ]
