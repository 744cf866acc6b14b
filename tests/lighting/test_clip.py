"""The clip that comes with panokit, and how near to its truth a model comes."""

from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from panokit.evaluate.lighting.background import BackgroundExtrapolation
from panokit.frames import angle_between
from panokit.io import read_exr
from panokit.lighting import (
    LightingModel,
    SessionSettings,
    clip_path,
    find_pair,
    open_frames,
    read_light,
    select_object,
    track_object,
)
from panokit.lighting.clip import CLIP_CLICK, CLIP_FOV_DEG
from panokit.lighting.representations import latlong_radiance
from panokit.reflectance.mirroring import direction_difference_deg
from panokit.sphere import find_lights, light_vector

TRUTH = Path(__file__).parent / "clip_truth.exr"
# Where the light of the mean map of the training data of `lighting-1` comes from.
MEAN_LIGHT = (-0.007, 0.9992, -0.039)


@pytest.fixture(scope="module")
def frames():
    return open_frames(clip_path())


@pytest.fixture(scope="module")
def pair(frames):
    return find_pair(frames, CLIP_CLICK).pair


def test_the_clip_is_small_and_whole(frames):
    assert clip_path().stat().st_size < 2e6
    assert frames.size_px == (640, 360)
    assert len(list(frames.frames_from(0))) == frames.count == 60
    assert frames.codec == "MPEG-4"
    assert SessionSettings().snapshot.fov_deg == CLIP_FOV_DEG


def test_one_click_selects_the_teapot(frames):
    found = select_object(frames.frame(CLIP_CLICK.frame), (CLIP_CLICK.column, CLIP_CLICK.row))
    box = found.box
    # Knob, spout and handle are in it.
    assert (box.x, box.y) == (pytest.approx(314, abs=6), pytest.approx(144, abs=6))
    assert (box.width, box.height) == (pytest.approx(190, abs=8), pytest.approx(129, abs=8))


def test_the_teapot_is_followed_through_the_clip(frames):
    found = select_object(frames.frame(0), (CLIP_CLICK.column + 24, CLIP_CLICK.row))
    track = track_object(frames, found)
    assert track.losses == ()
    # The camera moves evenly, so the object does.
    columns = [one.box.center[0] for one in track.frames]
    line = np.polyval(np.polyfit(range(60), columns, 1), range(60))
    assert np.abs(columns - line).max() < 8
    assert columns[0] - columns[-1] == pytest.approx(234, abs=12)


def test_the_views_meet_all_assumptions(pair):
    assert pair.warnings == ()
    assert pair.shift == pytest.approx(0.2, abs=0.03)


def test_the_truth_is_that_of_this_clip():
    truth, attributes = read_exr(TRUTH)
    assert truth.shape == (64, 64, 3)
    assert attributes["projection"] == "equirectangular-anamorphic"
    vector = light_vector(truth)
    # The sun stands to the right; the shaded side of the teapot is the left one.
    assert vector[0] / np.linalg.norm(vector) > 0.8


def test_a_model_comes_nearer_to_the_truth_than_what_needs_none(pair, capsys):
    model = LightingModel(SessionSettings().model)
    truth, _ = read_exr(TRUTH)
    _, fused = read_light([pair], model)
    sample = SimpleNamespace(views=pair.views)
    background = BackgroundExtrapolation().predict(sample)
    vector = light_vector(truth)
    mean_deg = np.rad2deg(np.arccos(vector @ MEAN_LIGHT / np.linalg.norm(vector)))
    found_deg = direction_difference_deg(fused.radiance, truth)
    background_deg = direction_difference_deg(background, truth)
    lights = [find_lights(latlong_radiance(one, 256)).primary for one in (fused.radiance, truth)]
    with capsys.disabled():
        if all(lights):
            main_deg = np.rad2deg(angle_between(*(one.direction for one in lights)))
            print(f"\nclip, main light off by {main_deg:.1f} degrees", end="")
        print(
            f"\nclip, light off by: {model.released.id} {found_deg:.1f}, mean map {mean_deg:.1f}, "
            f"background {background_deg:.1f} degrees"
        )
    assert found_deg < min(mean_deg, background_deg)
    assert np.isfinite(fused.radiance).all()


@pytest.mark.render
def test_the_script_makes_such_a_clip(tmp_path, monkeypatch):
    pytest.importorskip("mitsuba")
    from tests.lighting import make_clip

    path, truth = tmp_path / "clip.mp4", tmp_path / "truth.exr"
    monkeypatch.setattr(make_clip, "clip_path", lambda: path)
    monkeypatch.setattr(make_clip, "TRUTH", truth)
    sky = np.full((64, 128, 3), 0.3, np.float32)
    sky[12:16, 90:94] = 60
    make_clip.main(2, 2, cv2.resize(sky, (256, 128), interpolation=cv2.INTER_NEAREST))
    assert open_frames(path).frame(1).shape == (360, 640, 3)
    assert read_exr(truth)[0].shape == (64, 64, 3)
