"""Reading a JPEG's size and wholeness from its bytes alone."""

import pytest

from panokit.errors import ImageError
from panokit.fetch.jpeg import jpeg_size
from tests.fetch.conftest import picture_bytes

WHOLE = picture_bytes(128)


def test_the_size_of_a_whole_picture():
    assert jpeg_size(WHOLE, "it") == (128, 64)


def test_data_behind_the_end_does_no_harm():
    assert jpeg_size(WHOLE + b"camera notes" * 50, "it") == (128, 64)


@pytest.mark.parametrize("keep", [0.05, 0.5, 0.9])
def test_a_part_is_truncated(keep):
    with pytest.raises(ImageError) as caught:
        jpeg_size(WHOLE[: int(len(WHOLE) * keep)], "it")
    assert caught.value.reason == "truncated"


def test_the_end_of_a_thumbnail_is_not_the_end():
    thumbnail = picture_bytes(32)
    segment = b"\xff\xe1" + (len(thumbnail) + 2).to_bytes(2, "big") + thumbnail
    with_thumbnail = WHOLE[:2] + segment + WHOLE[2:]
    assert jpeg_size(with_thumbnail, "it") == (128, 64)
    with pytest.raises(ImageError, match="ends early"):
        jpeg_size(with_thumbnail[:-200], "it")


@pytest.mark.parametrize("body", [b"", b"<html>", b"\x89PNG\r\n\x1a\n"])
def test_other_bytes_are_no_jpeg(body):
    with pytest.raises(ImageError) as caught:
        jpeg_size(body, "it")
    assert caught.value.reason == "not-an-image"
