"""The light that the background alone shows, extended to all directions."""

import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8
from panokit.evaluate.lighting.sample import StereoSample
from panokit.sphere import equirect_directions, resize_radiance
from panokit.sphere.blur import blur_radiance
from panokit.sphere.perspective import perspective_pixel

_WIDTH_PX = 128
# Sharpness of the blur beyond the picture, a spherical Gaussian of about 30 degrees: the farther
# from its edge, the less of it holds.
_KAPPA = 4.0
# What is guessed behind the camera lies halfway between the mirror image and the mean.
_FADE = 0.5


class BackgroundExtrapolation:
    """What the camera sees in front; behind it the same, mirrored; the rest blurred.

    The picture's edge columns and rows go on to the sides, above and below, blurred, and the half
    behind the camera is the mirror image of that in front, halfway to the picture's mean: what may
    be had without any learning.
    """

    name = "background, extended"
    digest = "background, extended 1"

    def predict(self, sample: StereoSample) -> NDArray[np.float32]:
        """(64, 64, 3)."""
        radiance = srgb_decode_u8(sample.views.background)
        directions = equirect_directions(_WIDTH_PX, _WIDTH_PX // 2)
        facing = np.array(directions)
        facing[..., 2] = -np.abs(facing[..., 2])
        height, width = radiance.shape[:2]
        # At right angles to the view nothing would be in front of the camera.
        facing[..., 2] = np.minimum(facing[..., 2], -1e-3)
        column, row, inside = perspective_pixel(facing, width, height, sample.views.fov_deg)
        seen = inside & (directions[..., 2] < 0)
        column = np.clip(np.rint(column), 0, width - 1).astype(int)
        row = np.clip(np.rint(row), 0, height - 1).astype(int)
        extended = radiance[row, column].astype(np.float32)
        blurred = blur_radiance(extended, _KAPPA)
        mean = radiance.reshape(-1, 3).mean(axis=0)
        guess = np.where(directions[..., 2:] < 0, blurred, _FADE * blurred + (1 - _FADE) * mean)
        whole = np.where(seen[..., None], extended, guess).astype(np.float32)
        return resize_radiance(whole, 64, 64)
