"""Radiance as text: every float rounded to 8 significant bits, predicted, deflated, base64.

A bfloat16 is the upper half of a float32: it keeps the whole range, so that no sun is too bright
for it, and is right to 1 in 256, finer than a step of an 8-bit picture. Read as an integer it is
nearly a logarithm: neighboring pixels differ by little however bright they are, and so do red and
blue from green. These differences deflate to about 15 bits a pixel on photographs.

The layout, for the reader in `codec.js`: planes green, red - green, blue - green; in each plane
every code less the one to its left (in the first column: above it), modulo 2^16; zigzag (0, -1, 1,
-2 ... as 0, 1, 2, 3 ...); all low bytes, then all high bytes; zlib; base64.
"""

import base64
import zlib

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

_LEVEL = 6
# The largest finite bfloat16.
_LARGEST = np.float32(3.3895314e38)


def encode_radiance(radiance: NDArray[np.float32]) -> str:
    """(H, W, 3) finite radiance, at least 0, as text.

    Raises:
        UsageError: If it is not three channels of such values.
    """
    radiance = np.asarray(radiance, np.float32)
    if radiance.ndim != 3 or radiance.shape[2] != 3 or not radiance.size:
        raise UsageError(f"Radiance in a page is (H, W, 3), not {radiance.shape}.")
    if not (np.isfinite(radiance).all() and radiance.min() >= 0):
        raise UsageError("Radiance in a page is finite and not negative. Repair the map first.")
    codes = _codes(radiance)
    planes = np.stack([codes[..., 1], codes[..., 0] - codes[..., 1], codes[..., 2] - codes[..., 1]])
    steps = planes.copy()
    steps[:, :, 1:] -= planes[:, :, :-1]
    steps[:, 1:, 0] -= planes[:, :-1, 0]
    signed = steps.view(np.int16)
    zigzag = ((signed << 1) ^ (signed >> 15)).view(np.uint16)
    low, high = (zigzag & 0xFF).astype(np.uint8), (zigzag >> 8).astype(np.uint8)
    packed = zlib.compress(low.tobytes() + high.tobytes(), _LEVEL)
    return base64.b64encode(packed).decode()


def decode_radiance(text: str, width_px: int, height_px: int) -> NDArray[np.float32]:
    """What `encode_radiance` wrote, as the page's script reads it; (H, W, 3) float32."""
    data = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8)
    low, high = data.reshape(2, 3, height_px, width_px).astype(np.uint16)
    zigzag = low | (high << 8)
    steps = (zigzag >> 1) ^ (0 - (zigzag & 1))
    steps[:, :, 0] = np.cumsum(steps[:, :, 0], axis=1, dtype=np.uint16)
    planes = np.cumsum(steps, axis=2, dtype=np.uint16)
    codes = np.stack([planes[1] + planes[0], planes[0], planes[2] + planes[0]], axis=-1)
    return (codes.astype(np.uint32) << 16).view(np.float32)


def _codes(radiance: NDArray[np.float32]) -> NDArray[np.uint16]:
    """The nearest bfloat16, ties to even, as its bits."""
    bits = np.minimum(radiance, _LARGEST).view(np.uint32)
    return ((bits + 0x7FFF + ((bits >> 16) & 1)) >> 16).astype(np.uint16)
