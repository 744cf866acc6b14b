import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere import (
    MIRROR_BALL,
    SKY_DOME,
    Cubemap,
    Equirectangular,
    Octahedral,
    Perspective,
    apply_map,
    energy_ledger,
    equirect_directions,
    perspective_view,
    pixel_grid,
    pixel_map,
    reproject,
    resize_radiance,
    rotate_radiance,
)
from panokit.sphere.pixel_map import _Kept

SPHERE = Equirectangular()


def test_a_map_is_made_once_for_equal_rotations():
    size = (64, 32)
    one = pixel_map(SPHERE, size, SPHERE, size, Rotation.about_axis((0, 1, 0), 0.25))
    two = pixel_map(SPHERE, size, SPHERE, size, Rotation.about_axis((0, 1, 0), 0.25))
    other = pixel_map(SPHERE, size, SPHERE, size, Rotation.about_axis((0, 1, 0), 0.26))
    assert one is two
    assert other is not one


def test_views_from_equal_poses_share_a_map():
    poses = [Rotation.about_axis((1, 0, 0), 0.3) for _ in range(2)]
    views = [Perspective(fov_deg=70, sphere_from_camera=pose) for pose in poses]
    assert views[0] == views[1]
    maps = [pixel_map(SPHERE, (64, 32), view, (16, 16)) for view in views]
    assert maps[0] is maps[1]


def test_kept_maps_stay_within_their_limit():
    kept = _Kept(limit_bytes=100_000)
    maps = [pixel_map(SPHERE, (64, 32), SPHERE, (64, 32), Rotation.about_axis((0, 0, 1), angle))
            for angle in (0.1, 0.2, 0.3, 0.4)]  # fmt: skip
    for number, made in enumerate(maps):
        kept.put(number, made)
    assert kept.get(3) is maps[3]
    assert kept.get(0) is None


def test_a_map_is_for_one_size_and_two_dtypes():
    found = pixel_map(SPHERE, (64, 32), SPHERE, (64, 32))
    with pytest.raises(UsageError, match="64x32, not 128x64"):
        apply_map(np.zeros((64, 128, 3), np.float32), found)
    with pytest.raises(UsageError, match="float64"):
        apply_map(np.zeros((32, 64, 3)), found)


