import numpy as np
import pytest

from panokit.expand.components import MOST_COMPONENTS, find_components, sum_by_component
from panokit.expand.reduce import reduce_panorama
from panokit.sphere import pixel_solid_angles


def test_components_come_by_solid_angle_and_close_over_the_seam(lamps):
    components = find_components(reduce_panorama(lamps, 256))
    assert len(components) == 3
    assert (np.diff(components.solid_angle) < 0).all()
    assert components.labels[73, 0] == components.labels[73, -1] == 3 - 1


def test_solid_angle_and_energy_are_sums_over_the_mask(lamps):
    reduced = reduce_panorama(lamps, 256)
    components = find_components(reduced)
    area = np.where(components.labels > 0, pixel_solid_angles(128, 256), 0)
    assert sum_by_component(area, components) == pytest.approx(components.solid_angle)
    # All is white, so the shown energy is the solid angle.
    assert components.energy == pytest.approx(components.solid_angle, rel=0.02)


def test_only_the_largest_are_kept():
    pixels = np.full((128, 256, 3), 50, np.uint8)
    for k in range(MOST_COMPONENTS + 6):
        pixels[60:62, 14 * k : 14 * k + 2 + k // 2] = 255
    components = find_components(reduce_panorama(pixels, 256))
    assert len(components) == MOST_COMPONENTS
    assert components.labels.max() == MOST_COMPONENTS


def test_distance_to_the_edge_does_not_stop_at_the_seam():
    pixels = np.full((128, 256, 3), 50, np.uint8)
    pixels[50:71, :11] = 255
    pixels[50:71, -10:] = 255
    edge = find_components(reduce_panorama(pixels, 256)).edge_deg
    assert edge[60, 0] == pytest.approx(edge.max())
    assert edge.max() == pytest.approx(11 * 180 / 128, rel=0.01)
