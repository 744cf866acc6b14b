"""Which regions of a map are lights: one region for a sun, a window, a lamp, none for a sky.

The map is cut at a ladder of levels, half a stop apart. The regions above each level form a
tree: a region splits into smaller ones as the level rises. Along each branch the light is the
region with the largest E / A^(1/4), its energy over the fourth root of its solid angle. Growing
a region raises that as long as its rim is brighter than a quarter of its mean, so a light ends
where it has fallen to a quarter: a sun without its glow, a window up to its frame.
"""

from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.sphere.equirect import equirect_directions
from panokit.sphere.solid_angle import pixel_solid_angles
from panokit.sphere.sources import label_regions

# The rim of a region may be this bright, relative to its mean: the exponent of A.
_RIM = 0.25
# A region whose rim is brighter than this, relative to its mean, is a part of something larger.
_DISTINCT = 0.5
# The lowest level over the mean of what is no light.
_ABOVE_AMBIENT = 2.0
_STEP = 2**0.5
# A region must rise this many levels above the split to count as one of its own.
_PROMINENCE = 2
# Dark bars narrower than this, such as glazing bars, do not cut a window into panes.
_BAR_DEG = 1.5
# The least length of the mean direction of a light, weighted by its energy: 1 for a point, 0.9
# for a disk of 37 degrees radius. A long band of twilight is no light.
_CONCENTRATION = 0.9


@dataclass(slots=True, kw_only=True)
class _Node:
    """One region of one level."""

    level: int
    label: int
    energy: float
    area: float
    concentration: float
    top: int
    children: list["_Node"] = field(default_factory=list)


@dataclass(slots=True, kw_only=True)
class _Choice:
    """The regions chosen below a node, with their energy and area together."""

    nodes: list[_Node]
    energy: float = 0.0
    area: float = 0.0

    @property
    def score(self) -> float:
        return self.energy / self.area**_RIM if self.area else 0.0


def find_light_regions(
    luminance: NDArray[np.floating[Any]], *, least_share: float, largest_sr: float
) -> NDArray[np.int32]:
    """Number the lights of a map, also across the seam and over the poles.

    Args:
        luminance: (H, W), equirectangular, at least 0.
        least_share: A light gives at least this share of all light.
        largest_sr: A light covers at most this solid angle.

    Returns:
        (H, W) int32: 0 outside, 1..n in the lights, in no order.
    """
    height, width = luminance.shape
    weights = pixel_solid_angles(height, width)
    parcels = luminance * weights
    least_energy = least_share * float(parcels.sum())
    base = _ABOVE_AMBIENT * _ambient_level(luminance, weights)
    found = np.zeros(luminance.shape, np.int32)
    if base <= 0 and not luminance.any():
        return found
    # In total darkness but for lamps, anything above nothing is a lamp.
    base = max(base, float(luminance.max()) * 2.0**-24)
    count = max(int(np.ceil(np.log(float(luminance.max()) / base) / np.log(_STEP))), 0)
    levels = base * _STEP ** np.arange(count)
    roots, labels = _tree(_without_bars(luminance), parcels, levels, least_energy)
    number = 0
    for root in roots:
        for node in _choose(root, levels, largest_sr).nodes:
            number += 1
            found[labels[node.level] == node.label] = number
    return found


def _ambient_level(luminance: NDArray[Any], weights: NDArray[Any]) -> float:
    """The mean over the sphere, with all that is over four times the mean cut to that."""
    level = float((luminance * weights).sum() / weights.sum())
    for _ in range(12):
        level = float((np.minimum(luminance, 4 * level) * weights).sum() / weights.sum())
    return level


def _without_bars(luminance: NDArray[Any]) -> NDArray[np.float32]:
    """The luminance with narrow dark gaps filled, by a closing that wraps round the seam."""
    width = luminance.shape[1]
    size = 2 * round(width * _BAR_DEG / 720) + 1
    pad = min(size, width)
    wrapped = np.concatenate(
        [luminance[:, width - pad :], luminance, luminance[:, :pad]], axis=1, dtype=np.float32
    )
    disk = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    closed = cv2.morphologyEx(wrapped, cv2.MORPH_CLOSE, disk, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(closed[:, pad : pad + width], np.float32)


def _tree(
    luminance: NDArray[Any], parcels: NDArray[Any], levels: NDArray[Any], least_energy: float
) -> tuple[list[_Node], list[NDArray[np.int32]]]:
    """The regions above the first level, with those above higher ones inside; and the labels.

    Regions with less than the least energy can hold no light and are left out.
    """
    height, width = luminance.shape
    weights = pixel_solid_angles(height, width)
    directions = equirect_directions(width, height)
    highest = np.searchsorted(levels, luminance, side="right") - 1
    roots: list[_Node] = []
    below: dict[int, _Node] = {}
    pictures: list[NDArray[np.int32]] = []
    for level, threshold in enumerate(levels):
        labels, count = label_regions(luminance >= threshold)
        inside = labels > 0
        numbers, light = labels[inside], parcels[inside]
        energies = np.bincount(numbers, light, count + 1)
        areas = np.bincount(numbers, weights[inside], count + 1)
        along = [np.bincount(numbers, light * directions[inside, i], count + 1) for i in range(3)]
        lengths = np.linalg.norm(along, axis=0) / np.maximum(energies, 1e-300)
        tops = np.zeros(count + 1, np.int64)
        np.maximum.at(tops, numbers, highest[inside])
        nodes = {
            k: _Node(
                level=level,
                label=k,
                energy=float(energies[k]),
                area=float(areas[k]),
                concentration=float(lengths[k]),
                top=int(tops[k]),
            )
            for k in np.flatnonzero(energies >= least_energy).tolist()
            if k
        }
        if level == 0:
            roots = list(nodes.values())
        else:
            parents = np.zeros(count + 1, np.int64)
            parents[numbers] = pictures[-1][inside]
            for node in nodes.values():
                # What lies round a region has at least its energy, so it was kept too.
                below[int(parents[node.label])].children.append(node)
        below = nodes
        pictures.append(labels)
    return roots, pictures


def _choose(start: _Node, levels: NDArray[Any], largest_sr: float) -> _Choice:
    """The lights in a branch: one of its regions, or those of the branches it splits into."""
    best = _Choice(nodes=[])
    node = start
    while True:
        mean = node.energy / node.area
        compact = node.area <= largest_sr and node.concentration >= _CONCENTRATION
        distinct = levels[node.level] <= _DISTINCT * mean
        if compact and distinct:
            here = _Choice(nodes=[node], energy=node.energy, area=node.area)
            best = max(best, here, key=lambda choice: choice.score)
        parts = node.children
        distinct_parts = [part for part in parts if part.top >= node.level + _PROMINENCE]
        if len(distinct_parts) > 1:
            break
        if not parts:
            return best
        node = max(parts, key=lambda child: child.energy)
    chosen = [_choose(part, levels, largest_sr) for part in distinct_parts]
    split = _Choice(
        nodes=[node for choice in chosen for node in choice.nodes],
        energy=sum(choice.energy for choice in chosen),
        area=sum(choice.area for choice in chosen),
    )
    return max(best, split, key=lambda choice: choice.score)
