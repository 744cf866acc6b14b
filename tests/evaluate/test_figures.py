import numpy as np
import pytest

from panokit.evaluate.figures import LINES, by_category, summarize_rows
from panokit.evaluate.scoring import Row


def row(index: int, *, strong: bool = False, category: str = "room", **values) -> Row:
    return Row(
        method="m", probe=f"p{index}", category=category, camera="A", fold=0, seen=False,
        strong=strong, values=values,
    )  # fmt: skip


def line(key: str):
    return next(one for one in LINES if one.key == key)


def test_figures_are_medians_means_and_tails_of_what_they_say():
    ratios = [0.25, 0.5, 1.0, 2.0, 4.0]
    rows = [row(i, energy_ratio=r, light_vector_deg=10.0 * i) for i, r in enumerate(ratios)]
    figures = summarize_rows(rows)
    assert figures["energy_median"]["value"] == 1.0
    assert figures["energy_stops_median"]["value"] == 1.0
    assert figures["energy_stops_p90"]["value"] == pytest.approx(2.0)
    assert figures["light_vector_mean"]["value"] == 20.0
    assert figures["light_vector_median"]["value"] == 20.0
    assert figures["ball_median"] is None
    assert figures["energy_median"]["n"] == 5


def test_intervals_hold_the_value_widen_with_the_spread_and_repeat():
    random = np.random.default_rng(1)
    narrow = [row(i, irradiance_mean=x) for i, x in enumerate(random.normal(0.3, 0.01, 40))]
    wide = [row(i, irradiance_mean=x) for i, x in enumerate(random.normal(0.3, 0.1, 40))]
    first, second = (summarize_rows(rows)["irradiance_mean"] for rows in (narrow, wide))
    for figure in (first, second):
        assert figure["low"] <= figure["value"] <= figure["high"]
    assert second["high"] - second["low"] > 5 * (first["high"] - first["low"])
    assert summarize_rows(wide)["irradiance_mean"] == second
    # The interval of a mean of 40 draws of deviation 0.1.
    assert second["high"] - second["low"] == pytest.approx(2 * 1.645 * 0.1 / np.sqrt(40), rel=0.3)


def test_strong_scenes_have_their_own_lines():
    rows = [row(0, strong=True, energy_ratio=0.5, peak_deg=3.0, sun_stops=-2.0),
            row(1, energy_ratio=1.0, peak_deg=90.0, sun_stops=0.0)]  # fmt: skip
    figures = summarize_rows(rows)
    assert figures["strong_energy_median"] | {"low": 0, "high": 0} == {
        "value": 0.5, "low": 0, "high": 0, "n": 1,
    }  # fmt: skip
    assert figures["strong_peak_median"]["value"] == 3.0
    assert figures["strong_sun_stops_median"]["value"] == 2.0


def test_rolls_are_the_mean_over_their_shifts_and_probes():
    rows = [row(0, roll_256=0.0, roll_512=0.002, roll_1=0.01, roll_37=0.02, roll_211=0.03), row(1)]
    figures = summarize_rows(rows)
    assert figures["roll_stride_mean"]["value"] == pytest.approx(0.001)
    assert figures["roll_other_mean"]["value"] == pytest.approx(0.02)
    assert figures["roll_other_mean"]["n"] == 1


@pytest.mark.parametrize(
    ("key", "camera", "good", "bad"),
    [
        ("energy_median", "A", 1.0, 1.2),
        ("irradiance_median", "B", 0.2, 0.21),
        ("pu21_crf_mean", "A", 29.2, 28.9),
        ("pu21_crf_mean", "B", 29.8, 29.2),
        ("strong_energy_median", "A", 0.7, 0.69),
        ("cpu_seconds_median", "A", 0.4, 0.6),
    ],
)
def test_goals_are_those_of_their_camera(key, camera, good, bad):
    assert line(key).reaches(good, camera)
    assert not line(key).reaches(bad, camera)


def test_lines_without_a_goal_reach_none():
    assert line("pu21_mean").goal_of("A") is None
    assert not line("pu21_mean").reaches(99, "A")


def test_categories_are_counted_and_summed_apart():
    rows = [row(0, category="sky", irradiance_mean=0.1), row(1, irradiance_mean=0.4),
            row(2, irradiance_mean=0.6)]  # fmt: skip
    table = by_category(rows, ("irradiance_median", "energy_median"))
    assert table["room"]["n"] == 2
    assert table["room"]["energy_median"] is None
    figure = table["room"]["irradiance_median"]
    assert figure["value"] == 0.5
    assert 0.4 <= figure["low"] < 0.5 < figure["high"] <= 0.6
    assert table["sky"]["irradiance_median"]["value"] == 0.1
