import subprocess
import sys

import cv2
import numpy as np
import pytest

from panokit.errors import ImageError, StorageError, UsageError
from panokit.io.radiance import (
    iterate_radiance_rows,
    read_radiance,
    read_radiance_header,
    read_radiance_rows,
    write_radiance,
    write_radiance_rows,
)

RADIANCE = np.random.default_rng(0).gamma(0.3, 10, (16, 32, 3)).astype(np.float32)
FORMAT = b"FORMAT=32-bit_rle_rgbe"
ONE = b"\x80\x80\x80\x81"  # 1.0, 1.0, 1.0


def rgbe(lines=(FORMAT,), pixels=ONE * 128, size=b"-Y 8 +X 16"):
    return b"#?RADIANCE\n" + b"\n".join([*lines, b"", size]) + b"\n" + pixels


def put(path, data):
    path.write_bytes(data)
    return path


def test_suns_are_kept_within_half_a_step(tmp_path):
    path = tmp_path / "a.hdr"
    radiance = RADIANCE.copy()
    radiance[2, 3] = [120000, 110000, 90000]
    write_radiance(path, radiance)
    back = read_radiance(path)
    peak = radiance.max(axis=2, keepdims=True)
    assert (np.abs(back - radiance) / peak).max() <= 1 / 256
    # Rounded, not cut off: the sum has no bias.
    flat = np.random.default_rng(1).uniform(1, 2, (64, 128, 3)).astype(np.float32)
    write_radiance(path, flat)
    assert read_radiance(path).mean() == pytest.approx(flat.mean(), rel=1e-4)


def test_other_readers_see_the_same_radiance(tmp_path):
    path = tmp_path / "a.hdr"
    write_radiance(path, RADIANCE)
    other = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1]
    np.testing.assert_array_equal(read_radiance(path), other)


