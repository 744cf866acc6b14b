import numpy as np
import pytest

from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.io import read_environment_map, read_panorama
from panokit.sphere import energy, equirect_directions, resize_radiance, rotate_radiance
from panokit.sun import SUN_SOLID_ANGLE
from panokit.synthetic import CitySettings, render_city
from panokit.synthetic.generate import TRUTH
from panokit.synthetic.render import View, render_radiance
from panokit.synthetic.scene import clear_sky, load_scene
from panokit.synthetic.sky import Sky

pytestmark = pytest.mark.render


def view(width_px=64, samples=4, pose=None):
    return View(
        position_m=(0.0, 1.7, 0.0),
        world_from_camera=pose or Rotation.identity(),
        width_px=width_px,
        samples=samples,
        denoise=False,
    )


def test_empty_place_shows_the_sky_as_it_is(tmp_path):
    directions = equirect_directions(256, 128)
    radiance = (1.5 + directions @ np.diag([1.0, 0.4, 0.7]).astype(np.float32)).astype(np.float32)
    sky = Sky(radiance=radiance, sun_direction=None, sun_radiance=np.zeros(3))
    scene = load_scene({}, sky, tmp_path)
    seen = render_radiance(scene, sky, view(samples=16), seed=1)
    np.testing.assert_allclose(seen, resize_radiance(radiance, 64), atol=0.08)
    # A camera that is turned and tilted sees the sky turned and tilted the other way.
    pose = Rotation.from_heading_pitch_roll(1.0, 0.3, -0.2)
    # With a seed that leaves 32 bits when it is spread over the passes.
    tilted = render_radiance(scene, sky, view(samples=16, pose=pose), seed=3_000_000)
    expected = rotate_radiance(resize_radiance(radiance, 64), pose.inverse)
    np.testing.assert_allclose(tilted, expected, atol=0.08)


def test_sun_lands_at_its_azimuth_and_elevation_with_its_energy(tmp_path):
    azimuth_deg, elevation_deg = 75.0, 32.0
    toward = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))
    sky = clear_sky(toward, 3.0)
    assert sky.sun_radiance.min() > 1e4
    scene = load_scene({}, sky, tmp_path)
    seen = render_radiance(scene, sky, view(128, 2), seed=1)
    row, column = np.unravel_index(seen.sum(axis=2).argmax(), (64, 128))
    assert abs((column + 0.5) / 128 * 360 - 180 - azimuth_deg) < 3
    assert abs(90 - (row + 0.5) / 64 * 180 - elevation_deg) < 3
    without = energy(np.minimum(seen, 60.0))
    expected = sky.sun_radiance * SUN_SOLID_ANGLE
    np.testing.assert_allclose(energy(seen) - without, expected, rtol=0.05)
    # The sky of the model is brightest around the sun, in the same frame.
    near = equirect_directions(*sky.radiance.shape[1::-1]) @ toward
    assert sky.radiance[near > 0.98].mean() > 2 * sky.radiance[:256].mean()


def test_small_city_is_complete_and_kept(tmp_path):
    settings = CitySettings(
        count=1, width_px=64, truth_width_px=32, samples=1, truth_samples=1, denoise=False
    )
    made = []
    (path,) = render_city(settings, tmp_path, lambda name, _: made.append(name))
    panorama = read_panorama(path)
    truth = read_environment_map(tmp_path / TRUTH / f"{path.stem}.exr")
    assert made == [path.stem]
    assert panorama.pixels.shape == (32, 64, 3)
    assert panorama.capture == truth.capture
    assert panorama.capture.license.train
    assert truth.radiance.shape == (16, 32, 3)
    assert (str(truth.frame), str(truth.anchor)) == ("world", "ldr-white")
    step = truth.provenance.last("synthetic")
    np.testing.assert_allclose(energy(truth.radiance), step.values["energy"], rtol=1e-4)
    render_city(settings, tmp_path, lambda name, _: made.append(name))
    assert made == [path.stem], "what is there is kept"
