"""Models in use: what comes out, how sure it is, and what is refused."""

from dataclasses import fields, replace

import numpy as np
import pytest

from panokit.errors import ModelError, UsageError
from panokit.lighting import EstimateSettings, LightingModel
from panokit.reflectance.calibration import Calibration, Curve
from tests.lighting.fakes import box_views, write_model

pytestmark = pytest.mark.train


@pytest.fixture
def views():
    return box_views()


def test_an_estimate_is_what_the_network_says(views, tmp_path):
    model = LightingModel(write_model(tmp_path / "sum"))
    found = model.estimate(views)
    expected = (views.left.astype(np.float32) + views.right) / 255
    np.testing.assert_allclose(found.radiance, expected, rtol=1e-5)
    assert found.model == "sum"
    assert found.level_from_camera == views.left_level
    assert found.provenance.last("lighting").values == {"model": "sum"}
    assert not found.radiance.flags.writeable


def test_a_network_that_is_as_sure_in_the_mirror_is_sure(views, tmp_path):
    found = LightingModel(write_model(tmp_path / "sum")).estimate(views)
    assert found.confidence.value == pytest.approx(1, abs=1e-5)
    assert found.confidence.direction_deg == pytest.approx(0, abs=1e-4)
    assert not found.confidence.calibrated


def test_one_that_says_something_else_in_the_mirror_is_not(views, tmp_path):
    found = LightingModel(write_model(tmp_path / "biased", (1.0, 0.1))).estimate(views)
    assert found.confidence.value < 0.95
    # It is only unsure where the object is in one view and not in the other.
    assert found.confidence.map[4, 4] > 0.99 > found.confidence.map[30, 20]


def test_a_measured_model_says_what_was_measured(views, tmp_path):
    folder = write_model(tmp_path / "sum")
    curve = Curve(signal=(0.0, 1.0), error=(0.5, 2.0))
    angles = Curve(signal=(0.0, 90.0), error=(7.0, 60.0))
    text = Calibration(count=30, radiance=curve, direction_deg=angles).to_toml()
    path = folder / "model.toml"
    path.write_text(path.read_text() + "\n" + text)
    found = LightingModel(folder).estimate(views)
    assert found.confidence.calibrated
    assert found.confidence.value == pytest.approx(np.exp(-0.5), abs=1e-3)
    assert found.confidence.direction_deg == pytest.approx(7, abs=1e-3)


def test_without_confidence_the_mirror_is_left_out(views, tmp_path, monkeypatch):
    model = LightingModel(write_model(tmp_path / "sum"), EstimateSettings(confidence=False))
    monkeypatch.setattr("panokit.lighting.model.read_twice", None)
    assert model.estimate(views).confidence is None


def test_views_that_are_not_square_are_refused(views, tmp_path):
    names = (field.name for field in fields(views))
    arrays = {n: getattr(views, n) for n in names if isinstance(getattr(views, n), np.ndarray)}
    wide = replace(views, **{name: array[:32] for name, array in arrays.items()})
    with pytest.raises(UsageError, match=r"square views, not 64x32\. Crop"):
        LightingModel(write_model(tmp_path / "sum")).estimate(wide)


def test_what_to_mind_comes_with_the_estimate(tmp_path):
    model = LightingModel(write_model(tmp_path / "sum"))
    assert any("sideways" in text for text in model.estimate(box_views(0)).warnings)


@pytest.mark.parametrize(("size", "told"), [(56, True), (64, False), (72, False)])
def test_views_that_are_enlarged_are_told_of(tmp_path, size, told):
    found = LightingModel(write_model(tmp_path / "sum")).estimate(box_views(size=size))
    assert any("enlarged to the 64" in text for text in found.warnings) is told


def test_other_models_are_refused(tmp_path):
    with pytest.raises(ModelError, match="not for lighting"):
        LightingModel(write_model(tmp_path / "a", task="expand"))
    with pytest.raises(ModelError, match="predicts reflectance"):
        LightingModel(write_model(tmp_path / "b", kind="picture-reflectance"))
    with pytest.raises(ModelError, match=r"no model\.toml"):
        LightingModel(tmp_path / "nowhere")
    with pytest.raises(ModelError, match="no released model"):
        LightingModel("nobody-released-this")


def test_a_damaged_calibration_is_told(tmp_path):
    folder = write_model(tmp_path / "sum")
    path = folder / "model.toml"
    path.write_text(path.read_text() + '\n[lighting.confidence]\nsignal = "mirror"\ncount = 3\n')
    with pytest.raises(ModelError, match=r"lighting\.confidence"):
        LightingModel(folder)
