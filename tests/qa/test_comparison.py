"""A map against its truth: equal is perfect, and each figure sees the error it is for."""

import numpy as np
import pytest

from panokit.envmap import Anchor
from panokit.frames import Frame, Rotation
from panokit.qa import QaSettings, compare
from panokit.sphere import resize, rotate


def figures(envmap, truth):
    return {d.name: d.value for d in compare(envmap, truth).differences}


def test_a_map_equal_to_its_truth_is_perfect(make_map):
    found = figures(make_map(), make_map())
    assert found["energy-ratio"] == pytest.approx(1, rel=1e-6)
    assert found["source-energy-ratio"] == pytest.approx(1, rel=1e-6)
    assert found["pu21-psnr"] == 100
    for name in ("irradiance-error", "light-direction", "peak-direction", "diffuse-ball",
                 "diffuse-ball-shading", "mirror-ball"):  # fmt: skip
        assert found[name] == pytest.approx(0, abs=1e-4), name


def test_a_scale_that_is_relative_is_aligned_and_one_that_is_absolute_is_not(make_map):
    truth = make_map().with_changes(anchor=Anchor.RELATIVE)
    doubled = make_map().with_changes(radiance=truth.radiance * np.float32(2))
    aligned = compare(doubled, truth)
    assert aligned.gain == pytest.approx(0.5, rel=1e-3)
    assert figures(doubled, truth)["energy-ratio"] == pytest.approx(1, rel=1e-3)
    physical = {"anchor": Anchor.LUMINANCE}
    absolute = compare(doubled.with_changes(**physical), truth.with_changes(**physical))
    assert absolute.gain == 1
    assert absolute.differences[0].value == pytest.approx(2)


def test_a_missing_sun_is_missing_energy_and_not_a_wrong_scale(make_map):
    truth = make_map(sun=3e4)
    without = truth.with_changes(radiance=np.minimum(truth.radiance, 1))
    found = figures(without, truth)
    assert found["energy-ratio"] < 0.5
    assert found["source-energy-ratio"] < 0.01
    assert found["irradiance-error-max"] > 50
    assert compare(without, truth).gain == pytest.approx(1, rel=1e-3)


def test_a_sun_in_the_wrong_place_is_seen_in_degrees(make_map):
    found = figures(make_map(azimuth_deg=50), make_map(azimuth_deg=40))
    # 10 degrees of azimuth at 35 degrees of elevation.
    assert found["peak-direction"] == pytest.approx(8.2, abs=0.5)
    assert found["light-direction"] > 4
    assert found["diffuse-ball-shading"] > 2


def test_maps_of_other_sizes_meet_at_the_smaller(make_map):
    truth = make_map(512)
    found = figures(resize(truth, 128), truth)
    assert found["energy-ratio"] == pytest.approx(1, abs=1e-3)
    assert found["light-direction"] < 0.1


def test_the_settings_bound_the_size(make_map):
    truth = make_map()
    shifted = rotate(truth, Rotation.about_axis((0, 1, 0), 0.02))
    fine, coarse = (
        compare(shifted, truth, QaSettings(comparison_width_px=width)) for width in (256, 64)
    )
    values = [{d.name: d.value for d in c.differences}["pu21-psnr"] for c in (fine, coarse)]
    assert values[0] != pytest.approx(values[1], abs=0.1)


def test_maps_in_other_frames_are_not_compared(make_map):
    found = compare(make_map().with_changes(frame=Frame.CAMERA), make_map())
    assert "frame is camera" in found.obstacle
    assert found.differences == ()


def test_a_black_truth_is_an_obstacle_and_no_number(make_map):
    black = make_map().with_changes(radiance=np.zeros((128, 256, 3), np.float32))
    found = compare(make_map(), black)
    assert "black" in found.obstacle
    assert found.differences == ()
