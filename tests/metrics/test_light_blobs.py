import numpy as np
import pytest

from panokit.errors import ImageError
from panokit.frames import angle_between, direction_from_azimuth_elevation
from panokit.metrics import find_light_blobs
from panokit.sphere import equirect_directions


def lamps(*lights: tuple[float, float, float, tuple[float, float, float]], width=256):
    """Round lamps: azimuth, elevation and diameter in degrees, and color, on a dim sky."""
    directions = equirect_directions(width, width // 2)
    radiance = np.full((width // 2, width, 3), 0.001, np.float32)
    for azimuth, elevation, diameter, color in lights:
        toward = direction_from_azimuth_elevation(*np.deg2rad([azimuth, elevation]))
        radiance[directions @ toward >= np.cos(np.deg2rad(diameter / 2))] = color
    return radiance


def test_a_lamp_has_its_place_size_energy_and_color():
    (blob,) = find_light_blobs(lamps((30, 40, 12, (4, 2, 1))))
    toward = direction_from_azimuth_elevation(*np.deg2rad([30, 40]))
    assert np.degrees(angle_between(blob.direction, toward)) < 0.2
    solid_angle = 2 * np.pi * (1 - np.cos(np.deg2rad(6)))
    assert blob.solid_angle_sr == pytest.approx(solid_angle, rel=0.05)
    assert blob.energy == pytest.approx(np.array([4, 2, 1]) * blob.solid_angle_sr, rel=1e-5)
    assert blob.strength == pytest.approx(blob.energy @ [0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize("place", [(180, 0), (179, 30), (0, 90), (50, -89)])
def test_seam_and_poles_are_places_like_others(place):
    (blob,) = find_light_blobs(lamps((*place, 14, (3, 3, 3))))
    toward = direction_from_azimuth_elevation(*np.deg2rad(place))
    assert np.degrees(angle_between(blob.direction, toward)) < 0.5


def test_lights_come_strongest_first():
    three = ((0, 40, 8, (1, 1, 1)), (90, 0, 8, (3, 3, 3)), (-90, 0, 8, (2, 2, 2)))
    blobs = find_light_blobs(lamps(*three))
    ratios = [blob.strength / blobs[-1].strength for blob in blobs]
    assert ratios == pytest.approx([3, 2, 1], rel=0.05)


def test_light_from_everywhere_is_no_light():
    assert find_light_blobs(np.full((64, 128, 3), 2.0, np.float32)) == ()
    assert find_light_blobs(np.zeros((64, 128, 3), np.float32)) == ()
    ring = np.full((64, 128, 3), 0.001, np.float32)
    ring[28:36] = 5
    assert find_light_blobs(ring) == ()


def test_a_lamp_and_its_halo_are_one_light():
    assert len(find_light_blobs(lamps((20, 30, 20, (1, 1, 1)), (20, 30, 6, (5, 5, 5))))) == 1


def test_size_changes_little():
    large, small = (
        find_light_blobs(lamps((30, 40, 12, (4, 2, 1)), width=width))[0] for width in (1024, 256)
    )
    assert np.degrees(angle_between(large.direction, small.direction)) < 0.2
    assert large.strength == pytest.approx(small.strength, rel=0.05)


def test_a_map_that_is_none_is_refused():
    with pytest.raises(ImageError, match="2:1"):
        find_light_blobs(np.ones((10, 30, 3), np.float32))
