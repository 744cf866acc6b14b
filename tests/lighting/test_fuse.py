"""Estimates of one light from several frames become one."""

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import Rotation, angle_between
from panokit.lighting import fuse_estimates
from panokit.lighting.representations import latlong_radiance, square_radiance
from panokit.sphere import energy, light_vector, rotate_radiance
from tests.lighting.fakes import beacon, estimate_of

SUN = np.array([0.3, 0.6, -0.7])


def seen_from(radiance, turn: Rotation):
    """A square map as a camera sees it that is turned so from the common frame."""
    wide = rotate_radiance(latlong_radiance(radiance, 256), turn.inverse)
    return square_radiance(wide)


def lobe(direction, sharpness=30.0, peak=30.0):
    from panokit.sphere import equirect_directions

    unit = np.asarray(direction) / np.linalg.norm(direction)
    smooth = np.exp(sharpness * (equirect_directions(256, 128) @ unit - 1))
    wide = (0.3 + peak * smooth[..., None] * np.array([1, 0.9, 0.7])).astype(np.float32)
    return square_radiance(wide)


def test_one_alone_is_itself():
    radiance = np.random.default_rng(0).lognormal(0, 1, (64, 64, 3)).astype(np.float32)
    found = fuse_estimates([estimate_of(radiance)])
    np.testing.assert_allclose(found.radiance, radiance, rtol=1e-4)
    assert found.confidence.value == pytest.approx(np.exp(-0.3), rel=1e-3)
    assert found.provenance.last("lighting-fuse").values["estimates"] == 1


def test_cameras_that_turned_see_one_sun():
    truth = lobe(SUN)
    turns = [Rotation.from_heading_pitch_roll(a, 0.2 * a, 0.1) for a in (0.0, 0.9, -1.7)]
    found = fuse_estimates([estimate_of(seen_from(truth, turn)) for turn in turns], turns)
    toward = light_vector(found.radiance)
    assert np.degrees(angle_between(toward, light_vector(truth))) < 1
    np.testing.assert_allclose(energy(found.radiance), energy(truth), rtol=5e-3)


def test_without_the_turns_they_would_not():
    truth = lobe(SUN)
    turns = [Rotation.from_heading_pitch_roll(a) for a in (0.0, 1.2)]
    wrong = fuse_estimates([estimate_of(seen_from(truth, turn)) for turn in turns])
    assert np.degrees(angle_between(light_vector(wrong.radiance), light_vector(truth))) > 10


def test_energy_is_kept():
    rng = np.random.default_rng(3)
    maps = [rng.lognormal(0, 1.5, (64, 64, 3)).astype(np.float32) for _ in range(4)]
    scaled = [one * (energy(maps[0]) / energy(one)).astype(np.float32) for one in maps]
    found = fuse_estimates([estimate_of(one) for one in scaled])
    np.testing.assert_allclose(energy(found.radiance), energy(maps[0]), rtol=1e-4)


def test_of_two_neither_is_preferred():
    dark, bright = (np.full((64, 64, 3), value, np.float32) for value in (1.0, 4.0))
    found = fuse_estimates([estimate_of(dark), estimate_of(bright)])
    np.testing.assert_allclose(found.radiance, 2, rtol=1e-3)


def test_the_sure_one_counts_more():
    dark, bright = (np.full((64, 64, 3), value, np.float32) for value in (1.0, 4.0))
    found = fuse_estimates([estimate_of(dark, error=0.2), estimate_of(bright, error=1.0)])
    assert found.radiance.mean() < 1.2


def test_a_stray_sun_hardly_counts():
    maps = [lobe(SUN) for _ in range(4)]
    stray = lobe([-0.9, 0.1, 0.4], peak=60.0)
    plain = np.mean([*maps, stray], axis=0)
    found = fuse_estimates([estimate_of(one) for one in [*maps, stray]]).radiance
    there = np.unravel_index(int(stray[..., 1].argmax()), (64, 64))
    assert found[there][1] < 0.25 * plain[there][1]
    assert np.degrees(angle_between(light_vector(found), light_vector(maps[0]))) < 5


def test_noise_averages_out():
    truth = lobe(SUN)
    rng = np.random.default_rng(5)
    noisy = [truth * rng.lognormal(0, 0.5, truth.shape).astype(np.float32) for _ in range(8)]
    found = fuse_estimates([estimate_of(one) for one in noisy]).radiance

    def off(one):
        return float(np.abs(np.log(one / truth)).mean())

    assert off(found) < 0.6 * off(noisy[0])


def test_where_they_disagree_the_result_is_less_sure():
    same = fuse_estimates([estimate_of(beacon(SUN)), estimate_of(beacon(SUN))])
    other = fuse_estimates([estimate_of(beacon(SUN)), estimate_of(beacon([-1, 0.5, 1]))])
    assert other.confidence.value < same.confidence.value
    row, column = np.unravel_index(int(beacon(SUN)[..., 0].argmax()), (64, 64))
    assert other.confidence.map[row, column] < 0.1


def test_without_confidence_all_count_alike():
    maps = [np.full((64, 64, 3), value, np.float32) for value in (1.0, 4.0)]
    found = fuse_estimates([estimate_of(one, error=None) for one in maps])
    assert found.confidence is None
    np.testing.assert_allclose(found.radiance, 2, rtol=1e-3)


def test_other_exposures_are_brought_to_one():
    truth = lobe(SUN)
    found = fuse_estimates(
        [estimate_of(truth), estimate_of(truth * np.float32(0.25))], gains=[1.0, 4.0]
    )
    np.testing.assert_allclose(found.radiance, truth, rtol=1e-3)


def test_the_level_of_the_first_camera_is_kept():
    turn = Rotation.from_heading_pitch_roll(0.5, 0.2, 0)
    level = Rotation.from_heading_pitch_roll(0, 0.2, 0)
    found = fuse_estimates([estimate_of(lobe(SUN), level=level)], [turn])
    common = turn.apply(np.array([0.0, 0, -1]))
    np.testing.assert_allclose(
        found.level_from_camera.apply(common), level.apply(np.array([0.0, 0, -1])), atol=1e-9
    )


@pytest.mark.parametrize(
    ("count", "more"),
    [(0, {}), (2, {"common_from_camera": [Rotation.identity()]}), (1, {"gains": [0.0]})],
)
def test_what_does_not_fit_together_is_refused(count, more):
    with pytest.raises(UsageError):
        fuse_estimates([estimate_of(lobe(SUN))] * count, **more)
