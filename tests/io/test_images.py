import io

import cv2
import numpy as np
import pytest
from PIL import Image

from panokit.errors import ImageError
from panokit.io.images import decode_image, encode_jpeg, encode_png


def encoded(array, suffix=".png"):
    return bytes(cv2.imencode(suffix, array)[1])


def color(height=32, width=64):
    rng = np.random.default_rng(0)
    return rng.integers(0, 255, (height, width, 3), dtype=np.uint8)


def saved(mode, suffix):
    buffer = io.BytesIO()
    Image.new(mode, (64, 32)).save(buffer, suffix)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("data", "reason", "remedy"),
    [
        (b"", "not-an-image", "Use JPEG"),
        (b"<html>over quota</html>", "not-an-image", "Use JPEG"),
        (encode_jpeg(color())[:900], "truncated", "again"),
        (encode_png(color())[:900], "truncated", "again"),
        (encoded(np.zeros((32, 64), np.uint8)), "grey", "RGB"),
        (saved("L", "JPEG"), "grey", "RGB"),
        (encoded(np.zeros((32, 64, 3), np.uint16)), "not-8-bit", "8-bit"),
        (encoded(np.zeros((32, 64, 4), np.uint8)), "alpha", "without"),
        (saved("CMYK", "JPEG"), "wrong-color-model", "sRGB"),
    ],
)
def test_each_doubt_is_named_with_a_remedy(data, reason, remedy):
    with pytest.raises(ImageError, match=remedy) as caught:
        decode_image(data, what="pano.jpg")
    assert caught.value.reason == reason
    assert "pano.jpg" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_png_is_exact_and_jpeg_is_close():
    pixels = np.ascontiguousarray(cv2.resize(color(8, 16), (128, 64)))
    np.testing.assert_array_equal(decode_image(encode_png(pixels), what="a"), pixels)
    back = decode_image(encode_jpeg(pixels, quality=98), what="a").astype(int)
    assert np.abs(back - pixels).mean() < 1.5


def test_channels_are_in_the_order_red_green_blue():
    red = np.zeros((32, 64, 3), np.uint8)
    red[..., 0] = 255
    for data in (encode_png(red), encode_jpeg(red)):
        assert decode_image(data, what="a")[0, 0].tolist() == pytest.approx([254, 0, 0], abs=1)


def test_a_picture_too_wide_to_remap_is_refused():
    with pytest.raises(ImageError, match="32766"):
        decode_image(encode_jpeg(np.zeros((8, 40000, 3), np.uint8)), what="strip.jpg")


def test_a_very_large_panorama_is_welcome():
    data = encode_jpeg(np.zeros((7000, 14000, 3), np.uint8), quality=30)
    assert decode_image(data, what="large.jpg").shape == (7000, 14000, 3)
