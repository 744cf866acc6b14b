"""Which photographs are nearly side by side."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from panokit.evaluate.real.scenes import RealScene, RealView
from panokit.evaluate.real.settings import PairSettings
from panokit.frames import angle_between


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RealPair:
    """Two photographs nearly side by side.

    Attributes:
        left: The left one.
        right: The right one.
        rotation_deg: By which one camera is turned against the other.
        off_axis_deg: Between the line that joins the cameras and the left camera's right.
        over_depth: The distance between the cameras over that to the object.
    """

    left: RealView
    right: RealView
    rotation_deg: float
    off_axis_deg: float
    over_depth: float


def find_pairs(scene: RealScene, settings: PairSettings) -> list[RealPair]:
    """For each view the best partner to its right, best pairs first; no two views pair twice.

    The best has a distance nearest to `wanted_over_depth`, in the log, and of those the one that
    is turned least.
    """
    found = []
    for left in scene.views:
        partners = list(_partners(scene, left, settings))
        if partners:
            found.append(min(partners, key=lambda pair: _cost(pair, settings)))
    found.sort(key=lambda pair: (_cost(pair, settings), pair.left.name, pair.right.name))
    return found[: settings.per_scene or None]


def _partners(scene: RealScene, left: RealView, settings: PairSettings) -> Iterator[RealPair]:
    low, high = settings.baseline_over_depth
    inverse = left.world_from_camera.inverse
    depth = float(np.linalg.norm(scene.center - left.position))
    for right in scene.views:
        between = right.position - left.position
        distance = float(np.linalg.norm(between))
        if right is left or distance == 0 or not low <= distance / depth <= high:
            continue
        rotation = float(np.degrees((inverse @ right.world_from_camera).angle))
        off_axis = max(
            float(np.degrees(angle_between(view.world_from_camera.matrix[:, 0], between)))
            for view in (left, right)
        )
        if rotation <= settings.rotation_deg and off_axis <= settings.off_axis_deg:
            yield RealPair(
                left=left, right=right, rotation_deg=rotation, off_axis_deg=off_axis,
                over_depth=distance / depth,
            )  # fmt: skip


def _cost(pair: RealPair, settings: PairSettings) -> float:
    ratio = abs(float(np.log2(pair.over_depth / settings.wanted_over_depth)))
    return ratio + pair.rotation_deg / 45 + pair.off_axis_deg / 45
