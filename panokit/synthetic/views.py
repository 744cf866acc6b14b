"""Pinhole views into a served picture, as the services that send views make them."""

import math

import numpy as np
from numpy.typing import NDArray

from panokit.frames import Rotation
from panokit.sphere import perspective_view
from panokit.synthetic.pictures import PictureStore, ServedPicture


def view_of(
    store: PictureStore,
    picture: ServedPicture,
    size_px: tuple[int, int],
    *,
    heading_deg: float,
    pitch_deg: float,
    fov_deg: float,
) -> NDArray[np.uint8]:
    """What a level camera with these angles sees, whatever the tilt of the picture.

    Args:
        store: Has the pixels.
        picture: To look at.
        size_px: Width and height of the view.
        heading_deg: A compass direction.
        pitch_deg: Positive looks up.
        fov_deg: From the left edge to the right edge.
    """
    pixels = store.pixels(picture, round(size_px[0] * 360 / fov_deg))
    world_from_view = Rotation.from_heading_pitch_roll(
        math.radians(heading_deg), math.radians(pitch_deg)
    )
    world_from_picture = picture.capture.world_from_camera or Rotation.identity()
    pose = world_from_picture.inverse @ world_from_view
    return np.asarray(perspective_view(pixels, *size_px, fov_deg, pose), np.uint8)
