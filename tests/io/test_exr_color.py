import colour
import numpy as np
import OpenEXR
import pytest

from panokit.color.primaries import REC709, luminance_weights, rec709_from_rgb, xyz_from_rgb
from panokit.errors import ImageError, UsageError
from panokit.io.exr import read_exr

RADIANCE = np.random.default_rng(0).gamma(2, 1, (16, 32, 3)).astype(np.float32)
ACESCG = (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767)
XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)


def write(path, primaries):
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "chromaticities": primaries,
    }
    with OpenEXR.File(header, {"RGB": RADIANCE}) as file:
        file.write(str(path))
    return path


@pytest.mark.filterwarnings("ignore")
def test_acescg_is_converted_as_colour_science_does(tmp_path):
    expected = colour.RGB_to_RGB(
        RADIANCE, "ACEScg", "sRGB", chromatic_adaptation_transform="Bradford"
    )
    read, _ = read_exr(write(tmp_path / "a.exr", ACESCG))
    np.testing.assert_allclose(read, expected, atol=2e-3)


def test_white_stays_white_and_xyz_is_understood(tmp_path):
    for primaries in (ACESCG, XYZ):
        np.testing.assert_allclose(rec709_from_rgb(primaries) @ np.ones(3), 1, atol=1e-9)
    np.testing.assert_allclose(xyz_from_rgb(XYZ), np.eye(3), atol=1e-12)
    read, _ = read_exr(write(tmp_path / "a.exr", XYZ))
    gray = RADIANCE.mean(axis=2, keepdims=True).repeat(3, axis=2)
    np.testing.assert_allclose(read.mean(axis=(0, 1)), gray.mean(axis=(0, 1)), rtol=0.2)
    # Only X: outside of every RGB, red with less than no green.
    assert rec709_from_rgb(XYZ)[0, 0] > 1
    assert rec709_from_rgb(XYZ)[1, 0] < 0
    assert np.abs(read - RADIANCE).max() > 0.5


def test_rec709_is_left_as_it_is(tmp_path):
    rounded = tuple(np.round(REC709, 3))
    assert rec709_from_rgb(rounded) is None
    for same in (rounded, (0.0,) * 8):
        np.testing.assert_array_equal(read_exr(write(tmp_path / "a.exr", same))[0], RADIANCE)
    np.testing.assert_allclose(luminance_weights(REC709), [0.2126, 0.7152, 0.0722], atol=1e-4)


@pytest.mark.parametrize("primaries", [(0.9,) * 8, (0.3,) * 8, (np.nan,) * 8])
def test_primaries_that_span_nothing(tmp_path, primaries):
    with pytest.raises(UsageError):
        rec709_from_rgb(primaries)
    with pytest.raises(ImageError, match="chromaticities") as caught:
        read_exr(write(tmp_path / "a.exr", primaries))
    assert caught.value.reason == "wrong-color-model"


def chroma(radiance, step):
    luma = radiance @ np.array(luminance_weights(REC709), np.float32)
    red, blue = ((radiance[..., i] - luma) / luma for i in (0, 2))
    planes = {"Y": luma, "RY": red[::step, ::step], "BY": blue[::step, ::step]}
    return {name: np.ascontiguousarray(plane, np.float32) for name, plane in planes.items()}


def test_luminance_chroma_at_full_size_is_exact(tmp_path):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, chroma(RADIANCE, 1)) as file:
        file.write(str(tmp_path / "a.exr"))
    np.testing.assert_allclose(read_exr(tmp_path / "a.exr")[0], RADIANCE, rtol=1e-4, atol=1e-5)


def test_subsampled_chroma_is_interpolated_across_the_seam(tmp_path, raw_exr):
    azimuth = (np.arange(64) + 0.5) / 64 * 2 * np.pi
    rows = np.linspace(1, 2, 32)[:, None]
    smooth = np.stack(
        [rows * (2 + np.cos(azimuth)), rows * 2 + 0 * azimuth, rows * (2 + np.sin(azimuth))], -1
    ).astype(np.float32)
    raw = raw_exr(chroma(smooth, 2), sampling={"RY": 2, "BY": 2})
    (tmp_path / "a.exr").write_bytes(raw.to_bytes())
    read, _ = read_exr(tmp_path / "a.exr")
    np.testing.assert_allclose(read, smooth, rtol=0.02)
    # Replicated instead of interpolated chroma would be off by several percent.
    assert np.abs(read / smooth - 1).mean() < 2e-3
