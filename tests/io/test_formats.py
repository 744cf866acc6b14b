import cv2
import numpy as np
import OpenEXR
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from panokit.errors import ImageError, StorageError
from panokit.io.exr import read_exr, write_exr
from panokit.io.radiance import read_radiance, write_radiance

RADIANCE = np.random.default_rng(0).gamma(0.3, 10, (16, 32, 3)).astype(np.float32)


@settings(max_examples=25, deadline=None)
@given(arrays(np.float32, (8, 16, 3), elements=st.floats(0, 2**100, width=32)))
def test_exr_keeps_every_bit(tmp_path_factory, radiance):
    path = tmp_path_factory.mktemp("exr") / "a.exr"
    write_exr(path, radiance)
    np.testing.assert_array_equal(read_exr(path)[0], radiance)


def test_exr_tells_other_tools_what_it_is(tmp_path):
    path = tmp_path / "a.exr"
    write_exr(path, RADIANCE, {"panokit:frame": "world", "owner": "Somebody"})
    with OpenEXR.File(str(path)) as file:
        header = dict(file.header())
    assert header["envmap"] == OpenEXR.ENVMAP_LATLONG
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    assert header["owner"] == "Somebody"
    assert "u = (i + 0.5) / width" in header["comments"]
    assert read_exr(path)[1] == {"frame": "world"}


def test_half_floats_are_widened_and_alpha_ignored(tmp_path):
    path = tmp_path / "a.exr"
    half = {name: RADIANCE[..., i].astype(np.float16) for i, name in enumerate("RGB")}
    half["A"] = np.ones((16, 32), np.float16)
    header = {"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, half) as file:
        file.write(str(path))
    pixels, _ = read_exr(path)
    assert pixels.dtype == np.float32
    np.testing.assert_array_equal(pixels, RADIANCE.astype(np.float16).astype(np.float32))


def test_other_channel_names_are_listed(tmp_path):
    path = tmp_path / "a.exr"
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    planes = {f"beauty.{n}": RADIANCE[..., i].copy() for i, n in enumerate("RGB")}
    with OpenEXR.File(header, planes) as file:
        file.write(str(path))
    with pytest.raises(ImageError, match=r"it has: beauty\.B, beauty\.G, beauty\.R") as caught:
        read_exr(path)
    assert caught.value.reason == "wrong-channels"


def test_damaged_exr_files(tmp_path, capfd):
    path = tmp_path / "a.exr"
    write_exr(path, RADIANCE)
    path.write_bytes(path.read_bytes()[:600])
    with pytest.raises(ImageError, match="damaged") as caught:
        read_exr(path)
    assert caught.value.reason == "truncated"
    path.write_bytes(b"\x89PNG")
    with pytest.raises(ImageError, match="not an OpenEXR"):
        read_exr(path)
    with pytest.raises(StorageError):
        read_exr(tmp_path / "nowhere.exr")
    capfd.readouterr()  # the library's own complaints


def test_radiance_files_keep_suns_within_a_percent(tmp_path):
    path = tmp_path / "a.hdr"
    radiance = RADIANCE.copy()
    radiance[2, 3] = [120000, 110000, 90000]
    write_radiance(path, radiance)
    back = read_radiance(path)
    peak = radiance.max(axis=2, keepdims=True)
    assert (np.abs(back - radiance) / peak).max() < 0.01


def rgbe(lines, pixels=b"\x80\x40\x20\x81" * 128, size=b"-Y 8 +X 16"):
    return b"#?RADIANCE\n" + b"\n".join([*lines, b"", size]) + b"\n" + pixels


FORMAT = b"FORMAT=32-bit_rle_rgbe"


def test_exposure_lines_are_divided_out(tmp_path):
    path = tmp_path / "a.hdr"
    path.write_bytes(rgbe([FORMAT]))
    plain = read_radiance(path)
    path.write_bytes(rgbe([b"EXPOSURE=2.0", FORMAT, b"EXPOSURE=4.0"]))
    np.testing.assert_allclose(read_radiance(path), plain / 8)
    assert plain[0, 0, 0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"P6 16 8", "not-an-image"),
        (rgbe([FORMAT], size=b"+Y 8 +X 16"), "wrong-orientation"),
        (rgbe([b"FORMAT=32-bit_rle_xyze"]), "wrong-color-model"),
        (rgbe([FORMAT, b"EXPOSURE=0"]), "bad-exposure"),
        (b"#?RADIANCE\n" + FORMAT, "truncated"),
        (rgbe([FORMAT], pixels=b""), "truncated"),
    ],
)
def test_radiance_files_that_cannot_be_used(tmp_path, data, reason):
    path = tmp_path / "a.hdr"
    path.write_bytes(data)
    with pytest.raises(ImageError) as caught:
        read_radiance(path)
    assert caught.value.reason == reason


def test_other_readers_see_the_same_radiance(tmp_path):
    write_radiance(tmp_path / "a.hdr", RADIANCE)
    other = cv2.imread(str(tmp_path / "a.hdr"), cv2.IMREAD_UNCHANGED)[..., ::-1]
    np.testing.assert_array_equal(read_radiance(tmp_path / "a.hdr"), other)
