import math
import os
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest

from panokit.capture import local_capture
from panokit.frames import Frame, Rotation
from panokit.io import decode_image
from panokit.sphere import equirect_directions, rotate_pixels
from panokit.stitch import find_upright
from panokit.stitch.level import leveling_from


def street(width_px=1024, seed=0):
    """House fronts with windows: brightness by azimuth and height, all edges upright or level."""
    rng = np.random.default_rng(seed)
    directions = equirect_directions(width_px, width_px // 2)
    azimuth = np.arctan2(directions[..., 0], -directions[..., 2])
    slope = directions[..., 1] / np.hypot(directions[..., 0], directions[..., 2])
    picture = np.full((*azimuth.shape, 3), 200, np.float32)
    picture[slope < -0.25] = 90
    edges = np.sort(rng.uniform(-math.pi, math.pi, 40))
    for left, right in pairwise(edges):
        house = (azimuth > left) & (azimuth < right) & (slope > -0.25)
        picture[house & (slope < rng.uniform(0.4, 1.2))] = rng.uniform(60, 180, 3)
        third = (right - left) / 3
        window = (azimuth > left + third) & (azimuth < right - third)
        picture[window & (slope > 0) & (slope < 0.3)] = rng.uniform(20, 240, 3)
    picture = cv2.GaussianBlur(picture, (3, 3), 0)
    return np.clip(picture + rng.normal(0, 2, picture.shape), 0, 255).astype(np.uint8)


def leaning(scene, pitch_deg, roll_deg):
    """What a camera with this pitch and roll sees of a level scene."""
    pose = Rotation.from_heading_pitch_roll(0.0, math.radians(pitch_deg), math.radians(roll_deg))
    return rotate_pixels(scene, pose.inverse)


@pytest.mark.parametrize(
    ("pitch_deg", "roll_deg"), [(0, 0), (5, 0), (0, -7), (-11, 8), (3, 14), (18, -6)]
)
def test_the_lines_of_houses_say_how_the_camera_stood(pitch_deg, roll_deg):
    found = find_upright(leaning(street(), pitch_deg, roll_deg))
    assert found.confidence > 0.8
    assert found.pitch_deg == pytest.approx(pitch_deg, abs=0.4)
    assert found.roll_deg == pytest.approx(roll_deg, abs=0.4)


def test_a_picture_without_lines_says_nothing():
    rng = np.random.default_rng(0)
    coarse = rng.uniform(0, 255, (16, 32, 3)).astype(np.float32)
    clouds = cv2.resize(coarse, (1024, 512), interpolation=cv2.INTER_CUBIC)
    assert find_upright(np.clip(clouds, 0, 255).astype(np.uint8)).confidence < 0.3
    assert find_upright(np.full((256, 512, 3), 128, np.uint8)).confidence == 0


def test_unknown_pitch_and_roll_come_from_the_picture():
    pixels = leaning(street(), 6, -4)
    plan = leveling_from(local_capture("x", heading_deg=30.0), pixels, "auto")
    assert plan.source == "picture"
    assert plan.frame is Frame.WORLD
    assert plan.assumed == ()
    heading, pitch, roll = np.rad2deg(plan.target_from_camera.heading_pitch_roll())
    assert heading == pytest.approx(30)
    assert (pitch, roll) == (pytest.approx(6, abs=0.4), pytest.approx(-4, abs=0.4))
    record = plan.to_json()
    assert record["upright_from"] == "picture"
    assert record["upright_found"]["confidence"] > 0.8


def test_good_metadata_stays_and_wrong_metadata_does_not():
    pixels = leaning(street(), 6, -4)
    good = local_capture("x", pitch_deg=5.5, roll_deg=-4.0)
    assert leveling_from(good, pixels, "auto").source == "metadata"
    wrong = local_capture("x", pitch_deg=-6.0, roll_deg=4.0)
    assert leveling_from(wrong, pixels, "auto").source == "picture"
    assert leveling_from(wrong, pixels, "metadata").source == "metadata"
    assert leveling_from(wrong, pixels, "metadata").found is None
    assert leveling_from(good, pixels, "picture").source == "picture"


def test_a_level_picture_is_left_as_it_is():
    plan = leveling_from(local_capture("x"), street(), "auto")
    assert plan.source == "assumed"
    assert plan.target_from_camera.angle == 0


@pytest.mark.data
@pytest.mark.parametrize("name", ["bma-0", "jfk", "alma-correlator-facility"])
def test_tilted_photographs(name):
    folder = os.environ.get("PANOKIT_DATA")
    if not folder:
        pytest.skip("PANOKIT_DATA is not set")
    path = Path(folder) / "panoramas" / f"pannellum_{name}.jpg"
    full = decode_image(path.read_bytes(), what=name)
    photo = cv2.resize(full, (2048, 1024), interpolation=cv2.INTER_AREA)
    straight = find_upright(photo).level_from_camera
    pose = Rotation.from_heading_pitch_roll(0.0, math.radians(9), math.radians(-7))
    found = find_upright(rotate_pixels(photo, pose.inverse))
    assert found.confidence > 0.8
    up, expected = found.level_from_camera.matrix[1], (straight @ pose).matrix[1]
    assert math.degrees(math.acos(min(1, float(up @ expected)))) < 0.8
