"""Lighting from video without a browser: click, correct, follow, confirm, read, write."""

import cv2
import numpy as np
import pytest

from panokit.app.light_result import FORMS, files_of
from panokit.app.reading import (
    Reading,
    StoppedError,
    Stroke,
    chosen_model,
    light_page,
    overlay,
    write_results,
)
from panokit.errors import ImageError, ItemError, PanokitError, UsageError
from panokit.io import read_exr
from panokit.lighting import LightEstimate
from panokit.lighting.settings import SessionSettings
from tests.lighting.clips import RADIUS, frame, sideways, write_folder, write_video
from tests.lighting.fakes import beacon, estimate_of

CENTER = (200, 90)


class FakeModel:
    """Says the same of all views, and remembers what it saw."""

    def __init__(self):
        self.seen = []

    def estimate(self, views) -> LightEstimate:
        self.seen.append(views)
        return estimate_of(beacon((0.5, 0.7, -0.5)), model="fake")


@pytest.fixture(scope="module")
def video(tmp_path_factory):
    return write_video(tmp_path_factory.mktemp("video") / "ball.mp4", sideways())


@pytest.fixture
def reading(video):
    return Reading(video, SessionSettings())


def near(mask, radius=RADIUS):
    """How well a mask is the ball, as intersection over union."""
    rows, columns = np.mgrid[: mask.shape[0], : mask.shape[1]] + 0.5
    ball = np.hypot(columns - CENTER[0], rows - CENTER[1]) < radius
    return (mask & ball).sum() / (mask | ball).sum()


def test_one_click_selects_the_object(reading):
    selection = reading.click(0, CENTER)
    assert not selection.problem
    assert near(selection.mask) > 0.85
    assert reading.tolerance == selection.tolerance > 0


def test_the_tolerance_changes_what_the_same_click_selects(reading):
    reading.click(0, CENTER)
    sizes = [int(reading.tolerate(t).mask.sum()) for t in (3.0, 12.0, 90.0)]
    assert sizes[0] < sizes[1] < sizes[2]
    assert reading.first.selection.problem
    with pytest.raises(UsageError):
        reading.follow(lambda one: None)


def test_strokes_add_to_the_mask_and_remove_from_it(reading):
    before = reading.click(0, CENTER).mask.copy()
    added = reading.edit(Stroke(points=((20, 20), (60, 20)), radius_px=4, adds=True)).mask
    assert added[20, 40]
    assert added[24, 40]
    assert not added[30, 40]
    assert (added & before).sum() == before.sum()
    removed = reading.edit(Stroke(points=((10, 20), (70, 20)), radius_px=9, adds=False)).mask
    assert np.array_equal(removed, before)


def test_a_mask_that_is_rubbed_out_is_told(reading):
    reading.click(0, CENTER)
    gone = reading.edit(Stroke(points=((200, 90),), radius_px=100, adds=False))
    assert "Nothing is selected" in gone.problem


def test_following_finds_a_second_view_and_tells_of_each_frame(reading):
    reading.click(0, CENTER)
    seen = []
    found = reading.follow(seen.append)
    assert [one.number for one in seen] == list(range(seen[-1].number + 1))
    assert seen[-1].number - 1 <= found.pair.right.number <= seen[-1].number
    assert found.pair.shift == pytest.approx(0.2, abs=0.06)


def test_following_can_be_stopped(reading):
    reading.click(0, CENTER)
    with pytest.raises(StoppedError):
        reading.follow(lambda one: reading.stop.set())


def test_an_object_that_never_moves_sideways_is_told(tmp_path):
    still = Reading(write_folder(tmp_path / "still", [frame(200)] * 6), SessionSettings())
    still.click(0, CENTER)
    with pytest.raises(ItemError, match="sideways"):
        still.follow(lambda one: None)


def test_a_click_on_the_background_is_told_and_not_followed(reading):
    selection = reading.click(0, (20, 160))
    assert selection.problem
    with pytest.raises(UsageError, match=r"."):
        reading.follow(lambda one: None)


def test_corrected_views_are_what_is_read(reading):
    reading.click(0, CENTER)
    reading.follow(lambda one: None)
    box = reading.found.pair.right.selection.box
    before = reading.found.pair.right.selection.mask.sum()
    middle = (box.x + box.width / 2, box.y + box.height)
    reading.edit_view("right", Stroke(points=(middle,), radius_px=10, adds=False))
    assert reading.found.pair.right.selection.mask.sum() < before
    model = FakeModel()
    reading.read(model)
    assert model.seen[0].right_object.any()
    assert np.array_equal(model.seen[0].mask, reading.found.pair.views.mask)


def test_several_objects_are_fused(reading):
    model = FakeModel()
    for _ in range(2):
        reading.click(0, CENTER)
        reading.follow(lambda one: None)
        result = reading.read(model)
        reading.keep_and_go_on()
    assert len(result.found) == 2
    assert len(model.seen) == 3
    assert reading.first is None
    assert reading.found is None


def test_frames_are_pictures_for_the_browser(reading):
    data = np.frombuffer(reading.jpeg("3"), np.uint8)
    assert cv2.imdecode(data, cv2.IMREAD_COLOR).shape == (180, 320, 3)
    for wrong in ("99", "-1"):
        with pytest.raises(UsageError):
            reading.jpeg(wrong)
    with pytest.raises(ValueError, match="invalid literal"):
        reading.jpeg("../0")


def test_the_overlay_is_clear_but_for_the_mask():
    mask = np.zeros((40, 80), bool)
    mask[10:30, 20:60] = True
    data = np.frombuffer(overlay(mask), np.uint8)
    picture = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
    assert picture.shape == (40, 80, 4)
    assert picture[20, 40, 3] > 60
    assert picture[2, 2, 3] == 0


def test_every_download_has_its_files(reading, tmp_path):
    reading.click(0, CENTER)
    reading.follow(lambda one: None)
    result = reading.read(FakeModel())
    record = write_results(result, tmp_path, 256)
    for form in FORMS:
        files = files_of(form, record, tmp_path)
        assert files, form
        assert all(path.is_file() for path in files), form
    radiance, _ = read_exr(tmp_path / "light.exr")
    assert radiance.shape == (128, 256, 3)
    assert np.isfinite(radiance).all()
    assert b"u_world_from_view" in light_page(result.estimate)


def test_the_frame_with_balls_differs_from_the_frame(reading):
    reading.click(0, CENTER)
    reading.follow(lambda one: None)
    before, after = (
        cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).astype(int)
        for data in reading.shown(reading.read(FakeModel()))
    )
    away = np.abs(before - after).max(axis=-1)
    assert away.max() > 40
    assert np.median(away) < 12


def test_no_video_is_told(tmp_path):
    (tmp_path / "no.mp4").write_bytes(b"this is no video")
    with pytest.raises(ImageError, match=r"no\.mp4"):
        Reading(tmp_path / "no.mp4", SessionSettings())


def test_the_model_is_the_one_asked_for_or_one_that_is_there(monkeypatch):
    monkeypatch.setattr("panokit.app.reading.lighting_models", lambda: [])
    assert chosen_model("mine") == "mine"
    with pytest.raises(PanokitError, match="--lighting-model"):
        chosen_model(None)
    monkeypatch.setattr("panokit.app.reading.lighting_models", lambda: ["a", "b"])
    assert chosen_model(None) == "b"
    usual = SessionSettings().model
    monkeypatch.setattr("panokit.app.reading.lighting_models", lambda: [usual, "z"])
    assert chosen_model(None) == usual
