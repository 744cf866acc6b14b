import numpy as np
import pytest

from panokit.capture import Capture
from panokit.color import luminance
from panokit.envmap import Anchor
from panokit.errors import ModelError
from panokit.expand import ExpandSettings, expand
from panokit.frames import Frame
from panokit.panorama import Panorama
from panokit.sphere import energy


def panorama(pixels: np.ndarray, capture: Capture) -> Panorama:
    return Panorama(pixels=pixels, capture=capture, frame=Frame.WORLD)


@pytest.mark.parametrize("model", ["srgb", "reinhard", "area", "expand-1", "expand-2"])
def test_every_model_keeps_place_and_says_what_it_did(lamps, capture, model: str):
    source = panorama(lamps, capture)
    settings = ExpandSettings(model=model, width_px=128)
    result = expand(source, settings)
    assert result.width_px == 128
    assert result.anchor is Anchor.LDR_WHITE
    assert result.frame is Frame.WORLD
    assert result.capture is capture
    step = result.provenance.last("expand")
    assert step.settings_digest == settings.digest
    assert (step.weights_digest != "") == model.startswith("expand-")
    assert step.values["energy_after"] == pytest.approx(energy(result.radiance), abs=1e-5)
    assert luminance(np.array(step.values["energy_after"])) >= 0.99 * luminance(
        np.array(step.values["energy_before"])
    )
    assert 0.001 < step.values["burnt_share"] < 0.1


def test_the_same_panorama_gives_the_same_bytes(lamps, capture):
    first = expand(panorama(lamps, capture), ExpandSettings(width_px=256))
    second = expand(panorama(lamps, capture), ExpandSettings(width_px=256))
    assert np.array_equal(first.radiance, second.radiance)
    assert first.provenance.digest == second.provenance.digest


def test_a_map_is_never_wider_than_its_panorama(lamps, capture):
    result = expand(panorama(lamps, capture), ExpandSettings(model="srgb", width_px=1024))
    assert result.width_px == 256
    assert result.provenance.last("expand").values["width_limited_by_panorama"] is True


def test_the_released_model_turns_with_the_panorama(lamps, capture):
    first = expand(panorama(lamps, capture), ExpandSettings(width_px=256))
    turned = np.roll(lamps, 2 * 12, axis=1)
    second = expand(panorama(turned, capture), ExpandSettings(width_px=256))
    assert second.radiance == pytest.approx(np.roll(first.radiance, 24, axis=1), rel=1e-2)


def test_the_released_model_makes_lamps_bright_and_leaves_the_room(lamps, capture):
    radiance = expand(panorama(lamps, capture), ExpandSettings(width_px=256)).radiance
    light = luminance(radiance)
    assert light[26, 142] > 3
    assert light[90:].max() < 1.05


def test_an_unknown_model_is_refused_with_those_there_are(lamps, capture):
    with pytest.raises(ModelError, match="expand-1"):
        expand(panorama(lamps, capture), ExpandSettings(model="expand-99"))


def test_a_big_panorama_is_worked_on_in_strips(capture):
    tracemalloc = pytest.importorskip("tracemalloc")
    pixels = np.full((2048, 4096, 3), 90, np.uint8)
    pixels[500:520, 1000:1040] = 255
    tracemalloc.start()
    expand(panorama(pixels, capture), ExpandSettings(model="srgb", width_px=256))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # All 11 planes of the whole picture would be 370 MB.
    assert peak < 200e6


def test_each_component_has_a_gain_within_its_range(lamps, capture):
    values = expand(panorama(lamps, capture), ExpandSettings(width_px=256)).provenance.steps[-1]
    gains, ranges = values.values["component_gains"], values.values["component_gain_ranges"]
    assert len(gains) == len(ranges) == 3
    for gain, (low, high) in zip(gains, ranges, strict=True):
        assert 0.9 < low <= gain <= high


def test_the_record_lists_lights_and_harmonics_in_the_unit_of_the_map(lamps, capture):
    plain, bright = (
        expand(panorama(lamps, capture), ExpandSettings(width_px=256, anchor_white_cd_m2=white))
        for white in (1, 50)
    )
    first, second = (
        result.provenance.last("expand").values["lighting"] for result in (plain, bright)
    )
    assert len(first["lights"]) >= 1
    for a, b in zip(first["lights"], second["lights"], strict=True):
        assert 50 * np.array(a["energy_rgb"]) == pytest.approx(np.array(b["energy_rgb"]), rel=1e-3)
    rgb = np.array(first["harmonics"]["rgb"])
    assert 50 * rgb == pytest.approx(np.array(second["harmonics"]["rgb"]), rel=1e-3, abs=1e-3)


def test_each_light_says_between_which_energies_it_lies(lamps, capture):
    values = expand(panorama(lamps, capture), ExpandSettings(width_px=256)).provenance.steps[-1]
    lights = values.values["lighting"]["lights"]
    ranges = [
        [low / gain, high / gain]
        for gain, (low, high) in zip(
            values.values["component_gains"], values.values["component_gain_ranges"], strict=True
        )
    ]
    assert lights
    for light in lights:
        low, high = light["energy_range"]
        assert 0 < low <= 1 <= high
        # It is the range of one of the components.
        assert min(abs(np.log(low / a)) + abs(np.log(high / b)) for a, b in ranges) < 0.01
    formula = expand(panorama(lamps, capture), ExpandSettings(model="area", width_px=256))
    lighting = formula.provenance.steps[-1].values["lighting"]
    assert {light["energy_range"] for light in lighting["lights"]} == {None}
