"""Stanford-ORB's PSNR on a 9x9 object whose eroded mask is 5x5."""

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import orb_psnr_db
from panokit.metrics.orb import eroded_mask

MASK = np.zeros((20, 20), bool)
MASK[5:14, 5:14] = True


def image(value: float) -> np.ndarray:
    return np.full((20, 20, 3), value)


def test_the_margin_of_two_pixels_does_not_count():
    inside = eroded_mask(MASK)
    assert inside.sum() == 25
    truth, estimate = image(0.5), image(0.5)
    estimate[5:7] = 9  # in the margin
    assert orb_psnr_db(estimate, truth, MASK) == float("inf")


def test_the_published_error_is_summed_over_channels_and_floored():
    # Linear, no factors: each of 3 channels is off by 0.1 under a lift of both by
    # srgb(0.7) / 0.7 over the whole frame.
    truth, estimate = image(0.7), image(0.6)
    lift = (1.055 * 0.7 ** (1 / 2.4) - 0.055) / 0.7
    error = (0.1 * lift) ** 2
    options = {"preset": "hdr", "scale_invariant": False}
    published = orb_psnr_db(estimate, truth, MASK, variant="compat", **options)
    assert published == pytest.approx(-10 * np.log10(3 * error))
    frame = orb_psnr_db(estimate, truth, MASK, variant="compat", divide_by="frame", **options)
    assert frame == pytest.approx(-10 * np.log10(error * 25 / 400))
    fixed = orb_psnr_db(estimate, truth, MASK, variant="fixed", **options)
    assert fixed == pytest.approx(10 * np.log10(4**2 / error))


def test_a_bad_method_scores_as_a_grey_image_as_published():
    random = np.random.default_rng(0)
    truth = random.uniform(0.2, 0.8, (20, 20, 3))
    bad, worse = image(0.0), image(1.0)
    options = {"preset": "ldr", "scale_invariant": False}
    compat = [orb_psnr_db(x, truth, MASK, variant="compat", **options) for x in (bad, worse)]
    fixed = [orb_psnr_db(x, truth, MASK, variant="fixed", **options) for x in (bad, worse)]
    assert compat[0] == compat[1]
    assert fixed[0] < fixed[1] - 3


def test_the_factors_take_scale_and_tint_out():
    truth = np.random.default_rng(1).uniform(0.1, 0.9, (20, 20, 3))
    tinted = truth * [0.2, 3.0, 1.1]
    assert orb_psnr_db(tinted, truth, MASK) > 200
    assert orb_psnr_db(tinted, truth, MASK, scale_invariant=False) < 20


def test_wrong_input_is_refused():
    with pytest.raises(ImageError, match="eroded by 5x5"):
        orb_psnr_db(image(1), image(1), np.zeros((20, 20), bool))
    with pytest.raises(UsageError, match="like the mask"):
        orb_psnr_db(image(1)[:10], image(1), MASK)
    with pytest.raises(ImageError, match="not negative"):
        orb_psnr_db(image(-1), image(1), MASK)
    with pytest.raises(UsageError, match="preset"):
        orb_psnr_db(image(1), image(1), MASK, preset="sdr")  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="divided"):
        orb_psnr_db(image(1), image(1), MASK, divide_by="pixels")  # type: ignore[arg-type]
