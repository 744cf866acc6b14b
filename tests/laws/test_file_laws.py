"""What is written is read back; what is damaged is refused, and nothing else happens."""

from contextlib import suppress

import numpy as np
import OpenEXR
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from panokit.errors import ImageError
from panokit.io.exr import iterate_exr_rows, read_exr, write_exr
from panokit.io.radiance import (
    iterate_radiance_rows,
    read_radiance,
    read_radiance_rows,
    write_radiance,
)

sizes = st.tuples(st.integers(1, 40), st.integers(1, 40))
shared_folder = settings(
    deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def pictures(top, low=0.0):
    return sizes.flatmap(
        lambda size: arrays(np.float32, (*size, 3), elements=st.floats(low, top, width=32))
    )


@shared_folder
@given(pictures(2.0**100, low=-(2.0**100)), st.sampled_from(["zip", "zips", "rle", "none", "piz"]))
def test_float_exr_keeps_every_bit(tmp_path, radiance, compression):
    write_exr(tmp_path / "a.exr", radiance, compression=compression)
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr")[0], radiance)


@shared_folder
@given(pictures(2.0**16).map(lambda p: p * 2.0**4 + np.float32(0.25)))
def test_half_exr_keeps_eleven_bits_whatever_its_sun(tmp_path, radiance):
    write_exr(tmp_path / "a.exr", radiance, half=True)
    np.testing.assert_allclose(read_exr(tmp_path / "a.exr")[0], radiance, rtol=2**-11)


@shared_folder
@given(pictures(2.0**90))
def test_radiance_keeps_a_256th_of_the_brightest_channel(tmp_path, radiance):
    write_radiance(tmp_path / "a.hdr", radiance)
    once = read_radiance(tmp_path / "a.hdr")
    step = radiance.max(axis=2, keepdims=True).astype(np.float64) / 256
    assert (np.abs(once.astype(np.float64) - radiance) <= step * (1 + 1e-6) + 1e-31).all()
    write_radiance(tmp_path / "b.hdr", once)
    np.testing.assert_array_equal(read_radiance(tmp_path / "b.hdr"), once)


@shared_folder
@given(pictures(10.0), st.integers(1, 50), st.integers(0, 40), st.integers(0, 40))
def test_rows_are_the_rows_of_the_whole(tmp_path, radiance, strip, first, last):
    write_radiance(tmp_path / "a.hdr", radiance)
    whole = read_radiance(tmp_path / "a.hdr")
    strips = [pixels for _, pixels in iterate_radiance_rows(tmp_path / "a.hdr", strip_rows=strip)]
    np.testing.assert_array_equal(np.concatenate(strips), whole)
    some = read_radiance_rows(tmp_path / "a.hdr", slice(first, last))
    np.testing.assert_array_equal(some, whole[first:last])


RADIANCE = np.random.default_rng(0).gamma(0.3, 10, (20, 40, 3)).astype(np.float32)


def exr_bytes(tmp_path_factory, compression):
    path = tmp_path_factory.mktemp("whole") / "a.exr"
    write_exr(path, RADIANCE, {"panokit:frame": "world"}, compression=compression)
    return path.read_bytes()


@pytest.fixture(scope="module")
def whole_files(tmp_path_factory):
    """Sound files by suffix."""
    folder = tmp_path_factory.mktemp("whole")
    write_radiance(folder / "a.hdr", RADIANCE)
    tiles = OpenEXR.TileDescription()
    tiles.xSize = tiles.ySize = 16
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.tiledimage, "tiles": tiles}
    with OpenEXR.File(header, {"RGB": RADIANCE}) as file:
        file.write(str(folder / "tiled.exr"))
    pixels = b"\x80\x40\x20\x81\x01\x01\x01\x07" * 5
    old = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20 +X 40\n" + pixels * 20
    return {
        "zip.exr": exr_bytes(tmp_path_factory, "zip"),
        "piz.exr": exr_bytes(tmp_path_factory, "piz"),
        "dwaa.exr": exr_bytes(tmp_path_factory, "dwaa"),
        "tiled.exr": (folder / "tiled.exr").read_bytes(),
        "new.hdr": (folder / "a.hdr").read_bytes(),
        "old.hdr": old,
    }


def read_all_ways(path):
    if path.suffix == ".exr":
        whole = read_exr(path, repair=True)[0]
        strips = [strip for _, strip in iterate_exr_rows(path)]
    else:
        whole = read_radiance(path)
        strips = [strip for _, strip in iterate_radiance_rows(path, strip_rows=7)]
    assert whole.dtype == np.float32
    assert np.concatenate(strips).shape == whole.shape


KINDS = ["zip.exr", "piz.exr", "dwaa.exr", "tiled.exr", "new.hdr", "old.hdr"]


@pytest.mark.parametrize("kind", KINDS)
@shared_folder
@given(share=st.floats(0, 1, exclude_max=True))
def test_a_truncated_file_is_an_image_error(tmp_path, whole_files, kind, share, capfd):
    whole = whole_files[kind]
    path = tmp_path / kind
    path.write_bytes(whole[: int(len(whole) * share)])
    with pytest.raises(ImageError) as caught:
        read_all_ways(path)
    assert caught.value.reason in ("truncated", "not-an-image")
    capfd.readouterr()  # the library's own complaints


@pytest.mark.parametrize("kind", KINDS)
@shared_folder
@given(st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(0, 255)), min_size=1))
def test_a_damaged_file_is_read_or_refused(tmp_path, whole_files, kind, capfd, changes):
    damaged = bytearray(whole_files[kind])
    for share, value in changes:
        # Half of the damage in the header, where it hurts most.
        place = share * 2 * 400 if share < 0.5 else (share - 0.5) * 2 * len(damaged)
        damaged[min(int(place), len(damaged) - 1)] = value
    path = tmp_path / kind
    path.write_bytes(damaged)
    with suppress(ImageError):
        read_all_ways(path)
    capfd.readouterr()


def test_the_sound_files_are_sound(tmp_path, whole_files):
    for kind, data in whole_files.items():
        (tmp_path / kind).write_bytes(data)
        read_all_ways(tmp_path / kind)
