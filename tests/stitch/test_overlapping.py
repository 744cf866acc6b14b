import json
import os
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from panokit import EnvironmentMap
from panokit.capture import local_capture
from panokit.cli.main import main
from panokit.color import srgb_encode
from panokit.errors import ImageError, RecordError
from panokit.frames import Frame
from panokit.io import encode_png, read_environment_map, read_panorama, write_exr
from panokit.io.captures import StoredCapture, write_capture
from panokit.io.files import sha256_of_bytes
from panokit.panorama import Panorama
from panokit.stitch import StitchSettings, read_view_set, stitch, stitch_view_set

POSE = ("heading_deg", "pitch_deg", "fov_deg")


def write_set(folder, pictures, views=None, **fields):
    """Pictures and the file that speaks of them."""
    entries = []
    for number, picture in enumerate(pictures):
        name = f"{number:02}.png"
        (folder / name).write_bytes(encode_png(picture))
        pose = {} if views is None else {key: getattr(views[number], key) for key in POSE}
        entries.append({"name": name, **pose})
    record = {"schema": "panokit.views/1", "views": entries, **fields}
    path = folder / "square.json"
    path.write_text(json.dumps(record))
    return path


def test_views_with_poses_become_a_panorama(tmp_path, sphere_views):
    views = sphere_views.ring()
    scene = sphere_views.scene(512)
    path = write_set(tmp_path, sphere_views.shoot(scene, views), views, license="CC-BY-4.0",
                     attribution="A. Person")  # fmt: skip
    made = stitch_view_set(read_view_set(path), StitchSettings(width_px=512))
    assert isinstance(made, Panorama)
    assert made.frame is Frame.WORLD
    assert made.capture.license.attribution == "A. Person"
    assert made.capture.id == "square"
    reference = cv2.resize(scene, (made.width_px, made.height_px), interpolation=cv2.INTER_AREA)
    assert sphere_views.psnr(made.pixels, reference) > 30
    assert made.provenance.steps[-1].values["views"] == 22


def test_fetched_views_are_stitched_like_tiles(tmp_path, sphere_views):
    views = [replace(v, name=f"views/{v.name}") for v in sphere_views.ring()]
    pictures = sphere_views.shoot(sphere_views.scene(512), views)
    files = {}
    (tmp_path / "views").mkdir()
    for view, picture in zip(views, pictures, strict=True):
        (tmp_path / view.name).write_bytes(encode_png(picture))
        files[view.name] = sha256_of_bytes(encode_png(picture))
    capture = local_capture("street")
    stored = StoredCapture(folder=tmp_path, capture=capture, views=tuple(views), files=files)
    write_capture(stored)
    made = stitch(stored)
    assert made.frame is Frame.WORLD
    assert made.width_px == 320
    assert made.valid is None
    assert made.provenance.steps[-1].values["coverage"] == 1


def test_the_command_writes_a_panorama_and_its_mask(tmp_path, sphere_views, capsys):
    views = sphere_views.ring()[:8]
    path = write_set(tmp_path, sphere_views.shoot(sphere_views.scene(512), views), views)
    assert main(["stitch", str(path), "--out", str(tmp_path / "out")]) == 0
    panorama = read_panorama(tmp_path / "out" / "square.jpg")
    assert panorama.valid is not None
    assert not panorama.valid[0].any()
    # A picture that changes is stitched anew, though the file of views is the same.
    before = (tmp_path / "out" / "square.json").read_text()
    (tmp_path / "00.png").write_bytes(encode_png(np.full((120, 120, 3), 90, np.uint8)))
    main(["stitch", str(path), "--out", str(tmp_path / "out")])
    assert (tmp_path / "out" / "square.json").read_text() != before
    capsys.readouterr()


def test_photos_without_poses_find_their_places(tmp_path, sphere_views):
    views = [
        replace(v, fov_deg=60.0, width_px=320, height_px=240, heading_deg=25.0 * i - 50)
        for i, v in enumerate(sphere_views.ring()[:5])
    ]
    pictures = sphere_views.shoot(sphere_views.scene(2048), views)
    path = write_set(tmp_path, [*pictures, np.full((240, 320, 3), 140, np.uint8)])
    made = stitch_view_set(read_view_set(path))
    assert isinstance(made, Panorama)
    assert made.frame is Frame.CAMERA
    values = made.provenance.steps[-1].values
    assert values["left_out"] == ["05.png"]
    found = [pose["heading_deg"] for pose in values["poses"]]
    assert np.diff(found) == pytest.approx([25] * 4, abs=0.7)
    assert [pose["fov_deg"] for pose in values["poses"]] == pytest.approx([60] * 5, abs=1.5)
    assert made.valid is not None
    assert not made.pixels[~made.valid].any()
    assert 0.05 < made.valid.mean() < 0.4


@pytest.mark.parametrize("count", [1, 2])
def test_photos_that_do_not_match_are_told(tmp_path, sphere_views, count):
    views = [replace(v, fov_deg=40.0) for v in sphere_views.ring()[: 3 * count : 3]]
    pictures = sphere_views.shoot(sphere_views.scene(1024), views)
    with pytest.raises(ImageError, match="match") as caught:
        stitch_view_set(read_view_set(write_set(tmp_path, pictures)))
    assert caught.value.reason == ("one-view" if count == 1 else "too-few-matches")


