import cv2
import numpy as np
import pytest
from pydantic import ValidationError

from panokit.capture import local_capture
from panokit.errors import ImageError, UsageError
from panokit.frames import angle_between
from panokit.inpaint import InpaintSettings, inpaint
from panokit.inpaint.holes import cap_mask
from panokit.panorama import Panorama
from panokit.provenance import Provenance, Step
from panokit.sphere import equirect_directions

WIDTH = 512
DOWN = (0.0, -1.0, 0.0)
CAP = InpaintSettings(nadir_deg=15.0)
NONE = InpaintSettings(nadir_deg=None)


def near(mask, reach_deg):
    """Every pixel that may be within an angle of a mask; a little more than that near a pole."""
    reach = np.deg2rad(reach_deg)
    directions = equirect_directions(WIDTH, WIDTH // 2)
    edge = mask & ~(cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0)
    cosine = directions.reshape(-1, 3) @ directions[edge].T
    return mask | (cosine.max(axis=1).reshape(mask.shape) > np.cos(reach))


def square(top, bottom, columns):
    mask = np.zeros((WIDTH // 2, WIDTH), bool)
    mask[top:bottom, np.asarray(columns) % WIDTH] = True
    return mask


@pytest.mark.parametrize("method", ["texture", "smooth"])
@pytest.mark.parametrize(
    "hole",
    [
        cap_mask(WIDTH, WIDTH // 2, np.array(DOWN), 15),
        square(120, 160, range(200, 240)),
        square(130, 160, range(-20, 20)),  # across the seam
        square(0, 20, range(WIDTH)),  # the zenith
        square(150, 152, range(100, 102)),  # a speck
        square(120, 150, range(WIDTH)),  # a whole row of tiles
    ],
    ids=["nadir", "tile", "seam", "zenith", "speck", "row"],
)
def test_only_the_hole_and_its_rim_change(textured, panorama_of, hole, method):
    pixels = textured(WIDTH)
    truth = pixels[hole].mean(axis=0)
    pixels[hole] = 0
    settings = InpaintSettings(nadir_deg=None, method=method)
    result = inpaint(panorama_of(pixels, ~hole), settings)
    pixel_deg = 360 / WIDTH
    kept = ~near(hole, settings.rim_deg + 2 * pixel_deg)
    assert result.valid is None
    assert np.array_equal(result.pixels[kept], pixels[kept])
    # Nothing of the black that was in the hole is left, and the light is about right.
    assert result.pixels[hole].max(axis=1).min() > 0
    assert np.allclose(result.pixels[hole].mean(axis=0), truth, atol=25)


def test_without_holes_nothing_changes(textured, panorama_of):
    panorama = panorama_of(textured(WIDTH))
    result = inpaint(panorama)
    assert np.array_equal(result.pixels, panorama.pixels)
    assert result.provenance.steps[-1].values["holes"] == []
    assert result.provenance.steps[-1].values["nadir"] == {"finder": "auto", "found": False}


def test_the_ground_is_filled_with_its_own_grain(textured, panorama_of, cap_around):
    pixels = textured(WIDTH)
    covered = pixels.copy()
    covered[cap_around(WIDTH, DOWN, 15)] = (255, 0, 0)
    result = inpaint(panorama_of(covered), CAP).pixels
    inside, around = cap_around(WIDTH, DOWN, 14), ~cap_around(WIDTH, DOWN, 18)
    around &= cap_around(WIDTH, DOWN, 30)
    # Along the columns only: around the nadir the rows are stretched.
    change = np.abs(np.diff(result[..., 1].astype(float), axis=0, prepend=0))
    assert 0.7 < change[inside].mean() / change[around].mean() < 1.3
    assert np.allclose(result[inside].mean(axis=0), result[around].mean(axis=0), atol=15)


def test_a_smooth_sky_is_filled_smoothly(textured, panorama_of):
    hole = square(30, 60, range(100, 140))
    pixels = textured(WIDTH)
    truth = pixels.copy()
    pixels[hole] = 0
    result = inpaint(panorama_of(pixels, ~hole), NONE)
    (filling,) = result.provenance.steps[-1].values["fillings"]
    assert filling["method"] == "membrane"
    assert np.abs(result.pixels[hole].astype(int) - truth[hole]).max() < 6


def test_the_same_panorama_is_filled_in_the_same_way(textured, panorama_of):
    panorama = panorama_of(textured(WIDTH))
    first, second = inpaint(panorama, CAP), inpaint(panorama, CAP)
    assert np.array_equal(first.pixels, second.pixels)
    assert first.provenance.digest == second.provenance.digest


def test_the_record_says_what_was_filled_and_how_sure_that_is(textured, panorama_of, cap_around):
    pixels = textured(WIDTH)
    pixels[cap_around(WIDTH, DOWN, 20)] = 5
    missing = square(100, 110, range(300, 310))
    step = inpaint(panorama_of(pixels, ~missing)).provenance.steps[-1]
    assert step.stage == "inpaint"
    invalid, nadir = step.values["holes"]
    assert invalid["kind"] == "invalid"
    assert invalid["confidence"] == 1
    tile_sr = np.deg2rad(10 * 360 / WIDTH) * (
        np.sin(np.deg2rad(90 - 100 * 360 / WIDTH)) - np.sin(np.deg2rad(90 - 110 * 360 / WIDTH))
    )
    assert invalid["solid_angle_sr"] == pytest.approx(tile_sr, rel=1e-3)
    assert nadir["kind"] == "nadir"
    assert nadir["confidence"] > 0.85
    cap_sr = 2 * np.pi * (1 - np.cos(np.deg2rad(step.values["nadir"]["radius_deg"])))
    assert nadir["solid_angle_sr"] == pytest.approx(cap_sr, rel=0.03)
    assert step.values["nadir"]["cue"] == "color"
    assert {filling["method"] for filling in step.values["fillings"]} <= {"texture", "membrane"}
    assert len(step.values["fillings"]) == 2


def test_a_mask_takes_the_place_of_the_finder(textured, panorama_of, cap_around):
    pixels = textured(WIDTH)
    logo = cap_around(WIDTH, DOWN, 20)
    pixels[logo] = 5
    marked = square(140, 150, range(10, 30))
    result = inpaint(panorama_of(pixels), mask=marked)
    assert np.all(result.pixels[logo] == 5)
    assert [hole["kind"] for hole in result.provenance.steps[-1].values["holes"]] == ["given"]


def test_the_cap_of_a_leveled_picture_is_below_the_camera_not_below_the_world(textured):
    pose = {"heading_deg": 30.0, "pitch_deg": 12.0, "roll_deg": 5.0}
    capture = local_capture("street", **pose)
    below = capture.world_from_camera.apply(np.array(DOWN))
    stitched = Step(stage="stitch", version="1", values={"leveled": True})
    pixels = textured(WIDTH)
    panorama = Panorama(pixels=pixels, capture=capture, provenance=Provenance((stitched,)))
    result = inpaint(panorama, InpaintSettings(nadir_deg=10.0))
    changed = (result.pixels != pixels).any(axis=2)
    away = angle_between(equirect_directions(WIDTH, WIDTH // 2), below)
    assert changed.any()
    assert np.rad2deg(away[changed].max()) < 12
    assert result.provenance.last("stitch") is not None


@pytest.mark.parametrize("tilts_too", [True, False], ids=["car", "tripod"])
def test_the_cap_of_a_tilted_camera_is_looked_for_below_it_and_plumb(
    textured, cap_around, tilts_too
):
    capture = local_capture("street", heading_deg=30.0, pitch_deg=9.0, roll_deg=4.0)
    below = capture.world_from_camera.apply(np.array(DOWN)) if tilts_too else np.array(DOWN)
    stitched = Step(stage="stitch", version="1", values={"leveled": True})
    pixels = textured(WIDTH)
    logo = cap_around(WIDTH, below, 15)
    pixels[logo] = (255, 0, 255)
    panorama = Panorama(pixels=pixels, capture=capture, provenance=Provenance((stitched,)))
    result = inpaint(panorama)
    red, green, blue = np.moveaxis(result.pixels[logo].astype(int), -1, 0)
    assert (red + blue - 2 * green).max() < 100
    assert result.provenance.steps[-1].values["nadir"]["radius_deg"] == pytest.approx(16, abs=1)


def test_all_hole_is_an_error(textured, panorama_of):
    with pytest.raises(ImageError) as raised:
        inpaint(panorama_of(textured(WIDTH)), mask=np.ones((WIDTH // 2, WIDTH), bool))
    assert raised.value.reason == "all-hole"


@pytest.mark.parametrize(
    "mask", [np.ones((10, 20), bool), np.zeros((WIDTH // 2, WIDTH)), np.zeros((4, 4, 3), bool)]
)
def test_a_mask_that_does_not_fit_is_a_wrong_call(textured, panorama_of, mask):
    with pytest.raises(UsageError, match="mask"):
        inpaint(panorama_of(textured(WIDTH)), mask=mask)


@pytest.mark.parametrize("radius_deg", [0, -3, 80, "always"])
def test_a_cap_has_a_sane_size(radius_deg):
    with pytest.raises(ValidationError):
        InpaintSettings(nadir_deg=radius_deg)


def test_none_can_be_said_in_toml():
    assert InpaintSettings(nadir_deg="none") == NONE
