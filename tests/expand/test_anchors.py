import numpy as np
import pytest
from pydantic import ValidationError

from panokit.capture import Capture
from panokit.color import luminance
from panokit.color.camera import Camera, photograph
from panokit.envmap import Anchor
from panokit.errors import ImageError
from panokit.expand import ExpandSettings, expand
from panokit.frames import Frame, direction_from_azimuth_elevation
from panokit.panorama import Panorama
from panokit.sphere import equirect_directions

SUN = direction_from_azimuth_elevation(np.deg2rad(30), np.deg2rad(40))


@pytest.fixture
def day() -> np.ndarray:
    """A blue sky over dull ground, its sun burnt out in a small disk; (256, 512, 3) uint8."""
    directions = equirect_directions(512, 256)
    radiance = np.where(directions[..., 1:2] > 0, (0.25, 0.35, 0.55), (0.12, 0.11, 0.1))
    radiance[directions @ SUN > np.cos(np.deg2rad(4))] = 3000
    camera = Camera(name="plain", level=(0.05, 0.05))
    return photograph(radiance.astype(np.float32), camera).pixels


def expanded(pixels, capture: Capture, frame: Frame = Frame.LEVEL, **settings):
    panorama = Panorama(pixels=pixels, capture=capture, frame=frame)
    return expand(panorama, ExpandSettings(model="reinhard", width_px=512, **settings))


def test_without_an_anchor_one_is_where_the_picture_clipped(day, capture):
    result = expanded(day, capture)
    assert result.anchor is Anchor.LDR_WHITE
    assert result.provenance.last("expand").values["scale"] == {"factor": 1.0, "by": "clip level"}


def test_a_white_level_gives_luminance(day, capture):
    plain = expanded(day, capture)
    result = expanded(day, capture, anchor_white_cd_m2=5000)
    assert result.anchor is Anchor.LUMINANCE
    assert result.radiance == pytest.approx(5000 * plain.radiance, rel=1e-5)
    assert result.provenance.last("expand").values["scale"]["by"] == "anchor_white_cd_m2"


def test_a_sky_gets_the_luminance_that_was_stated(day, capture):
    result = expanded(day, capture, anchor_sky_cd_m2=4000)
    assert result.anchor is Anchor.LUMINANCE
    up = luminance(result.radiance)[10:100]
    assert np.median(up) == pytest.approx(4000, rel=0.03)


@pytest.mark.parametrize(
    ("name", "anchor"),
    [("anchor_sun_lx", Anchor.LUMINANCE), ("anchor_sun_w_m2", Anchor.RADIANCE)],
)
def test_a_sun_gives_what_was_stated_to_a_surface_that_faces_it(day, capture, name, anchor):
    result = expanded(day, capture, **{name: 900.0})
    assert result.anchor is anchor
    sun = result.provenance.last("expand").values["lighting"]["sun"]
    assert luminance(np.array(sun["irradiance_rgb"])) == pytest.approx(900, rel=1e-3)


def test_a_map_that_does_not_show_what_the_anchor_speaks_of_is_refused(capture):
    dull = np.full((64, 128, 3), 120, np.uint8)
    with pytest.raises(ImageError) as caught:
        expanded(dull, capture, anchor_sun_lx=90000)
    assert caught.value.reason == "no-sun"
    assert "--anchor-white-cd-m2" in str(caught.value)
    night = dull.copy()
    night[:40] = 0
    with pytest.raises(ImageError) as caught:
        expanded(night, capture, anchor_sky_cd_m2=4000)
    assert caught.value.reason == "no-sky"
    for anchor in ({"anchor_sky_cd_m2": 1.0}, {"anchor_sun_lx": 1.0}):
        with pytest.raises(ImageError) as caught:
            expanded(dull, capture, Frame.CAMERA, **anchor)
        assert caught.value.reason == "not-level"


def test_only_one_anchor_can_be_given_and_none_below_zero():
    with pytest.raises(ValidationError, match="only one anchor"):
        ExpandSettings(anchor_white_cd_m2=100, anchor_sun_lx=90000)
    for value in (0.0, -3.0, float("inf"), float("nan")):
        with pytest.raises(ValidationError):
            ExpandSettings(anchor_white_cd_m2=value)
