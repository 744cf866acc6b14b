"""Pairs meet in one frame, at one size, on one scale."""

import numpy as np
import pytest

from panokit.envmap import Anchor
from panokit.errors import ItemError
from panokit.frames import Frame
from panokit.qa.pairs import align_pair


def test_relative_maps_meet_on_the_scale_of_the_camera(make_map):
    truth = make_map(256)
    darker = truth.with_changes(radiance=truth.radiance / np.float32(3))
    pair = align_pair(darker, truth, 128)
    assert pair.gain == pytest.approx(3, rel=1e-3)
    assert pair.estimate.shape == pair.truth.shape == (64, 128, 3)
    np.testing.assert_allclose(pair.estimate, pair.truth, rtol=2e-3)


def test_absolute_maps_keep_their_scale(make_map):
    truth = make_map(128).with_changes(anchor=Anchor.LUMINANCE)
    darker = truth.with_changes(radiance=truth.radiance / np.float32(3))
    pair = align_pair(darker, truth, 512)
    assert pair.gain == 1
    assert float(pair.truth.sum() / pair.estimate.sum()) == pytest.approx(3, rel=1e-4)


def test_what_cannot_be_compared_is_told(make_map):
    with pytest.raises(ItemError, match="frame is camera") as caught:
        align_pair(make_map(128).with_changes(frame=Frame.CAMERA), make_map(128), 128)
    assert caught.value.reason == "other-frame"
    black = make_map(128).with_changes(radiance=np.zeros((64, 128, 3), np.float32))
    with pytest.raises(ItemError, match="black where the map is not"):
        align_pair(make_map(128), black, 128)


def test_a_lamp_that_the_estimate_misses_does_not_decide_the_gain(make_map):
    truth = make_map(128, sun=3e5).with_changes(anchor=Anchor.RELATIVE)
    dull = truth.with_changes(radiance=np.minimum(truth.radiance, np.float32(0.4)) / 2)
    assert align_pair(dull, truth, 128).gain == pytest.approx(2, rel=0.2)
