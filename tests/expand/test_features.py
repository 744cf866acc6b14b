import numpy as np
import pytest

from panokit.expand.component_features import COMPONENT_FEATURES, component_features
from panokit.expand.components import find_components
from panokit.expand.features import CHANNELS, grid_features
from panokit.expand.reduce import reduce_panorama


def test_every_channel_is_named_and_finite(lamps):
    grid = grid_features(reduce_panorama(lamps, 256))
    assert grid.shape == (len(CHANNELS), 64, 128)
    assert grid.dtype == np.float32
    assert np.isfinite(grid).all()


def test_rolling_the_picture_by_whole_cells_rolls_the_features(lamps):
    grid = grid_features(reduce_panorama(lamps, 256))
    rolled = grid_features(reduce_panorama(np.roll(lamps, 2 * 37, axis=1), 256))
    assert np.allclose(rolled, np.roll(grid, 37, axis=-1), atol=1e-5)


def test_a_larger_picture_of_the_same_scene_has_nearly_the_same_features(lamps):
    larger = lamps.repeat(4, axis=0).repeat(4, axis=1)
    grid = grid_features(reduce_panorama(lamps, 256))
    same = grid_features(reduce_panorama(larger, 256))
    assert np.allclose(same, grid, atol=2e-2)


def test_components_are_described_alike_whatever_the_heading(lamps):
    described = []
    for columns in (0, 64, 128):
        reduced = reduce_panorama(np.roll(lamps, columns, axis=1), 256)
        grid = grid_features(reduced)
        described.append(component_features(reduced, find_components(reduced), grid))
    assert described[0].shape == (3, COMPONENT_FEATURES)
    assert np.isfinite(described[0]).all()
    assert described[1] == pytest.approx(described[0], abs=1e-3)
    assert described[2] == pytest.approx(described[0], abs=1e-3)


def test_a_picture_without_burnt_out_pixels_has_no_components():
    reduced = reduce_panorama(np.full((128, 256, 3), 90, np.uint8), 256)
    components = find_components(reduced)
    assert len(components) == 0
    assert component_features(reduced, components, grid_features(reduced)).shape == (
        0,
        COMPONENT_FEATURES,
    )
