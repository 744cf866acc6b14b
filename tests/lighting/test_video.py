"""Frames come when asked for, one at a time, and what is no video says so."""

import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.lighting import open_frames
from panokit.lighting.video import smaller
from tests.lighting.clips import SIZE, frame, sideways, write_folder, write_video


@pytest.fixture(scope="module")
def clip():
    return sideways(60)


@pytest.fixture(scope="module")
def video(clip, tmp_path_factory):
    return write_video(tmp_path_factory.mktemp("video") / "ball.mp4", clip)


def close_to(one, other):
    return np.abs(one.astype(int) - other).mean() < 6


def test_frames_of_a_video_are_what_was_written(video, clip):
    frames = open_frames(video)
    assert (frames.count, frames.size_px, frames.fps) == (60, SIZE, 25)
    for number in (0, 5, 3, 59, 58, 4):  # on, back, far and near
        assert close_to(frames.frame(number), clip[number])
    assert not close_to(frames.frame(0), clip[20])


def test_frames_can_be_read_on_from_anywhere(video, clip):
    seen = list(open_frames(video).frames_from(40))
    assert [number for number, _ in seen] == list(range(40, 60))
    assert all(close_to(picture, clip[number]) for number, picture in seen)


def test_two_readers_of_one_video_do_not_disturb_each_other(video, clip):
    frames = open_frames(video)
    one, other = frames.frames_from(0), frames.frames_from(30)
    for _ in range(5):
        number, picture = next(one)
        assert close_to(picture, clip[number])
        number, picture = next(other)
        assert close_to(picture, clip[number])


def test_a_folder_of_pictures_is_read_by_their_numbers(tmp_path, clip):
    frames = open_frames(write_folder(tmp_path / "frames", clip[:12]))
    assert (frames.count, frames.size_px) == (12, SIZE)
    np.testing.assert_array_equal(frames.frame(2), clip[2])
    np.testing.assert_array_equal(frames.frame(10), clip[10])
    assert [number for number, _ in frames.frames_from(10)] == [10, 11]


@pytest.mark.parametrize("number", [-1, 60, 4000])
def test_a_frame_that_is_not_there_is_refused(video, number):
    with pytest.raises(UsageError, match=r"no (frame )?-?\d+|60 frames"):
        open_frames(video).frame(number)


def test_a_missing_file_and_an_empty_folder_are_told(tmp_path):
    with pytest.raises(UsageError, match="There is no video"):
        open_frames(tmp_path / "none.mp4")
    with pytest.raises(ImageError, match="holds no pictures"):
        open_frames(tmp_path)


def test_what_is_no_video_is_told_with_how_it_begins(tmp_path):
    path = tmp_path / "notes.mp4"
    path.write_bytes(b"Dear diary, this is no video at all.")
    with pytest.raises(ImageError, match=r"begins with 44 65.*H\.264") as caught:
        open_frames(path)
    assert caught.value.reason == "not-a-video"
    path.write_bytes(b"")
    with pytest.raises(ImageError, match="it is empty"):
        open_frames(path)


def test_a_video_of_which_no_frame_can_be_read_names_its_codec(video, tmp_path):
    data = video.read_bytes()
    assert data.count(b"mp4v") == 1
    path = tmp_path / "modern.mp4"
    # A codec that this decoder does not know, in a container that it does.
    path.write_bytes(data.replace(b"mp4v", b"av01").replace(b"esds", b"xxxx"))
    with pytest.raises(
        ImageError, match=r"codec is AV1.*ffmpeg -i modern\.mp4 -c:v libx264"
    ) as caught:
        open_frames(path)
    assert caught.value.reason == "no-frames"


def test_a_video_that_ends_early_ends(video, tmp_path):
    path = write_video(tmp_path / "cut.avi", sideways(30), codec="MJPG")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    seen = [number for number, _ in open_frames(path).frames_from(0)]
    assert seen == list(range(len(seen)))
    assert 5 < len(seen) < 30


def test_pictures_of_two_sizes_are_no_video(tmp_path):
    folder = write_folder(tmp_path / "frames", [frame(), frame()[:100]])
    with pytest.raises(ImageError, match="Give frames of one camera"):
        open_frames(folder).frame(1)


def test_one_frame_of_a_large_video_is_in_memory_at_a_time(tmp_path, monkeypatch):
    """An hour of 4K takes no more than a minute of it."""
    import gc
    import weakref

    path = write_video(tmp_path / "long.mp4", sideways(40))
    alive, most = [], 0
    for _, picture in open_frames(path).frames_from(0):
        alive = [ref for ref in alive if ref() is not None] + [weakref.ref(picture)]
        most = max(most, len(alive))
        del picture
    gc.collect()
    assert most <= 2


def test_smaller_pictures_are_not_enlarged():
    picture = frame()
    same, scale = smaller(picture, 1000)
    assert same is picture
    assert scale == 1
    half, scale = smaller(picture, 160)
    assert half.shape == (90, 160, 3)
    assert scale == 0.5