def stripes(width, period_px):
    """Columns of light and dark, finer than a small picture can show; their mean is 0.5."""
    column = np.arange(width) // (period_px // 2) % 2
    return np.broadcast_to(column[None, :, None], (width // 2, width, 3)).astype(np.float32)


@pytest.mark.parametrize("target", [MIRROR_BALL, Octahedral(), Cubemap(), Perspective(fov_deg=80)])
@pytest.mark.parametrize("dtype", [np.float32, np.uint8])
def test_small_pictures_do_not_alias(target, dtype):
    picture = stripes(2048, 4)
    if dtype == np.uint8:
        picture = (picture * 255).astype(np.uint8)
    scale = float(picture.max())
    wide = 48 if target.aspect == 1 else 64
    smooth, valid = reproject(picture, SPHERE, target, wide)
    plain, _ = reproject(picture, SPHERE, target, wide, antialias=False)
    shown = valid if target is not MIRROR_BALL else pixel_grid(target, wide, wide)[1]
    assert smooth.dtype == dtype
    assert np.std(smooth[shown] / scale) < 0.06
    assert np.std(plain[shown] / scale) > 0.3
    assert smooth[shown].mean() / scale == pytest.approx(0.5, abs=0.03)


def test_other_sources_are_supersampled():
    faces, _ = reproject(stripes(1024, 8), SPHERE, Octahedral(), 512)
    small, _ = reproject(faces, Octahedral(), SPHERE, 32)
    rough, _ = reproject(faces, Octahedral(), SPHERE, 32, antialias=False)
    assert np.std(small) < 0.7 * np.std(rough)


def test_masks_and_single_channels_keep_their_shape():
    mask = np.zeros((64, 128), np.uint8)
    mask[:32] = 255
    dome, valid = reproject(mask, SPHERE, SKY_DOME, 40, interpolation="nearest")
    assert dome.shape == (40, 40)
    assert (dome[valid] == 255).all()
    assert (dome[~valid] == 0).all()
    gray = np.ones((64, 128), np.float32)
    assert reproject(gray, SPHERE, Octahedral(), 8)[0].shape == (8, 8)


def test_a_view_and_its_reprojection_agree():
    picture = (0.5 + 0.4 * np.sin(3 * equirect_directions(128, 64))).astype(np.float32)
    view = perspective_view(picture, 48, 32, 75)
    same, valid = reproject(picture, SPHERE, Perspective(fov_deg=75), 48, height_px=32)
    np.testing.assert_array_equal(view, same)
    assert valid.all()


def test_what_a_view_does_not_show_is_masked_in_the_sphere():
    view = np.full((32, 32, 3), 7, np.float32)
    sphere, valid = reproject(view, Perspective(fov_deg=90), SPHERE, 64)
    # A 90 degree square is one sixth of the sphere.
    weight = np.cos((np.arange(32) + 0.5 - 16) / 32 * np.pi)[:, None]
    share = (valid * weight).sum() / (np.ones_like(valid) * weight).sum()
    assert share == pytest.approx(1 / 6, abs=0.01)
    assert (sphere[valid] == 7).all()


def test_bad_sizes_are_refused():
    picture = np.zeros((32, 64, 3), np.float32)
    with pytest.raises(UsageError, match="at least one pixel, not 0x0"):
        reproject(picture, SPHERE, MIRROR_BALL, 0, height_px=0)
    with pytest.raises(UsageError, match=r"\(H, W, C\)"):
        reproject(np.zeros((0, 0, 3), np.float32), SPHERE, MIRROR_BALL, 16)
    with pytest.raises(UsageError, match="4 by 3 square faces"):
        reproject(picture, SPHERE, Cubemap(), 50)


def test_an_anamorphic_map_keeps_the_energy():
    rng = np.random.default_rng(0)
    radiance = rng.random((128, 256, 3), np.float32) ** 8
    square = resize_radiance(radiance, 64, 64)
    assert square.shape == (64, 64, 3)
    ledger = energy_ledger(radiance, square)
    assert ledger.kept(1e-6)


def test_the_ledger_tells_lost_and_invented_light():
    radiance = np.ones((16, 32, 3), np.float32)
    halved = radiance * [1, 0.5, 1]
    ledger = energy_ledger(radiance, halved.astype(np.float32))
    np.testing.assert_allclose(ledger.change, [0, -0.5, 0], atol=1e-6)
    assert not ledger.kept()
    assert energy_ledger(np.zeros_like(radiance), radiance).change[0] == np.inf
    assert energy_ledger(np.zeros_like(radiance), np.zeros_like(radiance)).kept()
    with pytest.raises(UsageError, match="Channels"):
        energy_ledger(radiance, radiance[..., :1])


def test_maps_are_not_made_larger_in_an_odd_shape():
    with pytest.raises(UsageError, match="cannot become 128x128"):
        resize_radiance(np.ones((32, 64, 3), np.float32), 128, 128)
    with pytest.raises(UsageError, match="with pixels"):
        resize_radiance(np.ones((0, 0, 3), np.float32), 16)


@pytest.mark.parametrize("work", [
    lambda radiance: resize_radiance(radiance, 16),
    lambda radiance: rotate_radiance(radiance, Rotation.about_axis((1, 0, 0), 0.3)),
])  # fmt: skip
def test_what_is_no_radiance_is_refused(work):
    good = np.ones((32, 64, 3), np.float32)
    with pytest.raises(UsageError, match="floating point, not uint16"):
        work((good * 100).astype(np.uint16))
    for bad in (np.nan, np.inf):
        broken = good.copy()
        broken[3, 4, 1] = bad
        with pytest.raises(UsageError, match="not finite"):
            work(broken)
    with pytest.raises(UsageError, match=r"\(H, W, C\) with pixels, not \(32, 64\)"):
        work(good[..., 0])
    with pytest.raises(UsageError, match="with pixels"):
        work(good[:0])
    # One channel is a map, too.
    assert work(good[..., :1]).shape[2] == 1
