import io
import json
from datetime import UTC, datetime

import numpy as np
import OpenEXR
import pytest
from PIL import Image

from panokit.capture import TimePrecision
from panokit.envmap import Anchor
from panokit.errors import ImageError, RecordError, UsageError
from panokit.frames import Frame
from panokit.io import (
    read_environment_map,
    read_panorama,
    write_environment_map,
    write_panorama,
)
from panokit.io.gpano import gpano_xmp, read_metadata
from panokit.io.images import encode_jpeg
from panokit.io.pictures import record_path
from panokit.provenance import Provenance, Step


def test_a_panorama_comes_back_with_all_that_is_known(tmp_path, street):
    valid = np.ones((128, 256), bool)
    valid[100:] = False
    provenance = Provenance().then(Step(stage="stitch", version="1"))
    panorama = street.with_changes(valid=valid, provenance=provenance)
    write_panorama(panorama, tmp_path / "a.jpg", key="k")
    back = read_panorama(tmp_path / "a.jpg")
    assert (back.capture, back.frame, back.provenance) == (street.capture, Frame.WORLD, provenance)
    np.testing.assert_array_equal(back.valid, valid)
    assert np.abs(back.pixels.astype(int) - street.pixels).mean() < 3
    assert json.loads((tmp_path / "a.json").read_text())["key"] == "k"


