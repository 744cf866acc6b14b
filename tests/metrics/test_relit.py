import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import direction_from_azimuth_elevation
from panokit.metrics import relit_errors, relit_three_spheres
from panokit.metrics.relit import RELIT_SCENES, _facing_camera
from panokit.metrics.transport import SCENES
from panokit.sphere import equirect_directions


def lamp(azimuth_deg: float, value: float = 20.0) -> np.ndarray:
    directions = equirect_directions(128, 64)
    toward = direction_from_azimuth_elevation(*np.deg2rad([azimuth_deg, 30]))
    near = directions @ toward > np.cos(np.deg2rad(10))
    return np.where(near[..., None], np.float32(value), np.float32(0.1)).repeat(3, 2)


@pytest.mark.parametrize("scene", ["diffuse", "glossy-0.3", "mirror"])
def test_equal_maps_relight_equally_and_a_turned_lamp_shows(scene):
    truth = lamp(120)
    assert relit_errors(truth, truth, scene).rmse == 0
    near, far = (relit_errors(lamp(a), truth, scene) for a in (125, 170))
    assert 0 < near.si_rmse < far.si_rmse


def test_twice_the_light_is_an_error_of_scale_alone():
    truth = lamp(120)
    errors = relit_errors(2 * truth, truth, "diffuse")
    assert errors.rmse > 0.1
    assert errors.si_rmse == pytest.approx(0, abs=1e-4)
    assert errors.angular_deg == pytest.approx(0, abs=1e-3)


def test_a_tinted_lamp_shows_as_an_angle():
    truth = lamp(120)
    errors = relit_errors(truth * np.array([1, 0.8, 0.6], np.float32), truth, "diffuse")
    tint = np.array([1, 0.8, 0.6])
    expected = np.degrees(np.arccos(tint.sum() / np.sqrt(3 * (tint**2).sum())))
    assert errors.angular_deg == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize("variant", ["compat", "fixed"])
def test_three_spheres_from_map_to_figures_forget_the_exposure(variant):
    truth = lamp(120)
    same = relit_three_spheres(3 * truth, truth, variant)
    assert set(same) == {"mirror", "matte_silver", "diffuse"}
    assert max(errors.rmse for errors in same.values()) < 1e-3
    turned = relit_three_spheres(lamp(60), truth, variant)
    assert turned["mirror"].rmse > turned["diffuse"].rmse > 1e-3


def test_gamma_compression_hides_a_missing_sun():
    truth, dim = lamp(120, 1000), lamp(120, 100)
    lost = {v: relit_three_spheres(dim, truth, v)["diffuse"] for v in ("compat", "fixed")}
    scale = {v: relit_three_spheres(truth * 0 + 1e-6, truth, v)["diffuse"] for v in lost}
    assert lost["compat"].rmse / scale["compat"].rmse < 0.8 * (
        lost["fixed"].rmse / scale["fixed"].rmse
    )


def test_blender_shows_three_quarters_of_the_map_behind_the_camera():
    lighting = np.zeros((4, 8, 3), np.float32)
    lighting[:, 6] = 1  # u = 0.75 and a bit
    assert _facing_camera(lighting)[0, :, 0].tolist() == [1, 0, 0, 0, 0, 0, 0, 0]


def test_all_scenes_of_the_protocol_are_scenes():
    assert set(RELIT_SCENES) <= set(SCENES)
    with pytest.raises(UsageError, match="scene"):
        relit_errors(lamp(0), lamp(0), "teapot")
