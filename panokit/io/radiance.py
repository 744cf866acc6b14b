"""Radiance .hdr files (RGBE), with the EXPOSURE lines that most readers ignore."""

import re
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError
from panokit.io.files import read_bytes, write_bytes

_RESOLUTION = re.compile(rb"^([+-][XY]) (\d+) ([+-][XY]) (\d+)$")
_HEADER_LIMIT = 1 << 16


def read_radiance(path: Path) -> NDArray[np.float32]:
    """The radiance in a .hdr file, (H, W, 3) float32.

    A file's EXPOSURE lines say what its pixels were multiplied with; they are divided out.

    Raises:
        ImageError: If it is not a readable Radiance file in the usual orientation.
    """
    data = read_bytes(path)
    exposure = _check_header(path, data)
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        pixels = None
    if pixels is None or pixels.ndim != 3 or pixels.dtype != np.float32:
        raise ImageError(f"{path} is a damaged Radiance file. Copy it again.", reason="truncated")
    return np.ascontiguousarray(pixels[..., ::-1] / np.float32(exposure))


def _check_header(path: Path, data: bytes) -> float:
    """The product of the EXPOSURE lines of a header that this reader can take."""
    if not data.startswith((b"#?RADIANCE", b"#?RGBE")):
        raise ImageError(
            f"{path} is not a Radiance file (it begins with {data[:4].hex(' ') or 'nothing'}).",
            reason="not-an-image",
        )
    exposure = 1.0
    lines = data[:_HEADER_LIMIT].split(b"\n")
    for number, line in enumerate(lines):
        if line.startswith(b"EXPOSURE="):
            exposure *= float(line.partition(b"=")[2])
        if line.strip() == b"FORMAT=32-bit_rle_xyze":
            raise ImageError(
                f"{path} holds XYZ, not RGB. Convert it with Radiance's ra_xyze -r.",
                reason="wrong-color-model",
            )
        if not line.strip() and number + 1 < len(lines):
            resolution = _RESOLUTION.match(lines[number + 1].strip())
            if resolution is None:
                break
            if resolution[1] + resolution[3] != b"-Y+X":
                turned = (resolution[1] + b" " + resolution[3]).decode()
                raise ImageError(
                    f"{path} is stored in the orientation {turned}. "
                    "Save it again in the usual one, -Y +X.",
                    reason="wrong-orientation",
                )
            if not (np.isfinite(exposure) and exposure > 0):
                raise ImageError(
                    f"{path} has an EXPOSURE of {exposure}, which cannot be divided out.",
                    reason="bad-exposure",
                )
            return exposure
    raise ImageError(f"{path} is a damaged Radiance file: no size line.", reason="truncated")


def write_radiance(path: Path, radiance: NDArray[np.float32]) -> None:
    """Write radiance (H, W, 3) as RLE RGBE, atomically; about 1 % steps, never clipped."""
    _, data = cv2.imencode(".hdr", np.ascontiguousarray(radiance[..., ::-1]))
    write_bytes(path, bytes(data))
