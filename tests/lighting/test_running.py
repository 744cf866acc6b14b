"""An estimate is kept up over a video: averaged in the same light, read anew in another."""

from dataclasses import replace

import numpy as np
import pytest

from panokit.lighting import Click, SessionSettings, open_frames, running_light
from panokit.lighting.running import brightness
from panokit.lighting.settings import RunningSettings
from tests.lighting.clips import frame, sideways, write_folder
from tests.lighting.fakes import beacon, estimate_of

CLICK = Click(column=200, row=90)


class Model:
    """Says how bright the views are, and counts how often it was asked."""

    def __init__(self):
        self.asked = 0

    def estimate(self, views):
        self.asked += 1
        level = float(views.left.mean()) / 255
        return replace(
            estimate_of(beacon((0, 1, -0.2), level=level, peak=level)), model=str(self.asked)
        )


def run(folder, pictures, **settings):
    model = Model()
    frames = open_frames(write_folder(folder, pictures))
    given = SessionSettings(running=RunningSettings(**settings))
    return list(running_light(frames, CLICK, model, given)), model


def test_it_waits_reads_and_keeps(tmp_path):
    states, model = run(tmp_path / "f", sideways(24))
    what = [state.what for state in states]
    assert len(states) == 24
    assert what[:4] == ["waiting"] * 4
    first = what.index("read")
    assert 5 <= first <= 8
    assert all(state.estimate is None for state in states[:first])
    assert all(state.estimate is not None for state in states[first:])
    # Not asked for every frame: only where the camera has moved on by as much again.
    assert 2 <= model.asked == what.count("read") <= 4
    assert set(what[first:]) == {"read", "kept"}


def test_readings_of_the_same_light_are_averaged_up_to_a_number(tmp_path):
    states, model = run(tmp_path / "f", sideways(24), most=2)
    assert max(state.readings for state in states) == 2
    assert model.asked >= 3
    assert states[-1].estimate.provenance.last("lighting-fuse").values["estimates"] == 2


def test_another_light_is_read_anew_and_the_old_is_forgotten(tmp_path):
    pictures = sideways(24)
    pictures[12:] = [np.asarray(one * 0.5, np.uint8) for one in pictures[12:]]
    states, _ = run(tmp_path / "f", pictures)
    what = [state.what for state in states]
    assert what[12] == "changed"
    assert what.count("changed") == 1
    assert states[12].readings == 0
    before, at, last = (states[k].estimate.radiance.mean() for k in (11, 12, 23))
    # Scaled by the change until it is read again; then it is what was read.
    assert at < 0.6 * before
    assert "read" in what[13:]
    assert states[-1].readings == what[13:].count("read")
    assert last == pytest.approx(before * 0.5, rel=0.1)


def test_small_changes_are_no_other_light(tmp_path):
    pictures = [
        np.asarray(one * (1 - 0.02 * (k % 2)), np.uint8) for k, one in enumerate(sideways())
    ]
    assert "changed" not in [state.what for state in run(tmp_path / "f", pictures)[0]]


def test_a_lost_object_is_not_read(tmp_path):
    pictures = sideways(14)
    pictures[9:] = [frame(-500)] * 5
    states, model = run(tmp_path / "f", pictures)
    assert [state.what for state in states[9:]] == ["lost"] * 5
    assert model.asked == 1
    assert states[-1].estimate is not None


def test_brightness_follows_the_exposure():
    picture = frame()
    half = np.asarray(picture * 0.735, np.uint8)  # half of the light in sRGB
    assert brightness(half) / brightness(picture) == pytest.approx(0.5, abs=0.04)