def test_exposures_of_a_panorama_become_a_map(tmp_path, capsys):
    rng = np.random.default_rng(0)
    coarse = rng.uniform(-4, 2, (8, 16, 3)).astype(np.float32)
    scene = np.exp(cv2.resize(coarse, (128, 64), interpolation=cv2.INTER_CUBIC))
    shots = []
    for number, seconds in enumerate([0.01, 0.1, 1.0]):
        encoded = srgb_encode((scene * seconds).astype(np.float32))
        name = f"e{number}.png"
        (tmp_path / name).write_bytes(encode_png(np.rint(encoded * 255).astype(np.uint8)))
        shots.append({"name": name, "exposure_s": seconds})
    path = tmp_path / "room.json"
    path.write_text(json.dumps({"schema": "panokit.views/1", "exposures": shots}))
    assert main(["stitch", str(path), "--out", str(tmp_path / "out")]) == 0
    made = read_environment_map(tmp_path / "out" / "room.exr")
    reference = made.provenance.steps[-1].values["brackets"][0]["reference_exposure"]
    ratio = made.radiance / reference / scene
    assert np.median(ratio) == pytest.approx(1, abs=0.05)
    capsys.readouterr()


def test_bracketed_views_share_one_scale(tmp_path, sphere_views):
    views = sphere_views.ring(64)
    scene = (sphere_views.scene(256).astype(np.float32) / 255) ** 2.2
    scene[:, :128] *= 20
    entries = []
    for number, picture in enumerate(sphere_views.shoot(scene, views)):
        shots = []
        for stop, seconds in enumerate([0.02, 0.2, 1.0]):
            code = srgb_encode((picture * seconds).astype(np.float32))
            name = f"{number}_{stop}.png"
            data = encode_png(np.rint(code * 255).astype(np.uint8))
            (tmp_path / name).write_bytes(data)
            shots.append({"name": name, "exposure_s": seconds})
        pose = {key: getattr(views[number], key) for key in POSE}
        entries.append({"exposures": shots, **pose})
    path = tmp_path / "hall.json"
    path.write_text(json.dumps({"schema": "panokit.views/1", "views": entries}))
    settings = StitchSettings(exposure=False, refine="none")
    made = stitch_view_set(read_view_set(path), settings)
    assert isinstance(made, EnvironmentMap)
    values = made.provenance.steps[-1].values["brackets"]
    small = cv2.resize(scene, (made.width_px, made.height_px), interpolation=cv2.INTER_AREA)
    ratio = made.radiance / values[0]["reference_exposure"] / small
    assert len({v["reference_exposure"] for v in values}) > 1
    middle = made.width_px // 4
    assert np.median(ratio[:, middle - 20 : middle + 20]) == pytest.approx(1, abs=0.05)
    assert np.median(ratio[:, -middle - 20 : -middle + 20]) == pytest.approx(1, abs=0.05)


def test_hdr_views_with_holes_are_no_map(tmp_path, sphere_views):
    views = sphere_views.ring(32)[:2]
    entries = []
    for view in views:
        write_exr(tmp_path / f"{view.name}.exr", np.full((32, 32, 3), 0.5, np.float32))
        pose = {key: getattr(view, key) for key in POSE}
        entries.append({"name": f"{view.name}.exr", **pose})
    path = tmp_path / "sky.json"
    path.write_text(json.dumps({"schema": "panokit.views/1", "views": entries}))
    with pytest.raises(ImageError, match="no holes") as caught:
        stitch_view_set(read_view_set(path))
    assert caught.value.reason == "not-covered"


@pytest.mark.parametrize(
    ("record", "told"),
    [
        ({"schema": "other"}, "not a file of views"),
        ({"views": []}, "no views"),
        ({"views": [{}]}, 'not exactly one of "name"'),
        ({"views": [{"name": "a.png", "heading": 3}]}, "unknown fields: heading"),
        ({"views": [{"name": "a.png", "heading_deg": 3}]}, "without pitch_deg, fov_deg"),
        (
            {"views": [{"name": "a.png", "heading_deg": 0, "pitch_deg": 0, "fov_deg": 180}]},
            "field of view of 180",
        ),
        (
            {
                "views": [
                    {"name": "a.png"},
                    {"name": "b.png", "heading_deg": 0, "pitch_deg": 0, "fov_deg": 60},
                ]
            },
            "some of its views",
        ),
        ({"exposures": [{"name": "a.png"}]}, "cannot be read"),
        ({"views": [{"name": "a.png"}], "curve": "log"}, "the curve 'log'"),
        ({"views": [{"name": "a.png"}], "exposures": []}, "not exactly one"),
    ],
)
def test_what_is_wrong_in_a_file_of_views_is_named(tmp_path, record, told):
    path = tmp_path / "views.json"
    path.write_text(json.dumps({"schema": "panokit.views/1", **record}))
    with pytest.raises(RecordError, match=told):
        read_view_set(path)


@pytest.mark.data
def test_photographs_of_an_arch(tmp_path):
    folder = os.environ.get("PANOKIT_DATA")
    if not folder:
        pytest.skip("PANOKIT_DATA is not set")
    names = sorted((Path(folder) / "overlap" / "arches_a").glob("*.jpg"))
    for name in names:
        shutil.copy(name, tmp_path / name.name)
    path = tmp_path / "arch.json"
    entries = [{"name": name.name} for name in names]
    path.write_text(json.dumps({"schema": "panokit.views/1", "views": entries}))
    made = stitch_view_set(read_view_set(path))
    values = made.provenance.steps[-1].values
    assert values["left_out"] == []
    assert values["agreement"] > 0.95
    assert 0.08 < values["coverage"] < 0.13
