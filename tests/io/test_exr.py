import struct
import subprocess
import sys

import numpy as np
import OpenEXR
import pytest

from panokit.errors import ImageError, StorageError, UsageError
from panokit.io.exr import COMPRESSIONS, iterate_exr_rows, read_exr, write_exr
from panokit.sphere import equirect_directions

RADIANCE = np.random.default_rng(0).gamma(0.3, 10, (16, 32, 3)).astype(np.float32)
LOSSLESS = ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "HTJ2K32", "HTJ2K256", "ZSTD")


def write(path, channels=None, **header):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
    with OpenEXR.File(header, channels or {"RGB": RADIANCE}) as file:
        file.write(str(path))
    return path


def planes(radiance=RADIANCE, prefix="", dtype=np.float32):
    return {f"{prefix}{name}": radiance[..., i].astype(dtype) for i, name in enumerate("RGB")}


def header_of(path):
    with OpenEXR.File(str(path)) as file:
        return dict(file.header())


def test_other_tools_are_told_what_it_is(tmp_path):
    path = tmp_path / "a.exr"
    write_exr(path, RADIANCE, {"panokit:frame": "world", "owner": "Somebody"})
    header = header_of(path)
    assert header["envmap"] == OpenEXR.ENVMAP_LATLONG
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    assert header["owner"] == "Somebody"
    assert "u = (i + 0.5) / width" in header["comments"]
    assert read_exr(path)[1] == {"frame": "world"}


@pytest.mark.parametrize("name", LOSSLESS)
@pytest.mark.parametrize("dtype", [np.float16, np.float32])
def test_every_lossless_compression_is_read(tmp_path, name, dtype):
    compression = getattr(OpenEXR, f"{name}_COMPRESSION", None)
    if compression is None:  # an older OpenEXR
        compression = OpenEXR.ZIP_COMPRESSION
    path = write(tmp_path / "a.exr", planes(dtype=dtype), compression=compression)
    expected = RADIANCE.astype(dtype).astype(np.float32)
    np.testing.assert_array_equal(read_exr(path)[0], expected)


@pytest.mark.parametrize(
    ("name", "tolerance"), [("PXR24", 1e-3), ("B44", 0.1), ("B44A", 0.1), ("DWAA", 0.1)]
)
def test_lossy_compressions_are_read(tmp_path, name, tolerance):
    compression = getattr(OpenEXR, f"{name}_COMPRESSION")
    smooth = (2 + equirect_directions(64, 32)).astype(np.float32)
    path = write(tmp_path / "a.exr", planes(smooth, dtype=np.float16), compression=compression)
    np.testing.assert_allclose(read_exr(path)[0], smooth, rtol=tolerance)


def test_integers_halves_and_alpha(tmp_path):
    channels = planes(np.full((16, 32, 3), 70000.0), dtype=np.uint32)
    channels["A"] = np.ones((16, 32), np.float16)
    pixels, _ = read_exr(write(tmp_path / "a.exr", channels))
    assert pixels.dtype == np.float32
    assert (pixels == 70000).all()


def test_tiles_and_rows_from_below(tmp_path, raw_exr):
    tiles = OpenEXR.TileDescription()
    tiles.xSize = tiles.ySize = 16
    tiled = write(tmp_path / "t.exr", type=OpenEXR.tiledimage, tiles=tiles)
    downward = write(tmp_path / "d.exr", lineOrder=OpenEXR.DECREASING_Y)
    mipmap = tmp_path / "m.exr"
    mipmap.write_bytes(raw_exr(planes(), tile=8, mipmap=True).to_bytes())
    for path in (tiled, downward, mipmap):
        np.testing.assert_array_equal(read_exr(path)[0], RADIANCE)


def box(left, top, right, bottom):
    return np.array([left, top], np.int32), np.array([right, bottom], np.int32)


@pytest.mark.parametrize("offset", [(-5, -4), (3, 2), (100, 100), (0, 20), (-40, 1)])
def test_a_data_window_is_placed_in_its_display_window(tmp_path, offset):
    x, y = offset
    path = write(
        tmp_path / "a.exr",
        dataWindow=box(x, y, x + 31, y + 15),
        displayWindow=box(-2, -1, 45, 22),
    )
    canvas = np.zeros((400, 400, 3), np.float32)
    canvas[y + 200 : y + 216, x + 200 : x + 232] = RADIANCE
    np.testing.assert_array_equal(read_exr(path)[0], canvas[199:223, 198:246])
    rows = np.zeros((24, 48, 3), np.float32)
    for top, strip in iterate_exr_rows(path):
        rows[top : top + len(strip)] = strip
    np.testing.assert_array_equal(rows, canvas[199:223, 198:246])


