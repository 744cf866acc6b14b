"""Inputs for metrics that are programs of their own; ColorVideoVDP itself is played."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.metrics import Viewing, absolute_views, colorvideovdp_jod
from panokit.sphere import equirect_directions


def test_pixels_per_degree_of_the_published_setting():
    # 24 inches at 16:9 are 0.2989 m high; at 1 m that is 17.0 degrees for 1080 rows.
    height_m = 24 * 0.0254 * 9 / np.hypot(16, 9)
    degrees = 2 * np.degrees(np.arctan(height_m / 2))
    assert Viewing().pixels_per_degree == pytest.approx(1080 / degrees)
    assert Viewing(distance_m=2).pixels_per_degree > 1.9 * Viewing().pixels_per_degree
    with pytest.raises(UsageError, match="distance"):
        Viewing(distance_m=0)


def test_views_look_front_right_back_left_and_are_absolute():
    directions = equirect_directions(128, 64)
    # Light from the east (+X) only.
    radiance = np.maximum(directions[..., :1], 0).repeat(3, 2)
    views = absolute_views(radiance, radiance, white_cd_m2=200, size_px=33)
    assert views.test.shape == (4, 33, 33, 3)
    assert views.test.dtype == np.float32
    middles = views.reference[:, 16, 16, 0]
    assert middles == pytest.approx([0, 200, 0, 0], abs=4)
    # To the front, the east is on the right.
    assert views.test[0, 16, 32, 0] > 100
    assert views.test[0, 16, 0, 0] == 0


def test_the_unit_of_white_is_checked():
    radiance = np.ones((16, 32, 3), np.float32)
    with pytest.raises(UsageError, match="cd/m2"):
        absolute_views(radiance, radiance, white_cd_m2=0)


class PlayedMetric:
    """Answers as pycvvdp does, with the mean difference taken off 10."""

    def __init__(self, display_name: str) -> None:
        self.display = display_name

    def predict(self, test, reference, dim_order):
        assert dim_order == "HWC"
        return np.float32(10 - np.abs(test - reference).mean()), None

    def get_info_string(self) -> str:
        return f"ColorVideoVDP v0.5.7, {self.display}"


def test_the_jod_is_the_mean_over_views_with_the_settings_it_names(monkeypatch):
    monkeypatch.setitem(sys.modules, "pycvvdp", SimpleNamespace(cvvdp=PlayedMetric))
    truth = np.ones((32, 64, 3), np.float32)
    views = absolute_views(truth * 0.98, truth, size_px=16)
    score = colorvideovdp_jod(views)
    assert score.jod == pytest.approx(10 - 2, abs=1e-3)
    assert score.settings == "ColorVideoVDP v0.5.7, standard_hdr_linear"


def test_without_the_package_the_remedy_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pycvvdp", None)
    truth = np.ones((32, 64, 3), np.float32)
    with pytest.raises(UsageError, match="pip install cvvdp"):
        colorvideovdp_jod(absolute_views(truth, truth, size_px=16))
