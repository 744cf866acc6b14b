"""Percentiles among references."""

import pytest

from panokit.qa.distribution import anisotropy, scale_free_figures, standings, upper_share


def test_a_map_stands_where_its_figures_fall():
    references = [{"dynamic-range": float(v), "top-share": None} for v in range(100)]
    (standing,) = standings({"dynamic-range": 25.0, "top-share": 0.5}, references)
    assert standing.name == "dynamic-range"
    assert standing.percentile == pytest.approx(25.5)
    assert standing.median == pytest.approx(49.5)
    assert (standing.low, standing.high) == pytest.approx((4.95, 94.05))


def test_a_figure_that_the_map_lacks_has_no_standing():
    assert standings({"dynamic-range": None}, [{"dynamic-range": 1.0}]) == ()


def test_a_strong_sun_makes_light_uneven_and_puts_it_above_the_horizon(make_map):
    bright, dim = make_map(sun=3e4), make_map(sun=1)
    assert anisotropy(bright) > 0.8 > anisotropy(dim)
    assert upper_share(bright) > 0.95 > upper_share(dim) > 0.5


def test_figures_do_not_depend_on_the_scale(make_map):
    envmap = make_map()
    doubled = envmap.with_changes(radiance=envmap.radiance * 2)
    assert scale_free_figures(doubled) == pytest.approx(scale_free_figures(envmap), rel=1e-5)
