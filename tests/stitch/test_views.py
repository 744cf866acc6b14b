from dataclasses import replace

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.stitch import StitchSettings, stitch_views
from panokit.stitch.views import width_for_views

WIDTH = 512
PLAIN = StitchSettings(exposure=False, refine="none")
EVENED = StitchSettings(refine="none")


@pytest.fixture(scope="module")
def gains():
    values = np.exp(np.random.default_rng(3).normal(0, 0.15, 22))
    return values / np.exp(np.log(values).mean())


@pytest.mark.parametrize("blend", ["feather", "bands"])
def test_views_become_the_scene_that_they_were_cut_from(sphere_views, blend):
    scene, views = sphere_views.scene(WIDTH), sphere_views.ring()
    settings = PLAIN.model_copy(update={"blend": blend})
    made = stitch_views(sphere_views.shoot(scene, views), views, WIDTH, settings)
    assert made.valid is None
    assert made.values["coverage"] == 1
    assert sphere_views.psnr(made.pixels, scene) > 36


@pytest.mark.parametrize("blend", ["feather", "bands"])
def test_the_wrap_and_the_poles_are_no_edges(sphere_views, blend, gains):
    """Differences across +-180 degrees are like those elsewhere, also of uneven views."""
    scene, views = sphere_views.scene(WIDTH), sphere_views.ring()
    uneven = sphere_views.shoot(scene, views, gains, 0.15)
    settings = EVENED.model_copy(update={"blend": blend})
    pixels = stitch_views(uneven, views, WIDTH, settings).pixels.astype(np.float32)
    rows = slice(WIDTH // 16, -WIDTH // 16)
    inside = np.abs(np.diff(pixels, axis=1))[rows].mean(axis=(0, 2))
    across = np.abs(pixels[rows, 0] - pixels[rows, -1]).mean()
    assert np.quantile(inside, 0.01) * 0.9 < across < np.quantile(inside, 0.99) * 1.1
    for row in (0, -1):
        opposite = np.roll(pixels[row], WIDTH // 2, axis=0)
        assert np.abs(pixels[row] - opposite).mean() < 4


def test_exposure_and_vignetting_are_evened_out(sphere_views, gains):
    scene, views = sphere_views.scene(WIDTH), sphere_views.ring()
    clean = stitch_views(sphere_views.shoot(scene, views), views, WIDTH, PLAIN)
    uneven = sphere_views.shoot(scene, views, gains, 0.15)
    left = stitch_views(uneven, views, WIDTH, PLAIN)
    evened = stitch_views(uneven, views, WIDTH, EVENED)
    best, worst = (sphere_views.psnr(m.pixels, scene) for m in (clean, left))
    reached = sphere_views.psnr(evened.pixels, scene)
    assert worst < best - 5
    assert reached > best - 0.8
    assert np.allclose(evened.values["gains"], gains, rtol=0.01)
    # The lens passes 0.85 in the corners.
    assert sum(evened.values["falloff"]) == pytest.approx(np.log(0.85), abs=0.02)


def test_floats_are_treated_alike_and_keep_a_sun(sphere_views, gains):
    views = sphere_views.ring()
    radiance = (sphere_views.scene(WIDTH).astype(np.float32) / 255) ** 2.2
    radiance[100:104, 200:204] = 5000.0
    made = stitch_views(sphere_views.shoot(radiance, views, gains, 0.15), views, WIDTH, EVENED)
    assert made.pixels.dtype == np.float32
    assert made.pixels.max() > 3000
    near = made.pixels[150:250] / radiance[150:250]
    assert np.median(near) == pytest.approx(1, abs=0.02)
    assert np.allclose(made.values["gains"], gains, rtol=0.02)


@pytest.mark.parametrize("blend", ["feather", "bands"])
def test_bright_light_does_not_ring_below_zero(sphere_views, blend):
    views = sphere_views.ring()
    radiance = np.full((WIDTH // 2, WIDTH, 3), 0.01, np.float32)
    radiance[120:124, 300:304] = 1e4
    settings = PLAIN.model_copy(update={"blend": blend})
    made = stitch_views(sphere_views.shoot(radiance, views), views, WIDTH, settings)
    assert made.pixels.min() >= 0
    assert np.isfinite(made.pixels).all()


def test_pose_noise_is_taken_out_again(sphere_views):
    scene, views = sphere_views.scene(1024), sphere_views.ring(240)
    rng = np.random.default_rng(5)
    noisy = [
        replace(
            view,
            heading_deg=view.heading_deg + rng.normal(0, 0.5),
            pitch_deg=view.pitch_deg + rng.normal(0, 0.5),
            roll_deg=rng.normal(0, 0.5),
        )
        for view in views
    ]
    pictures = sphere_views.shoot(scene, views)
    left = stitch_views(pictures, noisy, 1024, PLAIN)
    refined = stitch_views(pictures, noisy, 1024, StitchSettings(exposure=False))
    assert sphere_views.psnr(refined.pixels, scene) > sphere_views.psnr(left.pixels, scene) + 4
    assert max(refined.values["pose_moved_deg"]) > 0.3


def test_poses_that_are_right_stay(sphere_views):
    scene, views = sphere_views.scene(1024), sphere_views.ring(240)
    made = stitch_views(sphere_views.shoot(scene, views), views, 1024)
    assert made.views == tuple(views)


def test_masked_strips_do_not_show(sphere_views):
    scene = sphere_views.scene(WIDTH)
    views = [replace(v, masked_px=((0, 112, 120, 120),)) for v in sphere_views.ring()]
    pictures = [picture.copy() for picture in sphere_views.shoot(scene, views)]
    for picture in pictures:
        picture[112:] = (255, 0, 255)
    for blend in ("feather", "bands"):
        settings = StitchSettings(refine="none", blend=blend)
        made = stitch_views(pictures, views, WIDTH, settings)
        shown = made.pixels[made.valid] if made.valid is not None else made.pixels.reshape(-1, 3)
        magenta = (shown[:, 0] > 200) & (shown[:, 1] < 60) & (shown[:, 2] > 200)
        assert not magenta.any()


def test_what_no_view_covers_is_a_hole(sphere_views):
    scene, views = sphere_views.scene(WIDTH), sphere_views.ring()[:3]
    made = stitch_views(sphere_views.shoot(scene, views), views, WIDTH)
    assert made.valid is not None
    rows = np.cos((np.arange(WIDTH // 2) + 0.5) / (WIDTH // 2) * np.pi - np.pi / 2)
    share = np.average(made.valid.mean(axis=1), weights=rows)
    assert made.values["coverage"] == pytest.approx(share, abs=0.001)
    assert 0.3 < share < 0.4
    assert not made.pixels[~made.valid].any()


def test_one_view_is_placed_where_it_looks(sphere_views):
    scene, views = sphere_views.scene(WIDTH), sphere_views.ring()[:1]
    made = stitch_views(sphere_views.shoot(scene, views), views, WIDTH)
    assert made.valid is not None
    center = np.s_[WIDTH // 4 - 20 : WIDTH // 4 + 20, WIDTH // 2 - 20 : WIDTH // 2 + 20]
    assert made.valid[center].all()
    assert np.abs(made.pixels[center].astype(int) - scene[center]).mean() < 3


def test_views_that_do_not_overlap_are_told(sphere_views):
    views = [replace(v, fov_deg=30.0) for v in sphere_views.ring()[:8:2]]
    made = stitch_views(sphere_views.shoot(sphere_views.scene(WIDTH), views), views, WIDTH)
    assert made.values["views_without_overlap"] == [0, 1, 2, 3]
    assert made.values["gains"] == [1, 1, 1, 1]


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        (lambda v: replace(v, pitch_deg=-v.pitch_deg), "pitch_deg positive looking down"),
        (lambda v: replace(v, heading_deg=-v.heading_deg), "counterclockwise"),
        (lambda v: replace(v, pitch_deg=v.pitch_deg + 90), "tilt that is 90"),
    ],
)
def test_wrong_signs_are_named(sphere_views, wrong, named):
    views = sphere_views.ring()
    pictures = sphere_views.shoot(sphere_views.scene(WIDTH), views)
    with pytest.raises(ImageError, match=named) as caught:
        stitch_views(pictures, [wrong(view) for view in views], WIDTH)
    assert caught.value.reason == "views-disagree"


def test_exposures_four_stops_apart(sphere_views):
    """As far as eight bits tell; what they show of the same wall becomes the same."""
    scene, views = sphere_views.scene(WIDTH), sphere_views.ring()
    gains = np.where(np.arange(22) % 2, 0.25, 4.0)
    dim = (scene * 0.35).astype(np.uint8)
    made = stitch_views(sphere_views.shoot(dim, views, gains), views, WIDTH, EVENED)
    ratio = np.log2(np.array(made.values["gains"]))
    assert ratio[::2].mean() - ratio[1::2].mean() == pytest.approx(4, abs=0.15)


def test_large_views_are_made_smaller_without_aliasing(sphere_views):
    views = sphere_views.ring(240)
    stripes = np.zeros((512, 1024, 3), np.uint8)
    stripes[:, ::2] = 255
    pictures = sphere_views.shoot(np.repeat(np.repeat(stripes, 2, 0), 2, 1), views)
    made = stitch_views(pictures, views, 128, PLAIN)
    assert made.pixels[32, :, 0].astype(float).std() < 30


def test_the_width_is_what_the_views_are_worth(sphere_views):
    views = sphere_views.ring(640)
    assert width_for_views(views, None) == 1984
    assert width_for_views(views, 1024) == 1024


def test_wrong_calls(sphere_views):
    views = sphere_views.ring()[:2]
    pictures = sphere_views.shoot(sphere_views.scene(WIDTH), views)
    with pytest.raises(UsageError, match="2 pictures and 1 views"):
        stitch_views(pictures, views[:1], WIDTH)
    with pytest.raises(UsageError, match="at least one"):
        stitch_views([], [], WIDTH)
    with pytest.raises(UsageError, match="uint8"):
        stitch_views([pictures[0], pictures[1].astype(np.float32)], views, WIDTH)
    with pytest.raises(UsageError, match="even"):
        stitch_views(pictures, views, 511)
    with pytest.raises(ImageError, match="as its record says"):
        stitch_views([pictures[0], pictures[1][1:]], views, WIDTH)
    with pytest.raises(ImageError, match="infinite"):
        stitch_views([p.astype(np.float32) * np.nan for p in pictures], views, WIDTH)
