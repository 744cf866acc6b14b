import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.metrics import light_direction_error_deg
from panokit.metrics.light_direction import nearest_angle_deg


def lamps(*places: tuple[int, int, float]) -> np.ndarray:
    radiance = np.full((128, 256, 3), 1e-4, np.float32)
    for row, column, value in places:
        radiance[row - 2 : row + 3, column - 2 : column + 3] = value
    return radiance


@pytest.mark.parametrize("variant", ["compat", "fixed"])
def test_a_lamp_turned_by_eight_columns_is_off_by_their_angle(variant):
    error = light_direction_error_deg(lamps((64, 88, 5)), lamps((64, 80, 5)), variant)
    assert error == pytest.approx(8 * 360 / 256, abs=0.05)


def test_nearest_angles_by_hand():
    x, y, z = np.eye(3)
    a, b = np.array([x, y]), np.array([x])
    # x finds x; y is 90 degrees from x; b's x finds a's: (0 + 90 + 0) / 3.
    assert nearest_angle_deg(a, b) == pytest.approx(30)
    assert nearest_angle_deg(a, np.array([z])) == pytest.approx(90)
    assert np.isnan(nearest_angle_deg(a, np.zeros((0, 3))))


def test_compat_cuts_both_lists_to_the_shorter_one_in_scan_order():
    # The lower lamp is the true one; the estimate has a second, fainter one above it.
    truth = lamps((90, 40, 5))
    estimate = lamps((30, 200, 4), (60, 120, 4), (90, 40, 5))
    # A single light is doubled, so the first two of the estimate are compared with it.
    assert light_direction_error_deg(estimate, truth, "compat") > 80
    # All lights: nearest are (a, b, 0) for the estimate's and 0 for the truth's.
    fixed = light_direction_error_deg(estimate, truth, "fixed")
    assert fixed == pytest.approx(
        np.mean([fixed_angle(30, 200), fixed_angle(60, 120), 0, 0]), abs=0.5
    )


def fixed_angle(row: int, column: int) -> float:
    """The angle from the lamp at row 90, column 40."""

    def direction(row: int, column: int) -> np.ndarray:
        polar, azimuth = (row + 0.5) / 128 * np.pi, (column + 0.5) / 256 * 2 * np.pi
        return np.array(
            [np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)]
        )

    return float(np.degrees(np.arccos(direction(row, column) @ direction(90, 40))))


@pytest.mark.parametrize("variant", ["compat", "fixed"])
def test_a_map_without_lights_has_no_error_and_no_score(variant):
    dark = np.zeros((128, 256, 3), np.float32)
    assert np.isnan(light_direction_error_deg(dark, lamps((64, 80, 5)), variant))


def test_variants_are_named():
    with pytest.raises(UsageError, match="'compat' or 'fixed'"):
        light_direction_error_deg(lamps(), lamps(), "apple")  # type: ignore[arg-type]
