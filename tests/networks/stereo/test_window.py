"""The background window: what the camera sees lands where the sphere says, and nowhere else."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from panokit.color import srgb_decode, srgb_encode  # noqa: E402
from panokit.color.hdr_coding import HdrCoding  # noqa: E402
from panokit.networks.stereo.window import BackgroundWindow  # noqa: E402
from panokit.sphere import equirect_directions  # noqa: E402
from panokit.sphere.perspective import Perspective, perspective_pixel  # noqa: E402

pytestmark = pytest.mark.train
CODING = HdrCoding()
FOV_DEG = 40.0


def seen_by(fov_deg, picture, output_px=64):
    """Radiance and validity of the window of a picture (S, S, 3) in [0, 1]."""
    window = BackgroundWindow(fov_deg, output_px, CODING)
    views = torch.from_numpy(picture.astype(np.float32)).permute(2, 0, 1)[None] * 2 - 1
    found = window(views)[0].permute(1, 2, 0).numpy()
    valid = found[..., 3]
    return CODING.decode(found[..., :3]) * valid[..., None], valid


@pytest.mark.parametrize("fov_deg", [40.0, 75.0])
@pytest.mark.parametrize("column, row", [(0.2, 0.3), (0.8, 0.25), (0.5, 0.5), (0.7, 0.85)])
def test_a_bright_patch_lands_in_its_direction(fov_deg, column, row):
    size = 64
    picture = np.full((size, size, 3), 0.1)
    x, y = int(column * size), int(row * size)
    picture[y - 3 : y + 4, x - 3 : x + 4] = 1
    # Read a map of 512 pixels, fine enough to say where its brightest place is.
    radiance, _ = seen_by(fov_deg, picture, 512)
    light = radiance.mean(axis=-1)
    peak = equirect_directions(512, 512)[light > 0.9 * light.max()].mean(axis=0)
    true, _ = Perspective(fov_deg=fov_deg).directions(np.array(x), np.array(y), size, size)
    cosine = float(peak @ true / np.linalg.norm(peak))
    pixel_deg = fov_deg / 16  # it is read at 16 pixels
    assert np.degrees(np.arccos(min(cosine, 1))) < 0.75 * pixel_deg


def test_outside_there_is_nothing():
    radiance, valid = seen_by(FOV_DEG, np.ones((64, 64, 3)))
    _, _, inside = perspective_pixel(equirect_directions(64, 64), 64, 64, FOV_DEG)
    np.testing.assert_array_equal(valid, inside)
    window = BackgroundWindow(FOV_DEG, 64, CODING)
    codes = window(torch.ones(1, 3, 64, 64))[0].permute(1, 2, 0).numpy()
    assert not codes[~inside].any()
    np.testing.assert_allclose(radiance[inside], 1, rtol=1e-4)
    # 40 degrees of a sphere around the forward direction, which is in the center.
    assert 0.02 < valid.mean() < 0.06
    assert valid[32, 32] == valid[31, 31] == 1
    assert valid[32, 0] == valid[0, 32] == 0


def test_light_is_averaged_not_its_code():
    """Half white and half black, in stripes finer than what is read, is half the light."""
    picture = np.zeros((64, 64, 3))
    picture[:, ::2] = 1
    radiance, valid = seen_by(FOV_DEG, picture)
    np.testing.assert_allclose(radiance[valid > 0], 0.5, rtol=1e-3)
    assert srgb_decode(0.5) < 0.25 < srgb_encode(0.5)


@pytest.mark.parametrize("size", [16, 32, 128])
def test_pictures_of_any_size_show_the_same(size):
    ramp = np.broadcast_to(np.linspace(0.2, 0.8, size)[None, :, None], (size, size, 3))
    radiance, valid = seen_by(FOV_DEG, ramp)
    row = radiance[32, valid[32] > 0, 0]
    assert (np.diff(row) > 0).all()
    middle = len(row) // 2
    assert row[middle - 1 : middle + 1].mean() == pytest.approx(float(srgb_decode(0.5)), rel=0.05)
