"""What a disagreement is worth, measured on models whose errors are known."""

import tomllib

import numpy as np
import pytest

from panokit.errors import ModelError, UsageError
from panokit.evaluate.calibration import calibrate_confidence, fit_curve, write_calibration
from panokit.evaluate.lighting.sample import StereoSample
from panokit.reflectance.calibration import Curve, calibration_of
from tests.lighting.fakes import FakeNetwork, beacon, box_views


class Unsure(FakeNetwork):
    """Is off by noise of a strength that the picture's first pixel tells, never twice alike."""

    def __init__(self):
        super().__init__(None)
        self.rng = np.random.default_rng(0)

    def read_all(self, several):
        strength = several[0].background[0, 0, 0] / 100
        return [
            beacon([0.3, 0.6, -0.7], peak=30)
            * np.exp(strength * self.rng.normal(size=(64, 64, 3))).astype(np.float32)
            for _ in several
        ]


@pytest.fixture(scope="module")
def measured():
    samples = []
    for number in range(60):
        views = box_views(seed=number)
        views.background[:] = 5 + 3 * (number // 2)
        samples.append(
            StereoSample(key=f"{number}", views=views, truth=beacon([0.3, 0.6, -0.7], peak=30),
                         meta={})
        )  # fmt: skip
    return calibrate_confidence(Unsure(), samples)


def test_what_is_foretold_comes_true(measured):
    calibration, reliability = measured
    assert calibration.count == reliability.count == 30
    assert reliability.expected == pytest.approx(reliability.observed, rel=0.1)
    assert reliability.off < 0.05
    assert reliability.rank > 0.9


def test_two_noisy_answers_are_farther_apart_than_one_from_the_truth(measured):
    calibration, _ = measured
    signal = np.array(calibration.radiance.signal)
    np.testing.assert_allclose(calibration.radiance(signal) / signal, 1 / np.sqrt(2), rtol=0.15)


def test_it_is_kept_with_the_model_and_replaced(measured, tmp_path):
    calibration, _ = measured
    card = tmp_path / "model.toml"
    card.write_text('id = "x"\n\n[lighting]\nkind = "stereo"\n\n[files.lighting]\nname = "a"\n')
    write_calibration(tmp_path, calibration)
    first = card.read_text()
    write_calibration(tmp_path, calibration)
    assert card.read_text() == first
    table = tomllib.loads(first)
    assert table["files"]["lighting"]["name"] == "a"
    found = calibration_of(table["lighting"])
    np.testing.assert_allclose(found.radiance.error, calibration.radiance.error, rtol=1e-4)
    assert calibration_of({"kind": "stereo"}) is None


def test_a_curve_never_falls():
    rng = np.random.default_rng(1)
    signal = rng.uniform(0, 1, 500)
    curve = fit_curve(signal, 1 - 0.1 * signal + rng.normal(0, 0.3, 500))
    assert (np.diff(curve.error) >= 0).all()
    assert (np.diff(curve.signal) > 0).all()


def test_a_rising_error_is_followed():
    signal = np.linspace(0, 2, 400)
    curve = fit_curve(signal, signal**2)
    np.testing.assert_allclose(curve(np.array([0.5, 1.5])), [0.25, 2.25], atol=0.03)
    assert curve(np.array([9.0])) == max(curve.error)


def test_too_few_samples_or_signals_are_refused(tmp_path):
    with pytest.raises(UsageError, match="at least 20"):
        calibrate_confidence(Unsure(), [])
    with pytest.raises(UsageError, match="the same"):
        fit_curve(np.zeros(40), np.arange(40.0))
    with pytest.raises(ModelError, match="never"):
        Curve(signal=(0.0, 1.0), error=(2.0, 1.0))
