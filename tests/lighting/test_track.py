"""The object is followed, and every loss is told."""

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.lighting import (
    Box,
    Track,
    open_frames,
    select_object,
    selection_from_mask,
    track_object,
)
from panokit.lighting.settings import TrackSettings
from panokit.lighting.track import Follower, TrackedFrame
from tests.lighting.clips import RADIUS, frame, sideways, write_folder


def ball_at(x, radius=RADIUS):
    return Box(x=x - radius, y=90 - radius, width=2 * radius, height=2 * radius)


def tracked(folder, frames, **settings):
    opened = open_frames(write_folder(folder, frames))
    selection = select_object(opened.frame(0), (200, 90))
    return track_object(opened, selection, 0, TrackSettings(**settings))


@pytest.mark.parametrize("tracker", ["kcf", "csrt"])
def test_a_ball_is_followed(tmp_path, tracker):
    track = tracked(tmp_path / "f", sideways(20, 4.0), tracker=tracker)
    assert [one.number for one in track.frames] == list(range(20))
    assert track.losses == ()
    assert track.warnings == ()
    for one in track.frames:
        assert one.state == "found"
        assert one.box.overlap(ball_at(200 - 4.0 * one.number)) > 0.85


def test_a_ball_that_comes_nearer_is_followed_in_size(tmp_path):
    frames = [frame(200 - 2 * k, radius=RADIUS + 0.35 * k) for k in range(25)]
    last = tracked(tmp_path / "f", frames).frames[-1]
    assert last.box.overlap(ball_at(200 - 48, RADIUS + 0.35 * 24)) > 0.8


def test_a_mask_drawn_by_hand_is_followed_by_the_filter_alone(tmp_path):
    opened = open_frames(write_folder(tmp_path / "f", sideways(12, 2.0)))
    selection = selection_from_mask(select_object(opened.frame(0), (200, 90)).mask)
    track = track_object(opened, selection)
    assert track.frames[-1].box.overlap(ball_at(178)) > 0.8


@pytest.mark.parametrize("tracker", ["kcf", "csrt"])
def test_an_object_that_vanishes_is_lost_and_told(tmp_path, tracker):
    frames = sideways(16)
    frames[8:] = [frame(-500, slide=-1.6)] * 8
    track = tracked(tmp_path / "f", frames, tracker=tracker)
    assert track.losses == ((8, 15),)
    assert track.warnings == ("The object was lost in frame 8 and not found again.",)
    assert track.frames[-1].box == track.frames[7].box  # where it was last seen


def test_an_object_that_comes_back_is_found_again(tmp_path):
    frames = sideways(20, 1.0)
    frames[8:11] = [frame(-500)] * 3
    track = tracked(tmp_path / "f", frames)
    (start, end), *others = track.losses
    assert (start, others) == (8, [])
    assert 10 <= end <= 12
    assert track.warnings == (f"The object was lost in frame 8 and found again in {end + 1}.",)


def test_an_object_that_leaves_the_frame_is_lost(tmp_path):
    frames = [frame(200 - 12 * k) for k in range(22)]
    track = tracked(tmp_path / "f", frames)
    assert track.losses
    assert track.losses[-1][1] == 21


def test_the_end_of_tracking_can_be_set(tmp_path):
    opened = open_frames(write_folder(tmp_path / "f", sideways(12)))
    selection = select_object(opened.frame(0), (200, 90))
    assert len(track_object(opened, selection, last=5).frames) == 6


def test_losses_are_stretches():
    states = ["found", "lost", "lost", "found", "lost"]
    frames = tuple(
        TrackedFrame(number=k, box=ball_at(9), state=state, likeness=1)
        for k, state in enumerate(states)
    )
    assert Track(frames=frames).losses == ((1, 2), (4, 4))
    assert len(Track(frames=frames).warnings) == 2


def test_frame_and_selection_must_fit():
    selection = select_object(frame(200), (200, 90))
    with pytest.raises(UsageError, match="another size"):
        Follower(np.zeros((90, 90, 3), np.uint8), selection)
