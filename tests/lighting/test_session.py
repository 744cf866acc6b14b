"""From clicks in a video to one map, and what stands in the way is told."""

import json

import numpy as np
import pytest

from panokit.errors import ImageError, ItemError, UsageError
from panokit.frames import Rotation, angle_between
from panokit.lighting import (
    Click,
    SessionSettings,
    find_pair,
    light_from_video,
    open_frames,
    pair_of,
    read_light,
    read_outputs,
    select_object,
    selection_from_mask,
    write_session,
)
from panokit.lighting.settings import OutputSettings, SnapshotSettings
from panokit.lighting.snapshots import Snapshot
from panokit.sphere import light_vector
from tests.lighting.clips import COLOR, frame, sideways, write_folder, write_video
from tests.lighting.fakes import beacon, estimate_of

CLICK = Click(column=200, row=90)


class KnowingModel:
    """Says where a light is that shines from one place of the video, whatever the view."""

    def __init__(self, direction=(1.0, 0.5, -0.5), errors=(0.3,)):
        self.direction, self.errors, self.seen = np.array(direction), errors, []

    def estimate(self, views):
        error = self.errors[len(self.seen) % len(self.errors)]
        self.seen.append(views)
        turn = self.turns[len(self.seen) - 1] if hasattr(self, "turns") else Rotation.identity()
        return estimate_of(
            beacon(turn.inverse.apply(self.direction)), error=error, level=views.left_level,
            model="knowing",
        )  # fmt: skip


@pytest.fixture(scope="module")
def frames(tmp_path_factory):
    return open_frames(write_video(tmp_path_factory.mktemp("s") / "ball.mp4", sideways()))


def folder(tmp_path, pictures):
    return open_frames(write_folder(tmp_path / "frames", pictures))


def test_a_click_leads_to_two_views_a_fifth_apart(frames):
    told = []
    found = find_pair(frames, CLICK, on_frame=told.append)
    assert found.pair.left.number == 0
    assert 5 <= found.pair.right.number <= 7
    assert found.pair.shift == pytest.approx(0.2, abs=0.03)
    assert found.warnings == ()
    # No further than need be.
    assert [one.number for one in told] == [one.number for one in found.track.frames]
    assert told[-1].number <= 8


def test_another_shift_waits_longer(frames):
    settings = SessionSettings(snapshot=SnapshotSettings(shift=0.5))
    assert find_pair(frames, CLICK, settings).pair.right.number >= 15


def test_a_corrected_mask_is_kept(frames):
    picture = frames.frame(0)
    mask = select_object(picture, (200, 90)).mask.copy()
    mask[:80] = False
    first = Snapshot(number=0, picture=picture, selection=selection_from_mask(mask))
    pair = pair_of(frames, first).pair
    np.testing.assert_array_equal(pair.left.selection.mask, mask)
    assert pair.right.selection.box.height < 0.8 * 64


def test_an_object_that_never_moves_is_no_pair(tmp_path):
    with pytest.raises(ItemError, match=r"moved sideways by [01]%.*Move the camera") as caught:
        find_pair(folder(tmp_path, [frame(200)] * 6), CLICK)
    assert caught.value.reason == "no-parallax"


def test_an_object_that_only_moves_up_is_no_pair(tmp_path):
    with pytest.raises(ItemError, match="20% are needed"):
        find_pair(folder(tmp_path, [frame(200, 90 - 3 * k) for k in range(8)]), CLICK)


def test_an_object_lost_before_it_moved_is_told(tmp_path):
    pictures = [frame(200 - k) for k in range(4)] + [frame(-500)] * 4
    with pytest.raises(ItemError, match="lost in frame 4 and not found again") as caught:
        find_pair(folder(tmp_path, pictures), CLICK)
    assert caught.value.reason == "lost"


def test_most_of_the_motion_is_better_than_none(tmp_path):
    found = find_pair(folder(tmp_path, sideways(6)), CLICK)
    assert 0.1 < found.pair.shift < 0.2


