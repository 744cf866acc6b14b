"""The "compat" variants against figures that the published code itself printed.

The same arrays went through the reference code of StyleLight, DiffusionLight-evaluation,
EnvMapNet, Stanford-ORB, Objects With Lighting and scikit-image 0.26, run once beside panokit.
"""

import cv2
import numpy as np
import pytest

from panokit.metrics import (
    array_errors,
    envmapnet_lights,
    light_direction_error_deg,
    lighting_of_spheres,
    orb_psnr_db,
    score_owl,
    sphere_errors,
    ssim,
)


class Inputs:
    """Arrays drawn in this order from one seed."""

    def __init__(self) -> None:
        random = np.random.default_rng(5)
        self.estimate = random.uniform(0, 2, (40, 60, 4)).astype(np.float32)
        noise = random.uniform(0.5, 1.5, self.estimate.shape)
        self.truth = (self.estimate * noise).astype(np.float32)
        rows, columns = np.mgrid[:40, :60]
        self.mask = (rows - 20) ** 2 + (columns - 30) ** 2 < 15**2
        for render in (self.estimate, self.truth):
            render[~self.mask] = 0
            render[..., 3] = self.mask
        self.estimate[20, 30, :3] = 0
        self.env = random.lognormal(0, 2, (128, 256, 3)).astype(np.float32)
        self.env[3:9] = 0
        self.maps = [self._lamps(random) for _ in range(12)]
        self.first = random.uniform(0, 1, (64, 64, 3))
        self.second = np.clip(self.first + random.normal(0, 0.2, self.first.shape), 0, 1)
        rgb = self.truth[..., :3]
        self.shown = (np.clip(rgb / 1.8, 0, 1) ** (1 / 2.2)).astype(np.float32)
        tint = rgb * np.array([0.3, 0.25, 0.2])
        self.linear = (tint * random.uniform(0.9, 1.1, rgb.shape)).astype(np.float32)

    @staticmethod
    def _lamps(random: np.random.Generator) -> np.ndarray:
        radiance = random.uniform(0, 0.1 * random.uniform(), (128, 256, 3)).astype(np.float32)
        for _ in range(random.integers(1, 6)):
            center = (int(random.integers(0, 256)), int(random.integers(0, 128)))
            color = [float(x) for x in random.uniform(1, 10, 3)]
            cv2.circle(radiance, center, int(random.integers(2, 12)), color, -1)
        return cv2.GaussianBlur(radiance, (19, 19), 0)


@pytest.fixture(scope="module")
def inputs() -> Inputs:
    return Inputs()


def test_three_spheres(inputs):
    errors = sphere_errors(inputs.estimate, inputs.truth, "compat")
    assert errors.rmse == pytest.approx(0.5810097987543186, rel=1e-12)
    assert errors.si_rmse == pytest.approx(0.5809322863729988, rel=1e-12)
    assert errors.angular_deg == pytest.approx(9.45990351896212, rel=1e-9)
    assert errors.normalized_rmse == pytest.approx(0.36608037613634353, rel=1e-9)


def test_tone_step_of_the_three_spheres(inputs):
    toned = lighting_of_spheres(inputs.env, "compat")
    assert toned.sum() == pytest.approx(66166.734, rel=1e-6)
    assert toned[100, 100] == pytest.approx([0.2840686738, 1.2393810749, 0.0996752158])
    assert toned.max() == pytest.approx(18.844158)


def test_array_of_spheres(inputs):
    errors = array_errors(inputs.estimate, inputs.truth, "compat")
    assert errors.rmse == pytest.approx(0.18077301979064941, rel=1e-6)
    assert errors.si_rmse == pytest.approx(0.18074889481067657, rel=1e-6)
    assert errors.angular_deg == pytest.approx(9.47349518180163, rel=1e-6)
    assert errors.psnr_db == pytest.approx(24.29012298, rel=1e-6)


def test_light_direction(inputs):
    found = [len(envmapnet_lights(radiance)) for radiance in inputs.maps]
    assert found == [3, 2, 3, 3, 2, 2, 5, 5, 2, 3, 5, 1]
    errors = [
        light_direction_error_deg(estimate, truth, "compat")
        for truth, estimate in zip(inputs.maps[:-1], inputs.maps[1:], strict=True)
    ]
    assert errors == pytest.approx(
        [
            70.70206843555043, 29.088516461417473, 82.27317003362761, 80.08751551989727,
            74.86066274392532, 56.27656329843491, 40.386279416329344, 51.34781678426552,
            61.83979187298438, 45.719048044062134, 154.9903392330114,
        ],
        rel=1e-6,
    )  # fmt: skip


def test_ssim(inputs):
    assert ssim(inputs.second, inputs.first, "thesis") == pytest.approx(0.8256587884041792)
    assert ssim(inputs.second, inputs.first, "wang") == pytest.approx(0.820873032755043)


@pytest.mark.parametrize(
    ("preset", "divide_by", "expected"),
    [
        ("hdr", "mask", 3.4315244660934074),
        ("hdr", "frame", 15.18339815210604),
        ("ldr", "mask", 17.190390083467133),
        ("ldr", "frame", 28.942264546058812),
    ],
)
def test_stanford_orb(inputs, preset, divide_by, expected):
    found = orb_psnr_db(
        inputs.estimate[..., :3],
        inputs.truth[..., :3],
        inputs.mask,
        preset=preset,
        variant="compat",
        divide_by=divide_by,
    )
    # The published code computes in float32.
    assert found == pytest.approx(expected, abs=1e-5)


def test_objects_with_lighting(inputs):
    score = score_owl(inputs.linear, inputs.shown, inputs.mask, "compat")
    assert score.exposure_stops == pytest.approx(1.1376476849, abs=1e-5)
    assert score.balance == pytest.approx([0.8422033364, 1.0033263777, 1.2671305320], abs=1e-4)
    assert score.psnr_db == pytest.approx(35.5265088567, abs=1e-3)