@pytest.mark.parametrize("width", [1, 7, 8, 128, 300, 32767, 32768])
def test_every_width_comes_back_the_same(tmp_path, width):
    radiance = np.random.default_rng(width).gamma(0.5, 2, (3, width, 3)).astype(np.float32)
    radiance[1, : width // 2] = 0.25  # runs
    write_radiance(tmp_path / "a.hdr", radiance)
    once = read_radiance(tmp_path / "a.hdr")
    assert (np.abs(once - radiance) <= radiance.max(axis=2, keepdims=True) / 256).all()
    write_radiance(tmp_path / "b.hdr", once)
    np.testing.assert_array_equal(read_radiance(tmp_path / "b.hdr"), once)


def test_exposure_and_color_correction_are_divided_out(tmp_path):
    path = put(tmp_path / "a.hdr", rgbe([b"EXPOSURE=2.0", FORMAT, b"EXPOSURE= 4.0"]))
    np.testing.assert_allclose(read_radiance(path), 1 / 8)
    put(path, rgbe([b"COLORCORR=1 2 4", b"EXPOSURE=2", b"COLORCORR=2 2 2", FORMAT]))
    np.testing.assert_allclose(read_radiance(path)[3, 3], [1 / 4, 1 / 8, 1 / 16])


def test_the_header_is_told(tmp_path):
    lines = [b"# a comment", b"rpict -vta x=5", b"PIXASPECT=0.5", b"PIXASPECT=2", b"EXPOSURE=3",
             FORMAT, b"GAMMA=1", b"VIEW= -vta -vh 360"]  # fmt: skip
    header = read_radiance_header(put(tmp_path / "a.hdr", rgbe(lines)))
    assert (header.width_px, header.height_px) == (16, 8)
    assert (header.exposure, header.pixel_aspect, header.color_model) == (3, 1, "rgbe")
    assert header.orientation == "-Y +X"


@pytest.mark.parametrize("orientation", [
    "-Y +X", "-Y -X", "+Y +X", "+Y -X", "+X -Y", "+X +Y", "-X -Y", "-X +Y",
])  # fmt: skip
@pytest.mark.parametrize("packed", [True, False])
def test_all_eight_orientations_are_turned_upright(tmp_path, orientation, packed):
    write_radiance(tmp_path / "a.hdr", RADIANCE)
    upright = read_radiance(tmp_path / "a.hdr")
    # The definition, pixel by pixel: Y points up, X to the right.
    slow, fast = orientation.split()
    counts = {"X": 32, "Y": 16}
    turned = np.zeros((counts[slow[1]], counts[fast[1]], 3), np.float32)
    for i in range(turned.shape[0]):
        for j in range(turned.shape[1]):
            place = {}
            for index, axis in ((i, slow), (j, fast)):
                count = counts[axis[1]]
                place[axis[1]] = index if axis[0] == "+" else count - 1 - index
            turned[i, j] = upright[15 - place["Y"], place["X"]]
    if packed:
        write_radiance(tmp_path / "b.hdr", turned)
        pixels = (tmp_path / "b.hdr").read_bytes().split(b"\n-Y ")[1].split(b"\n", 1)[1]
    else:
        pixels = flat_rgbe(turned)
    size = f"{slow} {counts[slow[1]]} {fast} {counts[fast[1]]}".encode()
    path = put(tmp_path / "c.hdr", rgbe(pixels=pixels, size=size))
    np.testing.assert_array_equal(read_radiance(path), upright)
    if slow[1] == "Y":
        rows = np.zeros_like(upright)
        for top, strip in iterate_radiance_rows(path, strip_rows=5):
            rows[top : top + len(strip)] = strip
        np.testing.assert_array_equal(rows, upright)
        np.testing.assert_array_equal(read_radiance_rows(path, slice(3, 9)), upright[3:9])
    else:
        with pytest.raises(ImageError, match="stores columns"):
            next(iterate_radiance_rows(path))


def flat_rgbe(pixels):
    """RGBE one pixel after the other, exact for what was read from RGBE."""
    quads = bytearray()
    for value in pixels.reshape(-1, 3):
        peak = value.max()
        if peak == 0:
            quads += b"\0\0\0\0"
            continue
        exponent = int(np.frexp(peak)[1])
        quads += bytes(int(v * 2.0 ** (8 - exponent)) for v in value) + bytes([exponent + 128])
    return bytes(quads)


def test_old_run_lengths(tmp_path):
    a, b = b"\x80\x40\x20\x81", b"\x10\x80\x20\x82"
    # 300 = 1 + 43 + 1 * 256 in base 256, low digit first; the second line has no runs.
    line = a + b"\x01\x01\x01" + bytes([43]) + b"\x01\x01\x01\x01"
    other = (a + b) * 150
    path = put(tmp_path / "a.hdr", rgbe(pixels=line + other, size=b"-Y 2 +X 300"))
    read = read_radiance(path)
    assert (read[0] == [1.0, 0.5, 0.25]).all()
    assert (read[1, ::2] == [1.0, 0.5, 0.25]).all()
    assert (read[1, 1::2] == [0.25, 2.0, 0.5]).all()


def test_xyze_is_luminance_and_becomes_rec709(tmp_path):
    white = b"\x80\x80\x80\x81"
    path = put(tmp_path / "a.hdr", rgbe([b"FORMAT=32-bit_rle_xyze"], white * 128))
    # X = Y = Z = 1 cd/m2 is white of 1 / 179 W/(sr m2).
    np.testing.assert_allclose(read_radiance(path), 1 / 179, rtol=1e-4)


def test_primaries_are_converted(tmp_path):
    wide = b"PRIMARIES= .713 .293 .165 .83 .128 .044 .32168 .33767"
    red = b"\x80\x00\x00\x81"
    path = put(tmp_path / "a.hdr", rgbe([wide, FORMAT], red * 128))
    # The ACEScg red lies outside of Rec.709: more red than 1, and negative green.
    pixel = read_radiance(path)[0, 0]
    np.testing.assert_allclose(pixel, [1.705, -0.130, -0.024], atol=2e-3)
    for known in (b".64 .33 .3 .6 .15 .06 .3127 .329", b"0 0 0 0 0 0 0 0"):
        put(path, rgbe([b"PRIMARIES=" + known, FORMAT], red * 128))
        np.testing.assert_array_equal(read_radiance(path)[0, 0], [1, 0, 0])


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "not-an-image"),
        (b"P6 16 8", "not-an-image"),
        (rgbe([b"FORMAT=32-bit_rle_spectral"]), "wrong-color-model"),
        (rgbe([FORMAT, b"GAMMA=2.2"]), "wrong-color-model"),
        (rgbe([FORMAT, b"EXPOSURE=0"]), "bad-exposure"),
        (rgbe([FORMAT, b"EXPOSURE=nan"]), "bad-exposure"),
        (rgbe([FORMAT, b"EXPOSURE=two"]), "bad-exposure"),
        (rgbe([FORMAT, b"COLORCORR=1 0 1"]), "bad-header"),
        (rgbe([FORMAT, b"PRIMARIES=1 1 1 1 1 1 1 1"]), "bad-header"),
        (b"#?RADIANCE\n" + FORMAT, "truncated"),
        (rgbe(size=b"-Y 8 -Y 16"), "truncated"),
        (rgbe(size=b"-Y 0 +X 16"), "truncated"),
        (rgbe(pixels=b""), "truncated"),
        (rgbe(pixels=ONE * 127), "truncated"),
        (rgbe(pixels=b"\x01\x01\x01\x80" + ONE * 100), "truncated"),
        (rgbe(pixels=(b"\x02\x02\x00\x10" + b"\x90\x01" * 4) * 7), "truncated"),
        (rgbe(pixels=(b"\x02\x02\x00\x10" + b"\xff\x01" * 4) * 20), "truncated"),
        (rgbe([b"EXPOSURE=1e-29", FORMAT], b"\x80\x80\x80\xff" * 128), "not-physical"),
    ],
)
def test_files_that_cannot_be_used(tmp_path, data, reason):
    path = put(tmp_path / "a.hdr", data)
    with pytest.raises(ImageError) as caught:
        read_radiance(path)
    assert caught.value.reason == reason


