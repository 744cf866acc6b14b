"""How light becomes picture values, and back.

transfer   the sRGB curve, exact both ways
luminance  Rec.709 luminance, and its statistics over the sphere
tonemap    pictures of HDR maps for people to look at
camera     LDR pictures from HDR maps: the camera presets A, B and STREET
development  what happens to light within a camera: noise, clipping, local toning
response   the curves of cameras
temperature  chromaticity, and how warm or cool a light is
"""

from panokit.color.luminance import luminance, weighted_percentile
from panokit.color.temperature import ColorTemperature, chromaticity, color_temperature
from panokit.color.tonemap import bracket, tonemap
from panokit.color.transfer import srgb_decode, srgb_decode_u8, srgb_encode, srgb_encode_u8

__all__ = [
    "ColorTemperature",
    "bracket",
    "chromaticity",
    "color_temperature",
    "luminance",
    "srgb_decode",
    "srgb_decode_u8",
    "srgb_encode",
    "srgb_encode_u8",
    "tonemap",
    "weighted_percentile",
]
