"""Holes in HDR maps."""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError, UsageError
from panokit.inpaint import InpaintSettings, inpaint
from panokit.inpaint.opencv import OPENCV_METHODS

WIDTH = 512
CAP = InpaintSettings(nadir_deg=15.0)


@pytest.fixture
def lit(textured, cap_around):
    """Gravel in radiance with a lamp 10,000 times brighter beside the hole."""
    radiance = ((textured(WIDTH) / 255.0) ** 2.2 * 0.1).astype(np.float32)
    lamp = cap_around(WIDTH, (0.5, -0.85, 0.1), 3)
    radiance[lamp] = 200.0
    return radiance, lamp


@pytest.mark.parametrize("method", ["texture", "smooth", *OPENCV_METHODS])
def test_a_lamp_beside_the_hole_does_not_bleed_into_it(lit, cap_around, method):
    radiance, lamp = lit
    hole = cap_around(WIDTH, (0, -1, 0), 15)
    around = cap_around(WIDTH, (0, -1, 0), 28) & ~hole & ~lamp
    settings = InpaintSettings(nadir_deg=15.0, method=method)
    filled = inpaint(EnvironmentMap(radiance=radiance), settings).radiance
    assert filled.dtype == np.float32
    ratio = filled[hole].mean() / radiance[around].mean()
    assert 0.6 < ratio < (1.7 if method in ("texture", "smooth") else 8)
    if method == "texture":
        assert filled[hole].max() < 2 * radiance[around].max()


@pytest.mark.parametrize("method", ["texture", "smooth"])
def test_outside_the_rim_every_value_stays(lit, cap_around, method):
    radiance, lamp = lit
    settings = InpaintSettings(nadir_deg=15.0, method=method)
    filled = inpaint(EnvironmentMap(radiance=radiance), settings).radiance
    kept = ~cap_around(WIDTH, (0, -1, 0), 17.5)
    assert np.array_equal(filled[kept], radiance[kept])
    assert filled[lamp].max() == 200.0


def test_the_scale_of_the_map_does_not_matter(lit):
    radiance, _ = lit
    once = inpaint(EnvironmentMap(radiance=radiance), CAP).radiance
    brighter = inpaint(EnvironmentMap(radiance=radiance * np.float32(64)), CAP).radiance
    assert np.allclose(brighter, 64 * once, rtol=1e-3, atol=1e-3)


def test_a_cap_is_found_in_a_map_as_in_a_picture(lit, cap_around):
    radiance, _ = lit
    radiance = radiance.copy()
    plate = cap_around(WIDTH, (0, -1, 0), 12)
    radiance[plate] = 0.3
    envmap = EnvironmentMap(radiance=radiance)
    filled = inpaint(envmap)
    step = filled.provenance.steps[-1]
    assert [hole["kind"] for hole in step.values["holes"]] == ["nadir"]
    assert filled.radiance[plate].mean() < 0.06


def test_a_map_without_holes_comes_back_as_it_was(lit):
    envmap = EnvironmentMap(radiance=lit[0])
    same = inpaint(envmap, InpaintSettings(nadir_deg=None))
    assert np.array_equal(same.radiance, envmap.radiance)
    assert same.provenance.steps[-1].values["fillings"] == []


def test_bad_masks_are_named(lit):
    envmap = EnvironmentMap(radiance=lit[0])
    with pytest.raises(UsageError, match="mask"):
        inpaint(envmap, mask=np.ones((4, 8), bool))
    with pytest.raises(ImageError, match="all hole"):
        inpaint(envmap, mask=np.ones((WIDTH // 2, WIDTH), bool))
