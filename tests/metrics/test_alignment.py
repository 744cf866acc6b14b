import numpy as np
import pytest

from panokit.errors import ItemError
from panokit.metrics import alignment_gain


def test_the_gain_is_found_where_the_picture_is_not_clipped():
    random = np.random.default_rng(0)
    truth = random.uniform(0.1, 0.9, (16, 32, 3)).astype(np.float32)
    ldr = (truth * 200).astype(np.uint8) + 20
    estimate = truth / 3
    # What lies under a clipped pixel, at either end, must not count.
    truth[3, 4], ldr[3, 4] = 1e6, 255
    estimate[9, 9], ldr[9, 9] = 1e6, 0
    assert alignment_gain(estimate, truth, ldr) == pytest.approx(3, rel=1e-5)


def test_the_weights_are_solid_angles():
    ldr = np.full((2, 4, 3), 128, np.uint8)
    estimate = np.ones((2, 4, 3), np.float32)
    truth = estimate.copy()
    truth[0], truth[1] = 1, 3
    assert alignment_gain(estimate, truth, ldr) == pytest.approx(2)  # both rows cover half


def test_a_picture_clipped_everywhere_cannot_be_aligned():
    with pytest.raises(ItemError) as caught:
        alignment_gain(
            np.ones((8, 16, 3), np.float32),
            np.ones((8, 16, 3), np.float32),
            np.full((8, 16, 3), 255, np.uint8),
        )
    assert caught.value.reason == "nothing-unclipped"
