"""Pictures from this disk."""

import numpy as np
import pytest

from panokit.capture import local_capture
from panokit.errors import SettingsError, StorageError
from panokit.fetch import FetchSettings, fetch
from panokit.frames import Frame
from panokit.io import encode_jpeg, encode_png, read_capture, write_panorama
from panokit.io.gpano import gpano_xmp
from panokit.panorama import Panorama

PIXELS = np.full((32, 64, 3), 90, np.uint8)


def taken(folder, out, **settings):
    return fetch(FetchSettings(source="folder", folder=folder, **settings), out)


def with_pose(pixels: np.ndarray) -> bytes:
    capture = local_capture("x", heading_deg=120.0, pitch_deg=2.0, roll_deg=-1.0)
    xmp = gpano_xmp(64, 32, capture, heading_deg=120.0, leveled=False)
    return encode_jpeg(pixels, xmp=xmp)


def test_every_picture_is_taken_with_its_tags_and_its_bytes(tmp_path):
    folder = tmp_path / "in"
    (folder / "deeper").mkdir(parents=True)
    (folder / "a.jpg").write_bytes(with_pose(PIXELS))
    (folder / "deeper" / "b.png").write_bytes(encode_png(PIXELS))
    (folder / "notes.txt").write_text("no picture")
    result = taken(folder, tmp_path / "run", count=1)
    assert [one.capture.key for one in result.stored] == ["folder-a", "folder-deeper_b"]
    first, second = (read_capture(one.folder) for one in result.stored)
    assert (first.capture.heading_deg, first.capture.pitch_deg) == (120.0, 2.0)
    assert first.read("image.jpg") == (folder / "a.jpg").read_bytes()
    assert second.read("image.png") == (folder / "deeper" / "b.png").read_bytes()
    assert first.capture.license.id == "unknown"
    assert result.requests == 0


def test_the_user_may_state_the_license(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.jpg").write_bytes(encode_jpeg(PIXELS))
    result = taken(tmp_path / "in", tmp_path / "run", license="CC-BY-4.0", attribution="Ada")
    terms = result.stored[0].capture.license
    assert (terms.id, terms.attribution, terms.train) == ("CC-BY-4.0", "Ada", True)


def test_bad_pictures_are_rejected_and_the_others_go_on(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "broken.jpg").write_bytes(with_pose(PIXELS)[:-40])
    (folder / "good.jpg").write_bytes(encode_jpeg(PIXELS))
    (folder / "good.png").write_bytes(encode_png(PIXELS))
    (folder / "square.png").write_bytes(encode_png(PIXELS[:, :32]))
    result = taken(folder, tmp_path / "run")
    assert [one.capture.id for one in result.stored] == ["good"]
    assert {(one.item, one.reason) for one in result.rejections} == {
        ("folder-broken", "truncated"),
        ("folder-good", "duplicate-name"),
        ("folder-square", "not-equirectangular"),
    }


def test_a_second_run_takes_only_what_is_new(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "a.jpg").write_bytes(encode_jpeg(PIXELS))
    taken(folder, tmp_path / "run")
    (folder / "b.jpg").write_bytes(encode_jpeg(PIXELS))
    result = taken(folder, tmp_path / "run")
    assert [one.capture.id for one in result.stored] == ["b"]
    assert [one.capture.id for one in result.existing] == ["a"]


def test_a_panorama_that_panokit_leveled_is_level(tmp_path):
    capture = local_capture("x", heading_deg=120.0, pitch_deg=2.0, roll_deg=-1.0)
    (tmp_path / "in").mkdir()
    leveled = Panorama(pixels=PIXELS, capture=capture, frame=Frame.WORLD)
    write_panorama(leveled, tmp_path / "in" / "x.jpg")
    stored = taken(tmp_path / "in", tmp_path / "run").stored[0].capture
    assert (stored.heading_deg, stored.pitch_deg, stored.roll_deg) == (0.0, 0.0, 0.0)


def test_no_folder(tmp_path):
    with pytest.raises(SettingsError, match="folder"):
        fetch(FetchSettings(source="folder"), tmp_path)
    with pytest.raises(StorageError, match="not a folder"):
        taken(tmp_path / "nowhere", tmp_path)
