"""Laws of estimates: mirrors, rotations, energy."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.frames import Rotation, angle_between
from panokit.lighting import fuse_estimates
from panokit.lighting.representations import latlong_radiance, square_radiance
from panokit.reflectance.mirroring import direction_difference_deg, log_difference, mirrored_map
from panokit.sphere import energy, light_vector
from tests.lighting.fakes import beacon, estimate_of

SEEDS = st.integers(0, 2**32 - 1)
ANGLES = st.floats(-3, 3)
FEW = settings(max_examples=20, deadline=None)


def any_map(seed, spread=1.5):
    return np.random.default_rng(seed).lognormal(0, spread, (64, 64, 3)).astype(np.float32)


@FEW
@given(seed=SEEDS, width=st.sampled_from([64, 96, 128, 256, 320]))
def test_the_lat_long_map_keeps_the_energy(seed, width):
    square = any_map(seed, 2.5)
    np.testing.assert_allclose(energy(latlong_radiance(square, width)), energy(square), rtol=1e-4)


@FEW
@given(seed=SEEDS)
def test_square_wide_square_is_the_same(seed):
    square = any_map(seed, 2.5)
    back = square_radiance(latlong_radiance(square, 128))
    np.testing.assert_allclose(back, square, rtol=1e-4)


@FEW
@given(one=SEEDS, other=SEEDS)
def test_a_mirror_changes_no_difference(one, other):
    maps = any_map(one), any_map(other)
    mirrored = [mirrored_map(each) for each in maps]
    np.testing.assert_allclose(
        log_difference(*mirrored), mirrored_map(log_difference(*maps)), atol=1e-5
    )
    np.testing.assert_allclose(
        direction_difference_deg(*mirrored), direction_difference_deg(*maps), atol=1e-4
    )


@FEW
@given(heading=ANGLES, pitch=st.floats(-1.4, 1.4), roll=ANGLES)
def test_a_fused_light_lies_where_the_rotation_takes_it(heading, pitch, roll):
    turn = Rotation.from_heading_pitch_roll(heading, pitch, roll)
    direction = np.array([0.4, 0.5, -0.8])
    seen = beacon(direction, level=0.01, peak=1e4)
    found = fuse_estimates([estimate_of(seen)] * 2, [turn, turn])
    away = angle_between(light_vector(found.radiance), turn.apply(light_vector(seen)))
    assert np.degrees(away) < 2
    np.testing.assert_allclose(energy(found.radiance), energy(seen), rtol=1e-3)


@FEW
@given(seed=SEEDS, gain=st.floats(0.05, 20))
def test_twice_as_bright_estimates_make_a_twice_as_bright_one(seed, gain):
    maps = [any_map(seed + k) for k in range(3)]
    plain = fuse_estimates([estimate_of(one) for one in maps]).radiance
    bright = fuse_estimates([estimate_of(one) for one in maps], gains=[gain] * 3).radiance
    np.testing.assert_allclose(bright, gain * plain, rtol=1e-3)


@FEW
@given(seed=SEEDS)
def test_the_order_of_estimates_does_not_matter(seed):
    estimates = [estimate_of(any_map(seed + k), error=0.2 + 0.3 * k) for k in range(3)]
    np.testing.assert_allclose(
        fuse_estimates(estimates).radiance, fuse_estimates(estimates[::-1]).radiance, rtol=1e-4
    )
