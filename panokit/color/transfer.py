"""The sRGB transfer curve (IEC 61966-2-1), both ways."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

_LINEAR_END = 0.0031308
_ENCODED_END = 0.04045


def srgb_encode(linear: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """Linear values to display-encoded ones; [0, 1] maps onto [0, 1], other values are clipped.

    Args:
        linear: Any shape, linear Rec.709.

    Returns:
        float32 of the same shape.
    """
    clipped = np.clip(np.asarray(linear, np.float32), 0, 1)
    curve = 1.055 * np.power(clipped, np.float32(1 / 2.4)) - 0.055
    return np.where(clipped <= _LINEAR_END, 12.92 * clipped, curve).astype(np.float32, copy=False)


def srgb_decode(encoded: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """Display-encoded values in [0, 1] to linear ones, float32 of the same shape."""
    values = np.asarray(encoded, np.float32)
    if values.size and (float(values.min()) < 0 or float(values.max()) > 1):
        raise UsageError("Encoded values lie in [0, 1]; divide 8-bit values by 255 first.")
    curve = np.power((values + 0.055) / np.float32(1.055), np.float32(2.4))
    return np.where(values <= _ENCODED_END, values / 12.92, curve).astype(np.float32, copy=False)


@lru_cache(maxsize=1)
def _decode_table() -> NDArray[np.float32]:
    return srgb_decode(np.arange(256, dtype=np.float32) / 255)


def srgb_decode_u8(pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
    """8-bit display-encoded values to linear ones in [0, 1], by table; 255 becomes 1."""
    if pixels.dtype != np.uint8:
        raise UsageError(f"Expected uint8 pixels, not {pixels.dtype}.")
    return _decode_table()[pixels]


def srgb_encode_u8(linear: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """Linear values to 8-bit display-encoded ones, rounded to nearest; clipped to [0, 1]."""
    return np.rint(srgb_encode(linear) * 255).astype(np.uint8)
