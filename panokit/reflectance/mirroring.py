"""The same views in a mirror, and how far two readings of the light are apart.

A scene in a mirror is another scene, with the mirror image of its light. A network that is asked
about both tells how sure it can be: where its two answers, one of them mirrored back, differ, at
least one of them is wrong.
"""

from dataclasses import replace
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.frames import Rotation, angle_between
from panokit.reflectance.light_network import LightNetwork
from panokit.sphere import light_vector
from panokit.stereo import Views

Map = NDArray[np.float32]
_Number = TypeVar("_Number", bound=np.generic)
# Below a thousandth of the pictures' white, twice as dark is no worse an answer.
DARKEST = 1e-3
# Standard deviation, in pixels of a 64x64 map.
_BLUR_PX = 1.5
_MIRROR = np.diag([-1.0, 1.0, 1.0])
_TURNED = np.array([-1, 1, 1], np.float32)


def mirrored_views(views: Views, *, exchange: bool = True) -> Views:
    """The views as a mirror between left and right shows them.

    Args:
        views: Of parallel cameras.
        exchange: In a mirror the right camera is the left one. Normals, and what belongs to the
            left view alone, are then not known any more: the mask is that of the object's
            pixels. Without it each view stays what it is, for methods that look at one.
    """
    level = Rotation(_MIRROR @ views.left_level.matrix @ _MIRROR)
    background = _flipped(views.background)
    if not exchange:
        return replace(
            views,
            left=_flipped(views.left), right=_flipped(views.right),
            left_object=_flipped(views.left_object), right_object=_flipped(views.right_object),
            mask=_flipped(views.mask), parts=_flipped(views.parts), background=background,
            normals=_flipped(views.normals) * _TURNED, left_level=level,
        )  # fmt: skip
    mask = np.asarray(_flipped(views.right_object).any(axis=-1))
    return replace(
        views,
        left=_flipped(views.right), right=_flipped(views.left),
        left_object=_flipped(views.right_object), right_object=_flipped(views.left_object),
        mask=mask, parts=mask.astype(np.uint8), background=background,
        normals=np.zeros_like(views.normals), left_level=level,
    )  # fmt: skip


def mirrored_map(radiance: Map) -> Map:
    """A map (H, W, C), forward at its center, as a mirror between left and right shows it."""
    return np.ascontiguousarray(radiance[:, ::-1])


def read_twice(network: LightNetwork, views: Views) -> tuple[Map, Map]:
    """What a network reads of views, and of their mirror image, mirrored back; (64, 64, 3) each.

    One run of the network with a batch of two.
    """
    other = mirrored_views(views, exchange=network.sees_both)
    plain, seen_in_mirror = network.read_all([views, other])
    return plain, mirrored_map(seen_in_mirror)


def log_difference(one: Map, other: Map) -> NDArray[np.float32]:
    """How far two maps are apart in each direction: the mean |log| of ratios, (H, W) float32.

    0.7 is a factor of two. Averaged over a few pixels, as one alone says little.
    """
    logs = [np.log(np.maximum(radiance, DARKEST)) for radiance in (one, other)]
    apart = np.abs(logs[0] - logs[1]).mean(axis=-1).astype(np.float32)
    # The map is closed in azimuth: as much of the other side as the blur reaches.
    margin = int(4 * _BLUR_PX)
    wide = np.concatenate([apart[:, -margin:], apart, apart[:, :margin]], axis=1)
    blurred = cv2.GaussianBlur(wide, (0, 0), _BLUR_PX, borderType=cv2.BORDER_REPLICATE)
    return np.ascontiguousarray(blurred[:, margin:-margin])


def direction_difference_deg(one: Map, other: Map) -> float:
    """The angle between where the light of two maps comes from, as light vectors; 90 if unknown."""
    vectors = [light_vector(radiance) for radiance in (one, other)]
    if any(np.linalg.norm(vector) == 0 for vector in vectors):
        return 90.0
    return float(np.degrees(angle_between(*vectors)))


def _flipped(picture: NDArray[_Number]) -> NDArray[_Number]:
    return np.ascontiguousarray(picture[:, ::-1])