def test_an_environment_map_is_its_data_window(tmp_path):
    path = write(
        tmp_path / "a.exr",
        dataWindow=box(5, 5, 36, 20),
        displayWindow=box(0, 0, 63, 31),
        envmap=OpenEXR.ENVMAP_LATLONG,
    )
    np.testing.assert_array_equal(read_exr(path)[0], RADIANCE)


def two_parts(path):
    parts = [
        OpenEXR.Part({}, {"Z": RADIANCE[..., 0].copy()}, "depth"),
        OpenEXR.Part({}, {"RGB": RADIANCE}, "left"),
        OpenEXR.Part({}, {"RGB": 2 * RADIANCE}, "right"),
    ]
    with OpenEXR.File(parts) as file:
        file.write(str(path))
    return path


def test_parts_are_chosen_by_name_or_number(tmp_path):
    path = two_parts(tmp_path / "a.exr")
    with pytest.raises(ImageError, match=r"part=.*0 'depth' \(Z\), 1 'left'") as caught:
        read_exr(path)
    assert caught.value.reason == "wrong-part"
    np.testing.assert_array_equal(read_exr(path, part="left")[0], RADIANCE)
    np.testing.assert_array_equal(read_exr(path, part=2)[0], 2 * RADIANCE)
    with pytest.raises(ImageError, match="no part 'middle'"):
        read_exr(path, part="middle")
    with pytest.raises(ImageError, match="one channel, Z"):
        read_exr(path, part="depth")


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_no_part_is_taken_for_another_where_one_is_cut_off(tmp_path, share, capfd):
    path = two_parts(tmp_path / "a.exr")
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])
    with pytest.raises(ImageError) as caught:
        read_exr(path, part="left")
    assert caught.value.reason == "truncated"
    capfd.readouterr()


def test_the_only_part_with_a_picture_needs_no_name(tmp_path):
    parts = [
        OpenEXR.Part({}, {"Z": RADIANCE[..., 0].copy()}, "depth"),
        OpenEXR.Part({}, {"RGB": RADIANCE}, "beauty"),
    ]
    with OpenEXR.File(parts) as file:
        file.write(str(tmp_path / "a.exr"))
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr")[0], RADIANCE)


def test_layers_are_chosen_or_listed(tmp_path):
    path = write(tmp_path / "a.exr", {**planes(prefix="diffuse."), **planes(prefix="glossy.")})
    with pytest.raises(ImageError, match=r"layer=: 'diffuse', 'glossy'") as caught:
        read_exr(path)
    assert caught.value.values["layers"] == ["diffuse", "glossy"]
    np.testing.assert_array_equal(read_exr(path, layer="glossy")[0], RADIANCE)
    blender = write(tmp_path / "b.exr", planes(prefix="ViewLayer.Combined."))
    np.testing.assert_array_equal(read_exr(blender)[0], RADIANCE)


def test_one_channel_is_refused_unless_it_is_named(tmp_path):
    path = write(tmp_path / "a.exr", {"Y": RADIANCE[..., 1].copy()})
    with pytest.raises(ImageError, match=r"one channel, Y.*layer='Y'") as caught:
        read_exr(path)
    assert caught.value.reason == "wrong-channels"
    gray = read_exr(path, layer="Y")[0]
    np.testing.assert_array_equal(gray, RADIANCE[..., 1:2].repeat(3, axis=2))


def test_deep_files_are_refused_with_a_remedy(tmp_path, raw_exr):
    deep = raw_exr(
        planes(),
        extra=b"type\0string\0" + struct.pack("<i", 12) + b"deepscanline"
        + b"name\0string\0" + struct.pack("<i", 1) + b"a"
        + b"chunkCount\0int\0" + struct.pack("<2i", 4, 16)
        + b"version\0int\0" + struct.pack("<2i", 4, 1),
    ).to_bytes()  # fmt: skip
    path = tmp_path / "a.exr"
    path.write_bytes(deep[:4] + struct.pack("<i", 2 | 0x800) + deep[8:])
    with pytest.raises(ImageError, match=r"deep.*Flatten") as caught:
        read_exr(path)
    assert caught.value.reason == "deep"


