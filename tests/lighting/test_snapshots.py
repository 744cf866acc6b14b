"""Two frames become the views that a network knows: one crop, disparity kept."""

import cv2
import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.frames import Rotation
from panokit.lighting import (
    Snapshot,
    select_object,
    selection_from_mask,
    stereo_pair,
    view_warnings,
)
from panokit.lighting.background import behind_object
from panokit.lighting.settings import SnapshotSettings
from panokit.lighting.snapshots import turned_share
from tests.lighting.clips import RADIUS, frame


def snapshot(x, number=0, y=90.0, radius=RADIUS, **more):
    picture = frame(x, y, radius, **more)
    return Snapshot(number=number, picture=picture, selection=select_object(picture, (x, y)))


def middle_of(picture):
    rows, columns = np.nonzero(picture.any(axis=-1))
    return columns.mean() + 0.5, rows.mean() + 0.5


def width_of(picture):
    return np.ptp(np.flatnonzero(picture.any(axis=(0, 2)))) + 1


@pytest.fixture(scope="module")
def pair():
    return stereo_pair(snapshot(168, 3), snapshot(155, 9, slide=-1.3))


def test_the_view_with_the_object_on_the_right_is_the_left_one(pair):
    assert (pair.left.number, pair.right.number) == (3, 9)
    again = stereo_pair(pair.right, pair.left)
    assert (again.left.number, again.right.number) == (3, 9)
    np.testing.assert_array_equal(again.views.left, pair.views.left)


def test_the_disparity_is_that_of_the_dataset(pair):
    """A fifth of the object's size between the places, symmetric about the middle."""
    views = pair.views
    left, right = middle_of(views.left_object), middle_of(views.right_object)
    extent = width_of(views.left_object)
    assert pair.shift == pytest.approx(13 / (2 * RADIUS), abs=0.02)
    assert (left[0] - right[0]) / extent == pytest.approx(pair.shift, abs=0.03)
    assert (left[0] + right[0]) / 2 == pytest.approx(64, abs=1)
    assert left[1] == pytest.approx(right[1], abs=0.6)
    assert views.baseline_m == pair.shift


def test_the_object_fills_its_share(pair):
    assert width_of(pair.views.left_object) / 128 == pytest.approx(0.65, abs=0.03)
    small = stereo_pair(pair.left, pair.right, SnapshotSettings(fill=0.5, size_px=64)).views
    assert small.mask.shape == (64, 64)
    assert width_of(small.left_object) / 64 == pytest.approx(0.5, abs=0.04)


def test_an_object_that_moved_far_is_still_whole_in_both():
    far = stereo_pair(snapshot(190), snapshot(130))
    assert view_warnings(far.views) == ()
    assert any("94%" in text or "sideways by 9" in text for text in far.warnings)


def test_good_views_give_no_warnings(pair):
    assert pair.warnings == ()
    assert view_warnings(pair.views) == ()


