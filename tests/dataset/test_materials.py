"""Random materials stay in their ranges and look like things in a room."""

import numpy as np
import pytest

from panokit.color.luminance import luminance
from panokit.dataset.materials import OFF, TEXTURES, draw_albedo, draw_material, draw_texture
from panokit.dataset.scene import Material
from panokit.dataset.settings import ObjectSettings
from panokit.errors import UsageError


@pytest.fixture(scope="module")
def many():
    rng = np.random.default_rng(1)
    return [draw_material(rng, ObjectSettings()) for _ in range(1500)]


def test_no_lobe_is_exactly_off(many):
    for name in ("roughness", "metallic", "specular", "sheen", "clearcoat", "flatness"):
        assert min(getattr(material, name) for material in many) >= OFF


def test_albedo_avoids_black_and_white(many):
    levels = np.array([luminance(np.array(material.base_color)) for material in many])
    assert 0.03 < np.quantile(levels, 0.01) < 0.12
    assert 0.2 < np.median(levels) < 0.5
    colors = np.array([m.base_color for m in many if m.metallic < 0.5])
    assert colors.min() >= 0.02
    assert colors.max() <= 0.85


def test_metals_are_a_fifth_and_colored(many):
    metals = [material for material in many if material.metallic > 0.5]
    assert len(metals) / len(many) == pytest.approx(0.2, abs=0.04)
    assert all(metal.metallic >= 0.9 for metal in metals)
    warm = [metal for metal in metals if metal.base_color[0] > 1.3 * metal.base_color[2]]
    assert 0.4 < len(warm) / len(metals) < 0.8


def test_there_are_no_textures_unless_asked_for(many):
    assert not any(material.texture is not None for material in many)
    rng = np.random.default_rng(2)
    settings = ObjectSettings(textured_share=0.5)
    share = np.mean([draw_material(rng, settings).texture is not None for _ in range(400)])
    # Metals have none.
    assert share == pytest.approx(0.4, abs=0.08)


def test_the_same_numbers_draw_the_same_material():
    settings = ObjectSettings(textured_share=1.0)
    one, other = (draw_material(np.random.default_rng(9), settings) for _ in range(2))
    assert one.to_json() == other.to_json()
    if one.texture is not None:
        assert np.array_equal(one.texture, other.texture)


@pytest.mark.parametrize("name", TEXTURES)
def test_patterns_repeat_and_have_contrast(name):
    for seed in range(5):
        pattern = TEXTURES[name](np.random.default_rng(seed))
        assert pattern.shape == (128, 128)
        assert pattern.dtype == np.float32
        assert 0 <= pattern.min() < 0.3
        assert 0.6 < pattern.max() <= 1
    if name == "noise":
        inner = np.abs(np.diff(pattern, axis=0)).max()
        assert np.abs(pattern[0] - pattern[-1]).max() <= 1.5 * inner


def test_a_texture_is_an_albedo():
    rng = np.random.default_rng(4)
    for _ in range(20):
        texture = draw_texture(rng, draw_albedo(rng))
        assert texture.shape == (128, 128, 3)
        assert texture.dtype == np.float32
        assert texture.min() >= 0.02
        assert texture.max() <= 0.85


def test_a_material_beyond_its_range_is_refused():
    with pytest.raises(UsageError, match="roughness"):
        Material(base_color=(0.5, 0.5, 0.5), roughness=1.5)
