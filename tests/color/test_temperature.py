import numpy as np
import pytest

from panokit.color import chromaticity, color_temperature
from panokit.errors import UsageError


def linear_from_xy(x, y):
    xyz = np.array([x / y, 1, (1 - x - y) / y])
    # The inverse of IEC 61966-2-1's matrix, as the standard prints it.
    return xyz @ np.array(
        [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
    ).T  # fmt: skip


def test_white_is_d65():
    np.testing.assert_allclose(chromaticity(np.ones(3)), [0.3127, 0.3290], atol=1e-4)
    np.testing.assert_allclose(
        chromaticity(np.full((2, 5, 3), 7e3))[1, 2], [0.3127, 0.329], atol=1e-4
    )
    found = color_temperature(np.ones(3))
    assert found.kelvin == pytest.approx(6504, abs=5)
    assert found.duv == pytest.approx(0.0032, abs=2e-4)


@pytest.mark.parametrize(
    ("xy", "kelvin", "duv"),
    [
        ((0.44758, 0.40745), 2856, 0.0),  # illuminant A, CIE 15
        ((0.34567, 0.35850), 5003, 0.0032),  # D50
        ((0.29902, 0.31485), 7504, 0.0032),  # D75
    ],
)
def test_standard_illuminants(xy, kelvin, duv):
    found = color_temperature(linear_from_xy(*xy))
    assert found.kelvin == pytest.approx(kelvin, rel=2e-3)
    assert found.duv == pytest.approx(duv, abs=4e-4)


def test_the_scale_does_not_matter():
    warm = np.array([1.0, 0.6, 0.25])
    assert color_temperature(warm).kelvin == pytest.approx(color_temperature(warm * 1e5).kelvin)


@pytest.mark.parametrize(
    "color", [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 0, 0], [0.1, 0.2, 1.5], [-0.1, 1, 1]]
)
def test_what_has_no_temperature_gets_none(color):
    assert color_temperature(np.array(color, float)) is None


def test_black_has_no_chromaticity():
    assert np.isnan(chromaticity(np.zeros(3))).all()


def test_bad_calls_say_what_is_wrong():
    with pytest.raises(UsageError, match="finite"):
        color_temperature(np.array([1, np.nan, 1]))
    with pytest.raises(UsageError, match="three"):
        color_temperature(np.ones((2, 3)))
    with pytest.raises(UsageError, match="shape"):
        chromaticity(np.ones(4))