def test_a_click_on_the_background_is_told(tmp_path):
    picture = np.where(frame()[..., :1] > 1.2 * frame()[..., 2:], COLOR, 120).astype(np.uint8)
    with pytest.raises(ImageError, match="on the background"):
        find_pair(folder(tmp_path, [picture] * 3), Click(column=20, row=20))


def test_one_click_gives_the_light_in_the_cameras_frame(frames):
    model = KnowingModel()
    pair = find_pair(frames, CLICK).pair
    model.turns = [pair.video_from_view]
    result = light_from_video(frames, [CLICK], model=model)
    assert angle_between(light_vector(result.estimate.radiance), model.direction) < 0.05
    # In the frame of its own view it is elsewhere.
    own = light_vector(result.each[0].radiance)
    assert np.rad2deg(angle_between(own, model.direction)) > 3
    assert result.estimate.level_from_camera == Rotation.identity()


def test_several_objects_are_fused_in_one_frame_by_how_sure_they_are(tmp_path):
    def two(k):
        picture = frame(230 - 2 * k)
        other = frame(80 - 2 * k, 60, 24)
        red = other[..., 0] > 1.6 * other[..., 2]
        green = other[..., [1, 0, 2]]
        return np.where(red[..., None], green, picture).astype(np.uint8)

    frames = folder(tmp_path, [two(k) for k in range(14)])
    clicks = [Click(column=230, row=90), Click(column=80, row=60)]
    pairs = [find_pair(frames, click).pair for click in clicks]
    turns = [pair.video_from_view for pair in pairs]
    assert np.rad2deg((turns[0].inverse @ turns[1]).angle) > 15
    model = KnowingModel()
    model.turns = turns
    result = light_from_video(frames, clicks, model=model)
    assert len(result.each) == 2
    assert angle_between(light_vector(result.estimate.radiance), model.direction) < 0.06
    # One that is unsure and wrong counts little.
    wrong = estimate_of(beacon(turns[1].inverse.apply(np.array([-1.0, 0.5, -0.5]))), error=3.0)

    class Mixed(KnowingModel):
        def estimate(self, views):
            right = super().estimate(views)
            return wrong if len(self.seen) == 2 else right

    mixed = Mixed(errors=(0.05,))
    mixed.turns = turns
    _, fused = read_light(pairs, mixed)
    assert np.rad2deg(angle_between(light_vector(fused.radiance), model.direction)) < 25


def test_the_level_of_the_camera_reaches_the_map(frames):
    settings = SessionSettings(snapshot=SnapshotSettings(pitch_deg=15, roll_deg=3))
    found = light_from_video(frames, [CLICK], settings, model=KnowingModel()).estimate
    _, pitch, roll = np.rad2deg(found.level_from_camera.heading_pitch_roll())
    assert (pitch, roll) == (pytest.approx(15), pytest.approx(3))


def test_warnings_of_all_steps_come_together(tmp_path):
    pictures = [frame(200 - 2 * k, 90 + 1.2 * k) for k in range(12)]
    pictures[3] = frame(-500)
    result = light_from_video(folder(tmp_path, pictures), [CLICK], model=KnowingModel())
    text = " ".join(result.estimate.warnings)
    assert "lost in frame 3" in text
    assert "moved up or down" in text


def test_no_click_is_refused(frames):
    with pytest.raises(UsageError, match="There is no click"):
        light_from_video(frames, [], model=KnowingModel())


def test_everything_is_written(frames, tmp_path):
    result = light_from_video(frames, [CLICK], model=KnowingModel())
    record = write_session(result, tmp_path, OutputSettings(exports=()))
    radiance, estimate = read_outputs(tmp_path)
    np.testing.assert_allclose(radiance, result.estimate.radiance)
    assert estimate["model"] == "knowing"
    assert json.loads((tmp_path / "session.json").read_text()) == record
    (one,) = record["objects"]
    assert one["frames"]["left"] == 0
    assert one["track"][0]["box"][2] == pytest.approx(64, abs=2)
    assert one["losses"] == []
    for name in ("left", "right", "left_object", "right_object", "background"):
        assert (tmp_path / "views" / f"1_{name}.png").stat().st_size > 100