def test_missing_files_and_wrong_arguments(tmp_path):
    for read in (read_radiance, read_radiance_header, lambda p: list(iterate_radiance_rows(p))):
        with pytest.raises(StorageError):
            read(tmp_path / "nowhere.hdr")
    path = put(tmp_path / "a.hdr", rgbe())
    with pytest.raises(UsageError):
        list(iterate_radiance_rows(path, strip_rows=0))
    with pytest.raises(UsageError):
        list(iterate_radiance_rows(path, slice(0, 8, 2)))
    assert read_radiance_rows(path, slice(5, 5)).shape == (0, 16, 3)


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf, 2.0**127])
def test_what_rgbe_cannot_hold_is_not_written(tmp_path, value):
    radiance = RADIANCE.copy()
    radiance[1, 1, 1] = value
    with pytest.raises(ImageError) as caught:
        write_radiance(tmp_path / "a.hdr", radiance)
    assert caught.value.reason == "not-physical"
    assert not list(tmp_path.iterdir())


def test_the_ends_of_the_range(tmp_path):
    radiance = np.zeros((8, 16, 3), np.float32)
    radiance[0, 0] = [1.69e38, 1e38, 1e36]
    radiance[0, 1] = 1e-30
    radiance[0, 2] = 1e-40
    write_radiance(tmp_path / "a.hdr", radiance)
    back = read_radiance(tmp_path / "a.hdr")
    np.testing.assert_allclose(back[0, 0], radiance[0, 0], atol=1.69e38 / 256)
    np.testing.assert_allclose(back[0, 1], 1e-30, rtol=1 / 256)
    assert (back[0, 2:] == 0).all()


def test_strips_are_written_as_the_whole(tmp_path):
    write_radiance(tmp_path / "a.hdr", RADIANCE)
    strips = (RADIANCE[top : top + 5] for top in range(0, 16, 5))
    write_radiance_rows(tmp_path / "b.hdr", 32, 16, strips)
    assert (tmp_path / "a.hdr").read_bytes() == (tmp_path / "b.hdr").read_bytes()
    with pytest.raises(UsageError, match="15 rows, but the picture 16"):
        write_radiance_rows(tmp_path / "c.hdr", 32, 16, [RADIANCE[:15]])
    with pytest.raises(UsageError, match=r"\(rows, 32, 3\)"):
        write_radiance_rows(tmp_path / "c.hdr", 32, 16, [RADIANCE[:, :30]])
    for shape in ((16, 32), (0, 32, 3)):
        with pytest.raises(UsageError):
            write_radiance(tmp_path / "c.hdr", np.zeros(shape, np.float32))
    assert not (tmp_path / "c.hdr").exists()


def test_large_files_need_little_memory(tmp_path):
    code = """
import resource, sys
from pathlib import Path
import numpy as np
from panokit.io.radiance import iterate_radiance_rows, write_radiance_rows
path, rss = Path(sys.argv[1]), lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
rng, before = np.random.default_rng(0), rss()
strips = (rng.random((64, 4096, 3), np.float32) for _ in range(32))
write_radiance_rows(path, 4096, 2048, strips)
wrote = rss()
total = sum(float(strip.sum()) for _, strip in iterate_radiance_rows(path, strip_rows=64))
print((wrote - before) // 1024, (rss() - before) // 1024, path.stat().st_size >> 20, total)
"""
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "a.hdr")],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    wrote, read, stored, total = (float(word) for word in done.stdout.split())
    assert wrote < 48  # MB, where the whole picture has 96
    # The file's own pages are mapped and count, but the system may take them back.
    assert read < 60 + stored
    assert total == pytest.approx(4096 * 2048 * 3 / 2, rel=1e-3)


@pytest.mark.data
def test_real_maps_are_read_as_cv2_does_and_kept(tmp_path, shared_data):
    for path in sorted((shared_data / "probes").glob("*.hdr"))[:4]:
        exposure = read_radiance_header(path).exposure
        read = read_radiance(path)
        other = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1] / np.float32(exposure)
        np.testing.assert_allclose(read, other, rtol=1e-6)
        if exposure == 1:
            write_radiance(tmp_path / "a.hdr", read)
            np.testing.assert_array_equal(read_radiance(tmp_path / "a.hdr"), read)
