"""The drawing of distributions, and the numbers along their axes."""

import re

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.report import Chart, Mark, Series
from panokit.report.charts import draw

VALUES = tuple(np.random.default_rng(0).normal(10, 2, 400))


def chart(*values, **options):
    series = tuple(Series(label=f"set {i}", values=v) for i, v in enumerate(values or (VALUES,)))
    return Chart(title="Range", series=series, **options)


def test_bars_have_the_heights_of_their_counts():
    drawing = draw(chart((1.0,) * 6 + (2.0,) * 3 + (3.0,)))
    heights = [bar.height for bar in drawing.series[0].bars]
    assert heights[0] == pytest.approx(drawing.floor - drawing.top)
    np.testing.assert_allclose(np.array(heights) / heights[0], [1, 0.5, 1 / 6], atol=0.01)
    assert [bar.title.split(": ")[1] for bar in drawing.series[0].bars] == [
        "6 of 10",
        "3 of 10",
        "1 of 10",
    ]
    assert drawing.y_ticks[1].label == "6"


def test_two_sets_are_drawn_as_shares():
    drawing = draw(chart((1.0, 2.0), (1.0,) * 50 + (2.0,) * 50))
    assert drawing.y_ticks[1].label == "50 %"
    assert not drawing.series[1].bars
    tops = {float(y) for y in re.findall(r"V([\d.]+)", drawing.series[1].path)}
    assert min(tops) == pytest.approx(drawing.top)


def test_a_cumulative_curve_rises_to_the_top_at_the_largest_value():
    drawing = draw(chart((3.0, 1.0, 2.0, 2.0), kind="ecdf"))
    steps = re.findall(r"H([\d.]+)V([\d.]+)", drawing.series[0].path)
    heights = [float(y) for _, y in steps]
    assert heights == sorted(heights, reverse=True)
    assert heights[-1] == drawing.top
    assert [float(x) for x, _ in steps] == sorted(float(x) for x, _ in steps)
    assert steps[1][0] == steps[2][0]


def test_what_is_counted_already_is_drawn_as_given():
    bins = draw(chart((1.0, 3.0), kind="bins", at=(0.0, 1.0, 4.0)))
    narrow, wide = bins.series[0].bars
    assert wide.width + 1 == pytest.approx(3 * (narrow.width + 1), abs=0.1)
    assert wide.height == pytest.approx(3 * narrow.height, abs=0.1)
    curve = draw(chart((0.0, 0.5, 1.0), kind="curve", at=(0.0, 1.0, 2.0)))
    places = re.findall(r"([\d.]+) ([\d.]+)", curve.series[0].path)
    assert float(places[1][1]) == pytest.approx((curve.top + curve.floor) / 2)
    with pytest.raises(UsageError, match="needs 2 values"):
        chart((1.0, 2.0, 3.0), kind="bins", at=(0.0, 1.0, 2.0))


def test_limits_are_drawn_where_they_are_near_and_told_in_any_case():
    marks = (Mark(label="at most", value=18.0), Mark(label="far", value=500.0))
    drawing = draw(chart(marks=marks, unit="stops"))
    assert [mark.label for mark in drawing.marks] == ["at most"]
    assert drawing.left < drawing.marks[0].at < drawing.right
    assert "far: 500 stops" in drawing.description


def test_ticks_are_round_numbers_within_the_axis():
    for drawing in (draw(chart()), draw(chart((1e-3, 1.0, 40.0), log=True)), draw(chart((5.0,)))):
        assert 2 <= len(drawing.x_ticks) <= 6
        assert all(drawing.left <= t.at <= drawing.right for t in drawing.x_ticks)
    assert [t.label for t in draw(chart((1e-3, 1.0, 40.0), log=True)).x_ticks] == [
        "0.001", "0.01", "0.1", "1", "10",
    ]  # fmt: skip
    assert [t.label for t in draw(chart((0.0, 10.0))).x_ticks] == ["0", "5", "10"]


def test_what_cannot_be_drawn_is_counted():
    drawing = draw(chart((1.0, 2.0, float("nan"), float("inf"), -1.0, 0.0), log=True))
    assert drawing.summary[0].cells[0] == "2"
    assert drawing.summary[0].cells[-1] == "4"
    empty = draw(chart((float("nan"),)))
    assert empty.summary[0].cells == ("0", "–", "–", "–", "–", "–", "1")
    assert not empty.series[0].bars


def test_a_chart_says_in_words_what_it_shows():
    said = draw(chart((1.0, 2.0, 4.0), unit="stops")).description
    assert said == "Histogram of Range. set 0: 3 values from 1 to 4 stops, median 2 stops."


def test_a_chart_has_one_to_four_series():
    with pytest.raises(UsageError, match="0 series"):
        Chart(title="none", series=())
