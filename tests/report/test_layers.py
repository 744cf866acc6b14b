"""Layers: how wide they may be, and that they keep what they are made of."""

import base64

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.io import decode_image
from panokit.metrics import diffuse_ball, glossy_ball
from panokit.report import layer_width_px, light_map, photo_layer, radiance_layer
from panokit.report.bfloat import decode_radiance
from panokit.report.layers import BUDGET_BYTES, DIFFUSE_WIDTH_PX, GLOSSY_WIDTH_PX
from panokit.sphere import energy


def test_few_maps_are_large_and_many_stay_within_the_budget():
    assert layer_width_px(1) == layer_width_px(12, 12) == 768
    widths = [layer_width_px(n, n) for n in (50, 100, 200, 400)]
    assert widths == sorted(widths, reverse=True)
    assert all(width % 16 == 0 for width in widths)
    assert 200 * layer_width_px(200) ** 2 / 2 * 2.6 <= BUDGET_BYTES
    assert layer_width_px(100_000) == 128
    with pytest.raises(UsageError):
        layer_width_px(-1)


def test_a_layer_keeps_the_maps_energy_and_its_sun(patches):
    layer = radiance_layer(patches.radiance, "Light map", width_px=128)
    assert (layer.width_px, layer.height_px, layer.photo) == (128, 64, False)
    back = decode_radiance(layer.data, 128, 64)
    np.testing.assert_allclose(energy(back), energy(patches.radiance), rtol=5e-3)
    assert back.max() == pytest.approx(20000, rel=1 / 256)
    assert layer.median == pytest.approx(0.18, rel=1e-3)


def test_balls_of_a_layer_are_those_of_the_metrics(patches):
    layer = radiance_layer(patches.radiance, "Light map")
    white = decode_radiance(layer.diffuse, DIFFUSE_WIDTH_PX, DIFFUSE_WIDTH_PX // 2)
    rough = decode_radiance(layer.glossy, GLOSSY_WIDTH_PX, GLOSSY_WIDTH_PX // 2)
    size = 64
    # The ball's middle faces south, +Z: the seam of the maps; the light behind is there.
    south = white[DIFFUSE_WIDTH_PX // 4 - 1 : DIFFUSE_WIDTH_PX // 4 + 1][:, [0, -1]].mean((0, 1))
    ball = diffuse_ball(patches.radiance, size)[size // 2 - 1 : size // 2 + 1]
    middle = ball[:, size // 2 - 1 : size // 2 + 1, :3].mean((0, 1))
    np.testing.assert_allclose(south, middle, rtol=0.02)
    mirrored = rough[GLOSSY_WIDTH_PX // 4 - 1 : GLOSSY_WIDTH_PX // 4 + 1][:, [0, -1]].mean((0, 1))
    ball = glossy_ball(patches.radiance, size)[size // 2 - 1 : size // 2 + 1]
    middle = ball[:, size // 2 - 1 : size // 2 + 1, :3].mean((0, 1))
    np.testing.assert_allclose(mirrored, middle, rtol=0.1)


def test_a_photograph_stays_one(street):
    layer = photo_layer(street.pixels, "Panorama", width_px=128, gain=2.0)
    assert (layer.photo, layer.width_px, layer.gain) == (True, 192, 2.0)
    back = decode_image(base64.b64decode(layer.data), what="layer").astype(int)
    assert back.shape == (96, 192, 3)
    assert np.abs(back.mean((0, 1)) - street.pixels.mean((0, 1))).max() < 2


def test_only_pictures_of_the_whole_sphere_are_layers(patches, street):
    with pytest.raises(ImageError):
        radiance_layer(patches.radiance[:, :200], "half")
    with pytest.raises(ImageError):
        photo_layer(street.pixels[:100], "cropped")
    with pytest.raises(UsageError, match="uint8"):
        photo_layer(street.pixels.astype(np.float32), "float")


def test_an_entry_puts_everything_on_the_maps_scale(patches, street):
    photo = {"Panorama": street.pixels}
    entry = light_map(patches, "quay", photos=photo, references={"Truth": (patches, 0.5)})
    assert [(one.label, one.gain) for one in entry.layers] == [
        ("Light map", 1.0),
        ("Truth", 0.5),
        ("Panorama", 1.0),
    ]
    assert (entry.display_gain, entry.unit) == (1.0, "× white")
    # Without an anchor the photograph's white is put where the picture shows white.
    loose = light_map(patches.with_changes(anchor="relative"), "quay", photos=photo)
    assert loose.layers[1].gain == pytest.approx(1 / loose.display_gain)
