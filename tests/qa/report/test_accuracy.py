"""Good, fair and poor: the bounds, and the medians of the page's head."""

import pytest

from panokit.qa.batch import JudgedMap
from panokit.qa.comparison import Comparison, Difference
from panokit.qa.items import QaItem
from panokit.qa.report.accuracy import explanation, grade_of, medians


def judged(tmp_path, **values):
    differences = tuple(
        Difference(name=name.replace("_", "-"), label="", value=value, unit="", meaning="")
        for name, value in values.items()
    )
    item = QaItem(name="a", map_path=tmp_path / "a.exr")
    return JudgedMap(item=item, comparison=Comparison(reference="a", differences=differences))


@pytest.mark.parametrize(
    ("name", "value", "grade"),
    [
        ("irradiance-error", 20, "good"),
        ("irradiance-error", 20.1, "fair"),
        ("irradiance-error", 50.1, "poor"),
        ("light-direction", 12, "good"),
        ("light-direction", 30, "fair"),
        ("light-direction", 30.1, "poor"),
        ("light-direction", None, ""),
        ("mirror-ball", 99, ""),
    ],
)
def test_bounds_belong_to_the_better_grade(name, value, grade):
    assert grade_of(name, value) == grade


def test_medians_are_over_the_maps_that_have_a_reference(tmp_path):
    maps = [judged(tmp_path, irradiance_error=e, light_direction=5) for e in (10, 40, 90)]
    maps.append(JudgedMap(item=QaItem(name="b", map_path=tmp_path / "b.exr")))
    assert [(m.label, m.value, m.grade) for m in medians(maps)] == [
        ("median irradiance error", "40 %", "fair"),
        ("median light direction error", "5°", "good"),
    ]
    assert "(3 maps have one)" in explanation(maps)
    assert medians(maps[-1:]) == ()