def test_half_with_infinities_is_refused_with_the_cause_or_repaired(tmp_path):
    half = {name: plane.copy() for name, plane in planes(dtype=np.float16).items()}
    half["R"][2, 3], half["G"][2, 3], half["B"][4, 4] = np.inf, np.inf, np.nan
    path = write(tmp_path / "a.exr", half)
    with pytest.raises(ImageError, match=r"1 nan, 2 inf.*Half floats end at 65504") as caught:
        read_exr(path)
    assert caught.value.values == {"nan": 1, "inf": 2, "negative": 0}
    repaired, _ = read_exr(path, repair=True)
    assert np.isfinite(repaired).all()
    assert repaired[4, 4, 2] == 0
    assert repaired[2, 3, 0] == np.float16(RADIANCE).astype(np.float32)[repaired < 1e4].max()
    with pytest.raises(ImageError, match="repair=True"):
        list(iterate_exr_rows(path))


def test_dwaa_near_the_end_of_half_is_flagged(tmp_path):
    rows, columns = np.mgrid[:32, :64]
    disk = (np.hypot(rows - 15.3, columns - 20.6) < 6)[..., None]
    sun = np.where(disk, 65504, RADIANCE.repeat(2, 0).repeat(2, 1)).astype(np.float32)
    channels = planes(sun, dtype=np.float16)
    path = write(tmp_path / "a.exr", channels, compression=OpenEXR.DWAA_COMPRESSION)
    with pytest.raises(ImageError, match="DWAA and DWAB turn values near 65504"):
        read_exr(path)


@pytest.mark.parametrize("compression", COMPRESSIONS)
@pytest.mark.parametrize("half", [False, True])
def test_a_sun_never_overflows_whatever_is_asked(tmp_path, compression, half):
    radiance = (1.5 + 0.5 * equirect_directions(64, 32)).astype(np.float32)
    radiance[8:12, 8:12] = [9e5, 7e5, 5e5]
    path = tmp_path / "a.exr"
    write_exr(path, radiance, {"whiteLuminance": 1.0}, half=half, compression=compression)
    back, attributes = read_exr(path)
    lossy = compression in ("b44", "b44a", "dwaa", "dwab")
    np.testing.assert_allclose(back[9:11, 9:11], radiance[9:11, 9:11], rtol=0.05 if lossy else 1e-3)
    assert np.median(np.abs(back / radiance - 1)) < (0.05 if lossy else 2e-3)
    if half or compression in ("dwaa", "dwab"):
        scale = float(attributes["scale"])
        assert scale == 2.0**-4
        assert header_of(path)["whiteLuminance"] == 1 / scale
    else:
        assert "scale" not in attributes


def test_half_without_a_sun_is_not_scaled(tmp_path):
    write_exr(tmp_path / "a.exr", RADIANCE, half=True)
    back, attributes = read_exr(tmp_path / "a.exr")
    assert "scale" not in attributes
    np.testing.assert_array_equal(back, RADIANCE.astype(np.float16).astype(np.float32))


def test_what_cannot_be_written(tmp_path):
    path = tmp_path / "a.exr"
    wide = np.full((16, 32, 3), 1e-3, np.float32)
    wide[0, 0] = 1e9
    with pytest.raises(ImageError, match="Half floats cannot hold both") as caught:
        write_exr(path, wide, half=True)
    assert caught.value.reason == "range-too-wide"
    for bad in (np.nan, np.inf):
        broken = RADIANCE.copy()
        broken[3, 3] = bad
        with pytest.raises(ImageError, match=r"3 (nan|inf)"):
            write_exr(path, broken)
    for shape in ((16, 32), (0, 32, 3), (16, 32, 1)):
        with pytest.raises(UsageError):
            write_exr(path, np.zeros(shape, np.float32))
    with pytest.raises(UsageError, match="compression 'jpeg'"):
        write_exr(path, RADIANCE, compression="jpeg")
    assert not list(tmp_path.iterdir())


