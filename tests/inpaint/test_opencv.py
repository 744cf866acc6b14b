import numpy as np
import pytest

from panokit.inpaint import InpaintSettings, inpaint
from panokit.inpaint.opencv import OPENCV_METHODS, drawn_by_opencv


@pytest.mark.parametrize("method", OPENCV_METHODS)
@pytest.mark.parametrize("size", [64, 320])
def test_the_hole_is_filled_and_the_rest_stays(method, size):
    rng = np.random.default_rng(0)
    slope = np.linspace(60, 180, size, dtype=np.float32)[None, :, None] + np.zeros((size, 1, 3))
    view = (slope + rng.normal(0, 2, slope.shape)).astype(np.float32)
    y, x = np.mgrid[:size, :size] - size / 2
    known = np.hypot(x, y) > size / 8
    filled = drawn_by_opencv(np.where(known[..., None], view, 0).astype(np.float32), known, method)
    assert np.array_equal(filled[known], view[known])
    assert np.abs(filled - slope)[~known].mean() < (40 if method == "shift-map" else 20)


@pytest.mark.parametrize("method", OPENCV_METHODS)
def test_the_record_says_which_was_used(textured, panorama_of, method):
    settings = InpaintSettings(nadir_deg=12.0, method=method)
    filled = inpaint(panorama_of(textured(512)), settings)
    (filling,) = filled.provenance.steps[-1].values["fillings"]
    assert filling["method"] == method
