"""What the bytes of a JPEG say, without decoding: its size, whether it is all there, a sphere."""

from panokit.errors import ImageError, ItemError

_START, _END = b"\xff\xd8", b"\xff\xd9"
_START_OF_SCAN = 0xDA
# Start-of-frame markers; DHT, JPG and DAC lie between them (ITU-T T.81, table B.1).
_FRAME_MARKERS = set(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_STANDALONE_MARKERS = {0x01, *range(0xD0, 0xD8)}


def jpeg_size(data: bytes, what: str) -> tuple[int, int]:
    """Width and height of a whole JPEG; cameras may have added data after its end.

    Args:
        data: The file.
        what: Its name, for messages.

    Raises:
        ImageError: If it is not a JPEG ("not-an-image"), or ends early ("truncated").
    """
    if not data.startswith(_START):
        raise ImageError(
            f"{what} is not a JPEG (it begins with {data[:4].hex(' ') or 'nothing'}). "
            "Fetch it again.",
            reason="not-an-image",
        )
    size: tuple[int, int] | None = None
    position = 2
    while position + 4 <= len(data) and data[position] == 0xFF:
        marker = data[position + 1]
        if marker == 0xFF or marker in _STANDALONE_MARKERS:
            position += 1 if marker == 0xFF else 2
            continue
        length = int.from_bytes(data[position + 2 : position + 4], "big")
        if marker in _FRAME_MARKERS and position + 9 <= len(data):
            height = int.from_bytes(data[position + 5 : position + 7], "big")
            size = int.from_bytes(data[position + 7 : position + 9], "big"), height
        position += 2 + length
        if marker == _START_OF_SCAN:
            # Thumbnails in the header have ends of their own; only one behind the scan counts.
            if size is not None and data.find(_END, position) >= 0:
                return size
            break
    raise ImageError(f"{what} ends early. Fetch it again.", reason="truncated")


def check_sphere(body: bytes, what: str) -> None:
    """Check that a body is a whole JPEG of a full sphere.

    Raises:
        ItemError: If not ("not-an-image", "truncated", "not-360").
    """
    width, height = jpeg_size(body, what)
    if width != 2 * height:
        raise ItemError(
            f"{what} is {width}x{height}; a full sphere is twice as wide as high.",
            reason="not-360",
            values={"width_px": width, "height_px": height},
        )
