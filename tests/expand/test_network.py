from dataclasses import replace

import numpy as np
import pytest

from panokit.color import luminance
from panokit.errors import ImageError
from panokit.expand.network import compose, predict
from panokit.expand.reduce import reduce_panorama
from panokit.sphere import energy, pixel_solid_angles


def total(light: np.ndarray) -> float:
    return float(luminance(energy(light)))


def test_what_is_not_burnt_out_follows_the_curve_alone(lamps, known_network):
    reduced = reduce_panorama(lamps, 256)
    radiance = compose(reduced, predict(reduced, known_network))
    clear = reduced.share == 0
    assert radiance[clear] == pytest.approx(reduced.linear[clear], rel=1e-4)
    known_network.slopes = (0.7, 1.3)
    curved = compose(reduced, predict(reduced, known_network))
    assert (np.abs(curved[clear] / np.maximum(radiance[clear], 1e-6) - 1) > 0.01).mean() > 0.9
    assert curved[reduced.share == 1] == pytest.approx(radiance[reduced.share == 1], rel=1e-3)


def test_burnt_out_light_never_gets_darker(lamps, known_network):
    reduced = reduce_panorama(lamps, 256)
    radiance = compose(reduced, predict(reduced, known_network))
    assert (radiance >= reduced.burnt * 0.9999).all()
    assert total(radiance) > 1.05 * total(reduced.linear)


def test_a_components_energy_is_the_geometric_mean_of_both_networks(lamps, known_network):
    reduced = reduce_panorama(lamps, 256)
    prediction = predict(reduced, known_network)
    radiance = compose(reduced, prediction)
    light = luminance(radiance) * pixel_solid_angles(128, 256)
    for k in range(3):
        inside = prediction.components.labels == k + 1
        wanted = np.sqrt(prediction.grid_energy[k + 1] * prediction.component_energy[k])
        assert light[inside].sum() == pytest.approx(wanted, rel=1e-3)
        assert wanted / prediction.components.energy[k] == pytest.approx(6, rel=0.05)


def test_a_model_says_how_much_its_grid_counts(lamps, known_network):
    prediction = predict(reduce_panorama(lamps, 256), known_network)
    grid_alone = replace(prediction, grid_weight=1.0)
    assert grid_alone.energy[1:] == pytest.approx(prediction.grid_energy[1:])
    components_alone = replace(prediction, grid_weight=0.0)
    assert components_alone.energy[1:] == pytest.approx(prediction.component_energy)


def test_a_strong_lamps_light_is_drawn_to_its_middle_and_a_panels_is_not(lamps, known_network):
    reduced = reduce_panorama(lamps, 256)
    known_network.set_gains(4, 4)
    weak = luminance(compose(reduced, predict(reduced, known_network)))
    known_network.set_gains(400, 400)
    strong = luminance(compose(reduced, predict(reduced, known_network)))
    assert strong[26, 142] > 2 * strong[24, 140]
    assert weak[26, 142] == pytest.approx(weak[24, 140], rel=0.05)


def test_the_suns_light_is_drawn_to_its_middle_however_wide_its_glare_is(known_network):
    pixels = np.full((128, 256, 3), 90, np.uint8)
    rows, columns = np.mgrid[:128, :256]
    pixels[(rows - 40) ** 2 + (columns - 100) ** 2 < 12**2] = 255
    known_network.set_gains(400, 400)
    reduced = reduce_panorama(pixels, 256)
    prediction = predict(reduced, known_network)
    sky = luminance(compose(reduced, prediction))
    sure = np.ones(1, np.float32)
    sun = luminance(compose(reduced, replace(prediction, sun=sure)))
    weights = pixel_solid_angles(128, 256)
    assert (sun * weights).sum() == pytest.approx((sky * weights).sum(), rel=1e-3)
    assert sun[40, 100] > 5 * sun[40, 110]
    assert sky[40, 100] < 2 * sky[40, 110]
    unlikely = replace(prediction, sun=0.4 * sure)
    assert luminance(compose(reduced, unlikely)) == pytest.approx(sky)


@pytest.mark.parametrize("cells", [1, 7, 64])
def test_turning_the_panorama_turns_the_map(lamps, known_network, cells: int):
    columns = 2 * cells
    reduced = reduce_panorama(lamps, 256)
    turned = reduce_panorama(np.roll(lamps, columns, axis=1), 256)
    first = compose(reduced, predict(reduced, known_network))
    second = compose(turned, predict(turned, known_network))
    assert second == pytest.approx(np.roll(first, columns, axis=1), rel=1e-3, abs=1e-5)


def test_a_panorama_without_burnt_out_light_keeps_its_energy(known_network):
    reduced = reduce_panorama(np.full((128, 256, 3), 100, np.uint8), 256)
    radiance = compose(reduced, predict(reduced, known_network))
    assert radiance == pytest.approx(reduced.linear, rel=1e-4)


def test_a_white_panorama_stays_finite(known_network):
    reduced = reduce_panorama(np.full((128, 256, 3), 255, np.uint8), 256)
    radiance = compose(reduced, predict(reduced, known_network))
    assert np.isfinite(radiance).all()
    assert radiance.min() >= 1


def test_a_picture_smaller_than_the_grid_is_refused(known_network):
    reduced = reduce_panorama(np.full((32, 64, 3), 100, np.uint8), 64)
    with pytest.raises(ImageError, match="at least 128") as caught:
        predict(reduced, known_network)
    assert caught.value.reason == "too-small"