def test_the_object_lies_on_black_and_the_background_has_no_hole(pair):
    views = pair.views
    assert not views.left_object[:10].any()
    middle = views.background[64, 64].astype(int)
    assert middle[2] > middle[0]  # the blue-gray wall, not the red ball
    inside = cv2.erode(views.mask.astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    assert inside.sum() > 3000
    np.testing.assert_array_equal(views.left[inside], views.left_object[inside])


def test_the_frame_of_the_view_is_turned_toward_the_object():
    high = stereo_pair(snapshot(250, y=50), snapshot(237, y=50))
    heading, pitch, roll = np.rad2deg(high.video_from_view.heading_pitch_roll())
    focal = 160 / np.tan(np.deg2rad(30))
    assert heading == pytest.approx(np.rad2deg(np.arctan((243.5 - 160) / focal)), abs=0.4)
    assert pitch > 6
    assert roll == pytest.approx(0, abs=1e-6)
    # The middle of the crop looks there.
    forward = high.video_from_view.apply(np.array([0.0, 0, -1]))
    assert forward[0] / -forward[2] * focal == pytest.approx(83.5, abs=2)
    assert middle_of(high.views.left_object)[1] == pytest.approx(64, abs=2)


def test_pitch_of_the_camera_reaches_the_views():
    settings = SnapshotSettings(pitch_deg=-20)
    views = stereo_pair(snapshot(168), snapshot(155), settings).views
    _, pitch, _ = views.left_level.heading_pitch_roll()
    assert np.rad2deg(pitch) == pytest.approx(-20, abs=0.7)
    level = stereo_pair(snapshot(168), snapshot(155)).views.left_level
    assert Rotation(level.matrix).angle < np.deg2rad(0.7)


def test_a_4k_frame_gives_the_same_views(pair):
    def large(one):
        picture = np.repeat(np.repeat(one.picture, 6, axis=0), 6, axis=1)
        mask = np.repeat(np.repeat(one.selection.mask, 6, axis=0), 6, axis=1)
        return Snapshot(number=one.number, picture=picture, selection=selection_from_mask(mask))

    views = stereo_pair(large(pair.left), large(pair.right)).views
    off = np.abs(views.left_object.astype(int) - pair.views.left_object)
    assert off.mean() < 3
    assert pair.views.fov_deg == pytest.approx(views.fov_deg, rel=0.02)


@pytest.mark.parametrize(
    ("second", "said"),
    [
        ({"x": 155, "y": 104}, "moved up or down by 22%"),
        ({"x": 155, "radius": 40}, "changed its size by 2"),
        ({"x": 166}, "moved sideways by 3%"),
    ],
)
def test_what_breaks_the_assumptions_is_told(second, said):
    found = stereo_pair(snapshot(168), snapshot(**second))
    assert any(said in text for text in found.warnings), found.warnings


def test_an_object_at_the_frames_edge_is_told():
    found = stereo_pair(snapshot(30), snapshot(17))
    assert any("touches the frame's edge" in text for text in found.warnings)


def test_a_burnt_out_object_is_told():
    def burnt(x):
        picture = frame(x)
        mask = select_object(picture, (x, 90)).mask
        picture = np.where(mask[..., None], 255, picture).astype(np.uint8)
        return Snapshot(number=x, picture=picture, selection=selection_from_mask(mask))

    views = stereo_pair(burnt(168), burnt(155)).views
    assert any("burnt out" in text for text in view_warnings(views))


def test_a_camera_that_turns_is_told_from_one_that_moves(pair):
    assert abs(turned_share(pair.left, pair.right)) < 0.3
    turned = stereo_pair(snapshot(168, slide=0), snapshot(148, slide=-20))
    assert turned_share(turned.left, turned.right) == pytest.approx(1, abs=0.15)
    assert any("the camera turned" in text for text in turned.warnings)


def test_frames_of_two_sizes_and_empty_masks_are_refused(pair):
    other = snapshot(168)
    cut = Snapshot(
        number=1, picture=other.picture[:100].copy(),
        selection=selection_from_mask(other.selection.mask[:100]),
    )  # fmt: skip
    with pytest.raises(UsageError, match="differ in size"):
        stereo_pair(pair.left, cut)
    wrong = Snapshot(number=2, picture=other.picture, selection=cut.selection)
    with pytest.raises(ImageError, match="no object in frame 2"):
        stereo_pair(pair.left, wrong)


def test_behind_an_object_the_background_goes_on():
    linear = np.zeros((64, 64, 3), np.float32)
    linear[:32], linear[32:] = 0.8, 0.2
    known = np.ones((64, 64), bool)
    known[20:44, 20:44] = False
    linear[~known] = 50
    found = behind_object(linear, known, 1 / 16)
    assert found.max() < 0.85
    assert found[24, 32].mean() > 0.6 > 0.4 > found[40, 32].mean()
    sharp = behind_object(linear, known, 0)
    np.testing.assert_array_equal(sharp[known], linear[known])
    assert behind_object(linear, np.zeros((64, 64), bool), 1 / 16).max() == 0


def test_the_background_is_as_blurred_as_asked():
    rng = np.random.default_rng(1)
    linear = rng.random((128, 128, 3)).astype(np.float32)
    known = np.ones((128, 128), bool)
    spread = [behind_object(linear, known, blur).std() for blur in (0, 0.02, 0.0375, 0.1)]
    assert spread == sorted(spread, reverse=True)
    assert behind_object(linear, known, 0.0375).mean() == pytest.approx(0.5, abs=0.01)
