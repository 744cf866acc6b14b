"""Pictures of maps: exposures, false color, balls."""

import numpy as np
import pytest

from panokit.envmap import Anchor, EnvironmentMap
from panokit.qa.report import pictures


@pytest.mark.parametrize(
    ("peak", "stops"),
    [(0.5, (0, -1, -2, -3)), (8, (0, -1, -2, -3)), (60, (0, -2, -4, -6)),
     (6e4, (0, -4, -8, -12))],
)  # fmt: skip
def test_brackets_reach_from_the_picture_to_its_peak(peak, stops):
    assert pictures.bracket_stops(peak) == stops


def test_each_exposure_is_darker_and_the_first_is_the_cameras_own(make_map):
    envmap = make_map()
    shown = pictures.exposures(envmap)
    means = [e.pixels.mean() for e in shown]
    assert means == sorted(means, reverse=True)
    # The sky's blue, 0.8, is sRGB 231.
    assert shown[0].pixels[10, 5, 2] == 231


def test_a_map_of_unknown_scale_is_exposed_by_its_median(make_map):
    envmap = make_map().with_changes(anchor=Anchor.RELATIVE)
    brighter = envmap.with_changes(radiance=envmap.radiance * np.float32(64))
    first, same = (pictures.exposures(m)[0].pixels.astype(int) for m in (envmap, brighter))
    assert np.abs(first - same).max() <= 1


def test_false_color_is_bright_where_the_map_is(make_map):
    legend = pictures.false_color_legend()[0].astype(int)

    def place_on_legend(color):
        return int(np.abs(legend - color).sum(axis=1).argmin())

    envmap = make_map()
    shown = pictures.false_color(envmap)
    row, column = np.unravel_index(envmap.radiance.sum(axis=2).argmax(), (128, 256))
    assert place_on_legend(shown[row, column]) > 450
    assert place_on_legend(shown[row, column]) > place_on_legend(shown[120, 5]) + 100


def test_a_black_map_has_pictures_too():
    black = EnvironmentMap(radiance=np.zeros((32, 64, 3), np.float32))
    assert pictures.false_color(black).shape == (32, 64, 3)
    assert len(pictures.exposures(black)) == 4
    assert pictures.balls(black).mirror.shape == (pictures.BALL_PX, pictures.BALL_PX, 3)


def test_balls_of_two_maps_share_an_exposure(make_map):
    truth = make_map()
    dim = truth.with_changes(radiance=truth.radiance * np.float32(0.25))
    right = pictures.balls(truth)
    compared = pictures.balls(dim, exposure=right.exposure)
    alone = pictures.balls(dim)
    middle = pictures.BALL_PX // 2
    assert compared.diffuse[middle, middle].sum() < 0.7 * right.diffuse[middle, middle].sum()
    assert np.abs(alone.diffuse.astype(int) - right.diffuse.astype(int)).max() <= 2
