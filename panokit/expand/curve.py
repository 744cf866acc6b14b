"""A camera's response, estimated: a smooth change of the sRGB curve with two slopes.

With u the log of the sRGB-decoded value, the log of the light is
a u + (a - b) c (1 - exp(u / c)): its slope is `a` in the dark and `b` at white, it rises
everywhere, and white stays white. a = b = 1 is sRGB itself. For the sigmoid curves of camera
B its error is 0.016 in the log.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8

BEND = 0.7
# The lowest decoded value whose log is taken; 1/255 in the encoded picture is 3e-4.
DARKEST = 1e-4


def apply_curve(
    linear: NDArray[np.float32], dark_slope: float, white_slope: float
) -> NDArray[np.float32]:
    """sRGB-decoded values in [0, 1] to the light behind them, in [0, 1]; any shape."""
    log_value = np.log(np.maximum(linear, DARKEST))
    bend = (dark_slope - white_slope) * BEND
    log_light = dark_slope * log_value + bend * (1 - np.exp(log_value / BEND))
    return np.asarray(np.where(linear > 0, np.exp(log_light), 0), np.float32)


def decode_table(dark_slope: float, white_slope: float) -> NDArray[np.float32]:
    """The light behind each 8-bit code, (256,) float32."""
    codes = np.arange(256, dtype=np.uint8)
    return apply_curve(srgb_decode_u8(codes), dark_slope, white_slope)
