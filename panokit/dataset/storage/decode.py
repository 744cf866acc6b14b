"""The files of a sample as arrays."""

import io
import json
from typing import Any

import cv2
import numpy as np
import OpenEXR
from numpy.typing import NDArray

from panokit.errors import ImageError, RecordError


def decode_member(name: str, data: bytes) -> Any:
    """What a member of a sample holds.

    Args:
        name: Of the member: its ending decides.
        data: Its bytes.

    Returns:
        Of .png (H, W, 3) uint8 RGB or (H, W) uint8; of .exr (H, W, 3) or (H, W) float32; of
        .json what the JSON says; of anything else the bytes.

    Raises:
        ImageError: If a picture is damaged.
        RecordError: If the JSON is.
    """
    if name.endswith(".png"):
        return decode_png(data, name)
    if name.endswith(".exr"):
        return decode_exr(data, name)
    if name.endswith(".json"):
        try:
            return json.loads(data)
        except ValueError as error:
            raise RecordError(f"{name} is damaged ({error}).", reason="damaged-record") from error
    return data


def decode_png(data: bytes, name: str = "A picture") -> NDArray[np.uint8]:
    """The pixels of a PNG: (H, W, 3) uint8 RGB, or (H, W) uint8 if it is gray.

    Raises:
        ImageError: If it is damaged, or holds anything else.
    """
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        pixels = None
    if pixels is None:
        raise ImageError(f"{name} is damaged.", reason="truncated")
    if pixels.dtype != np.uint8 or (pixels.ndim == 3 and pixels.shape[2] != 3):
        raise ImageError(f"{name} is neither 8-bit gray nor RGB.", reason="wrong-color-model")
    if pixels.ndim == 3:
        # cv2 orders blue, green, red.
        pixels = cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB)
    return np.asarray(pixels, np.uint8)


def decode_exr(data: bytes, name: str = "A picture") -> NDArray[np.float32]:
    """The values of an EXR: (H, W, 3) float32 of channels R, G, B, or (H, W) of one channel.

    This is for the EXR files of samples, which are written by panokit and small; maps of any
    origin are read by `panokit.io.read_exr`.

    Raises:
        ImageError: If it is damaged, or has other channels.
    """
    try:
        with OpenEXR.File(io.BytesIO(data), num_threads=0) as file:
            channels = file.channels()
            names = list(channels)
            if names not in (["RGB"], ["Z"], ["Y"]):
                raise ImageError(f"{name} has channels {names}.", reason="wrong-channels")
            pixels = np.asarray(channels[names[0]].pixels, np.float32)
    except ImageError:
        raise
    except Exception as error:  # the package raises bare RuntimeError and ValueError
        raise ImageError(f"{name} is damaged ({error}).", reason="truncated") from error
    return pixels