def test_float64_beyond_float32_is_refused(tmp_path):
    radiance = np.ones((16, 32, 3))
    radiance[0, 0, 0] = 1e300
    with np.errstate(over="ignore"), pytest.raises(ImageError, match="as float32"):
        write_exr(tmp_path / "a.exr", radiance)


def test_damaged_files(tmp_path, capfd):
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


@pytest.mark.parametrize("size", [(1_000_000, 1_000_000), (40_000, 20_000), (4096, 2048)])
def test_a_file_that_lies_about_its_size_costs_no_memory(tmp_path, size, raw_exr, capfd):
    whole = raw_exr(planes()).to_bytes()
    start = whole.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
    lie = struct.pack("<4i", 0, 0, size[0] - 1, size[1] - 1)
    path = tmp_path / "a.exr"
    path.write_bytes(whole[:start] + lie + whole[start + 16 :])
    code = (
        "import resource, sys\nfrom pathlib import Path\nfrom panokit.errors import ImageError\n"
        "from panokit.io.exr import read_exr\n"
        "rss = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "before = rss()\n"
        "try:\n    read_exr(Path(sys.argv[1]))\n"
        "except ImageError as error:\n    print(error.reason)\n"
        "print((rss() - before) // 1024)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True
    )
    reason, grown = done.stdout.split()
    assert reason == "truncated"
    assert int(grown) < 40
    capfd.readouterr()


def test_a_display_window_that_lies_is_refused(tmp_path):
    path = write(tmp_path / "a.exr", displayWindow=box(0, 0, 10**6, 10**6))
    with pytest.raises(ImageError, match="claims 1000001x1000001") as caught:
        read_exr(path)
    assert caught.value.reason == "wrong-size"


def test_large_files_are_read_in_strips(tmp_path):
    tall = np.random.default_rng(1).random((700, 64, 3)).astype(np.float32)
    write_exr(tmp_path / "a.exr", tall)
    tops = []
    for top, strip in iterate_exr_rows(tmp_path / "a.exr"):
        np.testing.assert_array_equal(strip, tall[top : top + len(strip)])
        tops.append(top)
    assert tops == [0, 256, 512]


def test_tiles_that_lie_about_their_size_cost_no_memory(tmp_path, raw_exr):
    data = raw_exr(planes(), tile=16).to_bytes()
    place = data.index(b"tiledesc\0") + 9 + 4
    path = tmp_path / "a.exr"
    path.write_bytes(data[: place + 4] + struct.pack("<I", 1 << 24) + data[place + 8 :])
    with pytest.raises(ImageError, match="tiles of 16x16777216"):
        read_exr(path)


def test_header_text_in_another_encoding_is_named(tmp_path, raw_exr):
    owner = b"owner\0string\0" + struct.pack("<i", 4) + "René".encode("latin-1")
    path = tmp_path / "a.exr"
    path.write_bytes(raw_exr(planes(), extra=owner).to_bytes())
    with pytest.raises(ImageError, match=r"not UTF-8.*exrstdattr"):
        read_exr(path)


def test_reading_needs_little_more_than_the_picture(tmp_path):
    code = """
import resource, sys
from pathlib import Path
import numpy as np
from panokit.io.exr import iterate_exr_rows, read_exr, write_exr
path, rss = Path(sys.argv[1]), lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
if sys.argv[2] == "write":
    noise = np.random.default_rng(0).random((2048, 4096, 3), np.float32)
    write_exr(path, noise, compression="none")
before = rss()
if sys.argv[2] == "rows":
    assert sum(len(strip) for _, strip in iterate_exr_rows(path)) == 2048
if sys.argv[2] == "whole":
    assert read_exr(path)[0].shape == (2048, 4096, 3)
print(rss() - before)
"""
    grown = {}
    for mode in ("write", "rows", "whole"):
        done = subprocess.run(
            [sys.executable, "-c", code, str(tmp_path / "a.exr"), mode],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        grown[mode] = int(done.stdout)
    assert grown["rows"] < 90  # MB, where the picture has 96 and its planes as many again
    assert grown["whole"] < 96 + 90


def test_a_scale_that_cannot_be_divided_out(tmp_path):
    path = write(tmp_path / "a.exr", **{"panokit:scale": 0.0})
    with pytest.raises(ImageError, match="panokit:scale"):
        read_exr(path)
