import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.metrics import sun_energy_stops


def sky(sun: float, column: int = 40) -> np.ndarray:
    radiance = np.full((64, 128, 3), 0.2, np.float32)
    radiance[20, column] = sun
    return radiance


def test_half_the_sun_is_one_stop_missing():
    truth = sky(1e5)
    assert sun_energy_stops(truth, truth) == 0
    assert sun_energy_stops(truth / 4, truth) == pytest.approx(-2)
    # The sky round the sun counts too, but is nothing against it.
    assert sun_energy_stops(sky(5e4), truth) == pytest.approx(-1, abs=1e-3)


def test_a_sun_elsewhere_does_not_count():
    # By hand: what is left within 5 degrees is the sky, of as many pixels.
    truth = sky(1e5)
    missing = sun_energy_stops(sky(1e5, column=90), truth)
    assert missing < -10
    assert sun_energy_stops(truth * 0, truth) == float("-inf")
    assert np.isnan(sun_energy_stops(truth, truth * 0))


def test_light_moved_within_the_radius_still_counts():
    assert sun_energy_stops(sky(1e5, column=41), sky(1e5)) == pytest.approx(0, abs=1e-3)
    assert sun_energy_stops(sky(1e5, column=41), sky(1e5), radius_deg=1.5) < -5


def test_the_radius_is_checked():
    with pytest.raises(UsageError, match="radius"):
        sun_energy_stops(sky(1), sky(1), radius_deg=0)