def test_the_same_panorama_is_written_with_the_same_bytes(tmp_path, street):
    for name in ("a", "b"):
        write_panorama(street, tmp_path / name / "p.jpg")
    for file in ("p.jpg", "p.json"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_a_map_comes_back_and_its_license_is_in_the_file(tmp_path, sunny, capture):
    sunny = sunny.with_changes(capture=capture, anchor=Anchor.LDR_WHITE)
    write_environment_map(sunny, tmp_path / "a.exr")
    back = read_environment_map(tmp_path / "a.exr")
    np.testing.assert_array_equal(back.radiance, sunny.radiance)
    assert (back.frame, back.anchor, back.capture) == (Frame.WORLD, Anchor.LDR_WHITE, capture)
    with OpenEXR.File(str(tmp_path / "a.exr")) as file:
        header = dict(file.header())
    assert header["panokit:license"] == "CC-BY-SA-4.0"
    assert header["owner"] == "Somebody"
    record_path(tmp_path / "a.exr").unlink()
    alone = read_environment_map(tmp_path / "a.exr")
    assert (alone.frame, alone.anchor) == (Frame.WORLD, Anchor.LDR_WHITE)


def test_radiance_files_are_maps_too(tmp_path, sunny):
    write_environment_map(sunny, tmp_path / "a.hdr")
    back = read_environment_map(tmp_path / "a.hdr")
    np.testing.assert_allclose(back.radiance, sunny.radiance, rtol=0.02, atol=0.01)


def test_unphysical_files_are_refused_or_repaired_knowingly(tmp_path):
    radiance = np.ones((16, 32, 3), np.float32)
    radiance[0, 0], radiance[1, 1], radiance[2, 2] = np.nan, np.inf, -1
    radiance[3, 3] = 50
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGB": radiance}) as file:
        file.write(str(tmp_path / "a.exr"))
    with pytest.raises(ImageError, match=r"a\.exr.*3 nan, 3 inf, 3 negative") as caught:
        read_environment_map(tmp_path / "a.exr")
    assert caught.value.reason == "not-physical"
    repaired = read_environment_map(tmp_path / "a.exr", repair=True).radiance
    assert [repaired[i, i, 0] for i in range(4)] == [0, 50, 0, 50]


@pytest.mark.parametrize(("name", "reason"), [("a.exr", "is-hdr"), ("a.hdr", "is-hdr")])
def test_hdr_files_are_not_panoramas(tmp_path, name, reason):
    with pytest.raises(ImageError) as caught:
        read_panorama(tmp_path / name)
    assert caught.value.reason == reason
    with pytest.raises(ImageError, match="panokit expand"):
        read_environment_map(tmp_path / "a.jpg")


def test_a_stray_json_file_is_not_a_record_and_a_broken_record_is_said(tmp_path, street):
    (tmp_path / "a.jpg").write_bytes(encode_jpeg(street.pixels))
    (tmp_path / "a.json").write_text('{"title": "My holidays"}')
    assert read_panorama(tmp_path / "a.jpg").capture.license.id == "unknown"
    (tmp_path / "a.json").write_text('{"schema": "panokit.panorama/1"}')
    with pytest.raises(RecordError, match="has no files, frame, provenance"):
        read_panorama(tmp_path / "a.jpg")


def test_pose_is_written_for_viewers_and_read_back(capture):
    xmp = gpano_xmp(256, 128, capture, heading_deg=30.0, leveled=True)
    known, area = read_metadata(encode_jpeg(np.zeros((128, 256, 3), np.uint8), xmp=xmp))
    assert known == {"heading_deg": 30.0, "pitch_deg": 0.0, "roll_deg": 0.0}
    assert area.is_whole


def exif_picture(latitude="N"):
    exif = Image.Exif()
    gps = exif.get_ifd(0x8825)
    gps.update({1: latitude, 2: (48.0, 30.0, 36.0), 3: "W", 4: (7.0, 45.0, 0.0)})
    tags = exif.get_ifd(0x8769)
    tags.update({0x9003: "2022:05:30 15:23:19", 0x9011: "+02:00"})
    buffer = io.BytesIO()
    Image.new("RGB", (64, 32)).save(buffer, "JPEG", exif=exif)
    return buffer.getvalue()


def test_exif_says_where_and_when():
    known, area = read_metadata(exif_picture())
    assert known["latitude_deg"] == pytest.approx(48.51)
    assert known["longitude_deg"] == pytest.approx(-7.75)
    assert known["time"] == datetime(2022, 5, 30, 13, 23, 19, tzinfo=UTC)
    assert known["time_precision"] is TimePrecision.SECOND
    assert area is None
    assert read_metadata(exif_picture("S"))[0]["latitude_deg"] == pytest.approx(-48.51)


def test_damaged_metadata_is_no_metadata():
    assert read_metadata(b"not a picture") == ({}, None)


def test_a_cropped_panorama_is_placed_in_its_sphere(tmp_path):
    fields = {
        "FullPanoWidthPixels": 512,
        "FullPanoHeightPixels": 256,
        "CroppedAreaLeftPixels": 128,
        "CroppedAreaTopPixels": 64,
        "CroppedAreaImageWidthPixels": 256,
        "CroppedAreaImageHeightPixels": 96,
    }
    xmp = " ".join(f'GPano:{name}="{value}"' for name, value in fields.items()).encode()
    (tmp_path / "a.jpg").write_bytes(
        encode_jpeg(np.full((96, 256, 3), 200, np.uint8), xmp=b"<x " + xmp + b"/>")
    )
    panorama = read_panorama(tmp_path / "a.jpg")
    assert panorama.pixels.shape == (256, 512, 3)
    rows, columns = np.nonzero(panorama.valid)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (64, 159, 128, 383)
    assert panorama.pixels[panorama.valid].min() > 190


def test_half_maps_are_scaled_and_come_back(tmp_path, sunny):
    radiance = sunny.radiance * np.float32(10)  # a sun of 6e5
    bright = sunny.with_changes(radiance=radiance, anchor=Anchor.LUMINANCE)
    write_environment_map(bright, tmp_path / "a.exr", half=True, compression="piz")
    back = read_environment_map(tmp_path / "a.exr")
    np.testing.assert_allclose(back.radiance, radiance, rtol=2e-3)
    with OpenEXR.File(str(tmp_path / "a.exr")) as file:
        header = dict(file.header())
    # What a reader that knows nothing of panokit:scale needs for cd/m2.
    assert header["whiteLuminance"] * header["panokit:scale"] == 1
    with pytest.raises(UsageError, match="one form"):
        write_environment_map(bright, tmp_path / "a.hdr", half=True)


def test_a_layer_of_a_part_is_a_map(tmp_path, sunny):
    parts = [
        OpenEXR.Part({}, {f"key.{n}": sunny.radiance[..., i].copy() for i, n in enumerate("RGB")},
                     "lights"),
        OpenEXR.Part({}, {"Z": sunny.radiance[..., 0].copy()}, "depth"),
    ]  # fmt: skip
    with OpenEXR.File(parts) as file:
        file.write(str(tmp_path / "a.exr"))
    back = read_environment_map(tmp_path / "a.exr", part="lights", layer="key")
    np.testing.assert_array_equal(back.radiance, sunny.radiance)
