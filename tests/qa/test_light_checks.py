"""Contrast, colors, what is up, sources: each passes what is sound and fails its damage."""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.frames import direction_from_azimuth_elevation
from panokit.provenance import Provenance, Step
from panokit.qa import QaSettings, Verdict, check
from panokit.sphere import energy, equirect_directions, find_lights


def of(envmap, name):
    return next(c for c in check(envmap).checks if c.name == name)


def changed(envmap, change):
    radiance = np.ascontiguousarray(change(envmap.radiance), np.float32)
    return envmap.with_changes(radiance=radiance)


@pytest.fixture
def wide(make_map):
    """Sky, ground, and grain strong enough for the contrast of a captured map."""
    envmap = make_map(512)
    directions = equirect_directions(512, 256)
    rough = np.random.default_rng(2).normal(0, 0.9, (256, 512, 1))
    rough = np.where(directions[..., 1:2] < 0.1, rough, 0)
    bumps = 1.2 * np.sin(7 * directions[..., :1]) * np.sin(9 * directions[..., 2:])
    lit = np.where(directions[..., 1:2] > 0, 0.5, 1.5)
    return changed(envmap, lambda pixels: pixels * lit * 2.0 ** (rough + bumps))


def test_display_values_taken_for_light_have_half_the_contrast(wide):
    sound = of(wide, "contrast")
    assert sound.verdict is Verdict.PASS
    powered = of(changed(wide, lambda p: p ** (1 / 2.2)), "contrast")
    assert powered.verdict is Verdict.FAIL
    # Whatever the map shows, a power multiplies the figure by itself.
    assert powered.value == pytest.approx(sound.value / 2.2, rel=0.03)


def test_under_an_even_sky_nothing_is_said_of_the_curve():
    y = equirect_directions(512, 256)[..., 1:2]
    overcast = np.where(y > 0, 1 + 2 * y, 0.2) * np.ones(3)
    found = of(EnvironmentMap(radiance=overcast.astype(np.float32)), "contrast")
    assert found.verdict is Verdict.NOT_APPLICABLE
    assert "even sky" in found.note


def test_swapped_channels_are_seen_under_a_sky_and_not_under_a_ceiling(make_map):
    envmap = make_map()
    assert of(envmap, "channel-order").verdict is Verdict.PASS
    swapped = changed(envmap, lambda p: p[..., ::-1])
    assert of(swapped, "channel-order").verdict is Verdict.FAIL
    below = changed(make_map(sun=0), lambda p: p[::-1])
    assert of(below, "channel-order").verdict is Verdict.NOT_APPLICABLE


def test_a_map_on_its_head_is_seen(make_map):
    envmap = make_map()
    assert of(envmap, "uprightness").verdict is Verdict.PASS
    assert of(changed(envmap, lambda p: p[::-1]), "uprightness").verdict is Verdict.FAIL


def test_color_temperatures_are_those_of_the_light_and_of_the_sky(make_map):
    envmap = make_map()
    light, sky = of(envmap, "light-temperature"), of(envmap, "sky-temperature")
    assert light.value == pytest.approx(6600, rel=0.03)
    assert sky.value > 9000
    black = envmap.with_changes(radiance=np.zeros_like(envmap.radiance))
    assert of(black, "light-temperature").note == "the map is black"
    orange = changed(make_map(sun=0), lambda p: p * np.float32([1, 0.35, 0.03]))
    report = check(orange, QaSettings(light_temperature_min_kelvin=3000))
    assert "light-temperature" in {c.name for c in report.failed}


def with_suns(*azimuths_deg, strength=3e4):
    directions = equirect_directions(512, 256)
    radiance = np.full((256, 512, 3), 0.3)
    for azimuth in azimuths_deg:
        toward = direction_from_azimuth_elevation(np.deg2rad(azimuth), 0.6)
        radiance += strength * np.exp((directions @ toward - 1) * 2e4)[..., None]
    return EnvironmentMap(radiance=radiance.astype(np.float32))


def test_one_sun_twice_is_seen():
    assert of(with_suns(20), "twin-source").value == 0
    twice = of(with_suns(20, 140), "twin-source")
    assert twice.verdict is Verdict.FAIL
    assert 0.3 < twice.value <= 0.5


def test_two_lamps_of_other_colors_are_no_twins():
    one, other = with_suns(20).radiance, with_suns(140).radiance * np.float32([1, 0.8, 0.5])
    assert of(EnvironmentMap(radiance=one + other), "twin-source").value == 0


def test_a_clipped_sun_has_no_peak():
    sound = with_suns(20)
    assert of(sound, "clipped-source").verdict is Verdict.PASS
    clipped = changed(sound, lambda p: np.minimum(p, p.max() / 16))
    assert of(clipped, "clipped-source").verdict is Verdict.FAIL


def test_the_share_of_the_sources_is_theirs():
    envmap = with_suns(20)
    found = of(envmap, "source-share")
    total = energy(envmap.radiance)[0]
    expected = 1 - 0.3 * 4 * np.pi / total
    assert found.value == pytest.approx(expected, abs=0.06)
    assert "1 source" in found.note


def expanded(envmap, **values):
    lights = [
        {"direction": light.direction.tolist()} for light in find_lights(envmap.radiance).lights
    ]
    total = energy(envmap.radiance)
    record = {
        "energy_before": (total / 10).tolist(), "energy_after": total.tolist(),
        "burnt_share": 0.01, "scale": {"factor": 1.0}, "lighting": {"lights": lights}, **values,
    }  # fmt: skip
    step = Step(stage="expand", version="1", values=record)
    return envmap.with_changes(provenance=Provenance((step,)))


def test_what_expansion_did_to_the_light_is_read_from_its_record():
    envmap = with_suns(20)
    assert of(envmap, "expansion-gain").value is None
    gained = of(expanded(envmap), "expansion-gain")
    assert gained.value == pytest.approx(10)
    assert gained.note == "1 % were burnt out"
    lost = expanded(envmap, energy_before=(energy(envmap.radiance) * 2).tolist())
    assert of(lost, "expansion-gain").verdict is Verdict.FAIL
    scaled = expanded(envmap, scale={"factor": 5.0})
    assert of(scaled, "expansion-gain").value == pytest.approx(2)
    assert of(expanded(envmap, energy_before="much"), "expansion-gain").value is None


def test_a_map_turned_after_its_record_was_written_is_seen():
    envmap = expanded(with_suns(20))
    assert of(envmap, "recorded-light").verdict is Verdict.PASS
    turned = changed(envmap, lambda p: np.roll(p, 40, axis=1))
    found = of(turned, "recorded-light")
    assert found.verdict is Verdict.FAIL
    assert of(with_suns(20), "recorded-light").value is None
