"""Maps wider than the networks look at are composed in strips, and nobody can tell."""

import numpy as np
import pytest

from panokit.color import luminance
from panokit.expand import ExpandSettings, expand, strips
from panokit.expand.components import find_components
from panokit.expand.network import compose, predict, shown_light
from panokit.expand.reduce import reduce_panorama, reduce_rows
from panokit.expand.strips import compose_wide, multiply_wide
from panokit.panorama import Panorama
from panokit.sphere import energy, pixel_solid_angles


@pytest.fixture
def prediction(lamps, known_network):
    """What is said of the lamps at half their width; one of them is strong enough to be drawn."""
    known_network.set_gains(40, 90)
    return predict(reduce_panorama(lamps, 128), known_network)


def wide(lamps, prediction):
    return compose_wide(lamps, 256, reduce_panorama(lamps, 128), prediction)


@pytest.mark.parametrize(("width_px", "first", "last"), [(256, 30, 31), (100, 0, 50), (60, 7, 23)])
def test_some_rows_are_rows_of_the_whole(lamps, width_px, first, last):
    whole = reduce_panorama(lamps, width_px)
    rows = reduce_rows(lamps, width_px, first, last)
    for name in ("clear", "burnt", "share", "white", "encoded"):
        expected = getattr(whole, name)[first:last]
        assert np.allclose(getattr(rows, name), expected, atol=2e-6), name


def test_strips_do_not_show(lamps, prediction, monkeypatch):
    whole = wide(lamps, prediction)
    monkeypatch.setattr(strips, "_STRIP_PIXELS", 3 * 256)
    assert np.allclose(wide(lamps, prediction), whole, rtol=1e-5)


def test_what_is_not_burnt_out_is_the_decoded_picture_at_full_width(lamps, prediction):
    radiance = wide(lamps, prediction)
    full = reduce_panorama(lamps, 256)
    clear = full.share == 0
    assert np.allclose(radiance[clear], shown_light(full, prediction.curve_slopes)[clear])
    assert (radiance >= full.burnt * 0.9999).all()


def test_each_component_has_the_energy_that_was_decided(lamps, prediction):
    light = luminance(wide(lamps, prediction)) * pixel_solid_angles(128, 256)
    # The labels of the narrow map, at every pixel of the wide one.
    labels = prediction.components.labels.repeat(2, axis=0).repeat(2, axis=1)
    burnt = reduce_panorama(lamps, 256).share > 0
    for k, wanted in enumerate(prediction.energy[1:]):
        inside = (labels == k + 1) & burnt
        assert light[inside].sum() == pytest.approx(wanted, rel=5e-3)


def test_a_strong_lamp_is_brightest_in_its_middle_and_has_no_rim(lamps, prediction):
    radiance = luminance(wide(lamps, prediction))
    lamp = radiance[24:30, 140:146]
    assert lamp[2:4, 2:4].min() > 1.5 * lamp[0].max()
    assert lamp[0].max() < lamp[1, 1:-1].min() * 1.01
    narrow = compose(reduce_panorama(lamps, 128), prediction)
    assert energy(wide(lamps, prediction)) == pytest.approx(energy(narrow), rel=0.02)


def test_an_area_rule_in_strips_multiplies_its_components(lamps):
    reduced = reduce_panorama(lamps, 128)
    components = find_components(reduced)
    gains = np.arange(2.0, 2 + len(components))
    radiance = multiply_wide(lamps, 256, components, gains)
    full = reduce_panorama(lamps, 256)
    labels = components.labels.repeat(2, axis=0).repeat(2, axis=1)
    for k, gain in enumerate(gains):
        inside = (labels == k + 1) & (full.share == 1)
        assert radiance[inside] == pytest.approx(gain * full.linear[inside], rel=1e-5)


@pytest.mark.parametrize("model", ["srgb", "reinhard", "area", "expand-2"])
def test_a_wide_map_is_as_bright_as_a_whole_one(lamps, capture, model, monkeypatch):
    panorama = Panorama(pixels=lamps, capture=capture)
    settings = ExpandSettings(model=model, width_px=256)
    whole = expand(panorama, settings)
    monkeypatch.setattr("panokit.expand.stage.WIDEST_WHOLE_PX", 128)
    in_strips = expand(panorama, settings)
    assert in_strips.width_px == 256
    # A model sees less in a narrower picture; the formulas see single pixels.
    near = 0.25 if model.startswith("expand") else 0.02
    assert energy(in_strips.radiance) == pytest.approx(energy(whole.radiance), rel=near)
    values = in_strips.provenance.last("expand").values
    assert values["energy_after"] == pytest.approx(energy(in_strips.radiance), rel=1e-3)
    assert (len(values["lighting"]["lights"]) >= 1) == (model != "srgb")
