"""Light found by differentiable rendering."""

import numpy as np
import pytest

from panokit.errors import MissingLibraryError
from panokit.evaluate.lighting.baselines import AmbientColor
from panokit.evaluate.rendering import DifferentiableRendering
from panokit.evaluate.rendering.inverse import _Adam, _folded, _half_gray
from panokit.frames import angle_between
from panokit.io.adapters.mitsuba import pad_columns
from panokit.renderer import differentiable_mitsuba
from panokit.sphere import energy, light_vector


@pytest.fixture
def gradients():
    try:
        differentiable_mitsuba()
    except MissingLibraryError as error:
        pytest.skip(str(error))


def off_deg(estimate, truth):
    return float(np.degrees(angle_between(light_vector(estimate), light_vector(truth))))


@pytest.mark.tool
@pytest.mark.render
@pytest.mark.parametrize("material", ["known", "fitted"])
def test_the_light_is_found_from_what_the_object_shows(gradients, vase, material):
    method = DifferentiableRendering(material, width_px=24, rounds=25, samples=8)
    found = method.predict(vase)
    assert found.shape == (64, 64, 3)
    assert found.dtype == np.float32
    assert found.min() > 0
    ambient = AmbientColor().predict(vase)
    assert off_deg(found, vase.truth) < 0.6 * off_deg(ambient, vase.truth)
    assert 0.3 < energy(found).sum() / energy(vase.truth).sum() < 3


@pytest.mark.tool
@pytest.mark.render
def test_the_same_sample_gives_the_same_map(gradients, vase):
    method = DifferentiableRendering("known", width_px=16, rounds=2, samples=4)
    first = method.predict(vase)
    np.testing.assert_allclose(method.predict(vase), first, rtol=1e-4)


@pytest.mark.tool
@pytest.mark.render
def test_settings_are_part_of_what_was_scored(gradients):
    one = DifferentiableRendering("known", rounds=3)
    other = DifferentiableRendering("fitted", rounds=3)
    assert one.name != other.name
    assert len({one.digest, other.digest, DifferentiableRendering("known").digest}) == 3


def test_without_gradients_it_is_told_what_to_install(monkeypatch):
    class Scalar:
        @staticmethod
        def variant():
            return "scalar_rgb"

    monkeypatch.setattr("panokit.renderer.load_mitsuba", Scalar)
    with pytest.raises(MissingLibraryError, match="libLLVM") as told:
        differentiable_mitsuba()
    assert "scalar_rgb" in str(told.value)


def test_the_copies_of_columns_give_their_gradient_to_the_columns():
    rng = np.random.default_rng(0)
    light, weights = rng.normal(size=(4, 6, 3)), rng.normal(size=(4, 8, 3))
    step = 1e-3 * rng.normal(size=light.shape)
    loss = [float((weights * pad_columns(one)).sum()) for one in (light, light + step)]
    expected = float((_folded(weights.astype(np.float32), light.shape) * step).sum())
    assert loss[1] - loss[0] == pytest.approx(expected, rel=1e-3)


def test_steps_go_down():
    value = _Adam(np.array([3.0, -2.0]), 0.1)
    for _ in range(200):
        value.move(2 * value.value, 1.0)
    np.testing.assert_allclose(value.value, 0, atol=0.1)


def test_a_fitted_surface_gives_back_half_of_the_light():
    found = _half_gray(np.array([0.9, 0.3, 0.1, 2.0]))
    assert 0.2126 * found[0] + 0.7152 * found[1] + 0.0722 * found[2] == pytest.approx(0.5, abs=0.03)
    assert found[3] == 1
