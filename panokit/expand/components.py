"""The burnt-out components of a panorama: one lamp, window, sun or sky each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.expand.reduce import ReducedPanorama
from panokit.sphere import label_regions, row_solid_angles
from panokit.sphere.distance import pixel_distance
from panokit.sphere.extension import pad_sphere

# Only the largest components are described and scaled one by one.
MOST_COMPONENTS = 12
# A pixel of which less than this is burnt out is no part of a component. Low on purpose: the
# rim of a sun belongs to the sun, or it would keep a gain of its own and glow.
LEAST_SHARE = 0.01
# Distances to the edge are measured up to here; beyond it a component is wide.
WIDEST_DEG = 20.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Components:
    """The largest burnt-out components, largest first.

    Attributes:
        labels: (H, W) int32: 0 outside, k + 1 in component k; the smaller rest is 0 too.
        edge_deg: (H, W) float32, how far inside the mask a pixel is, at most `WIDEST_DEG`.
        solid_angle: (K,) float64, in steradians.
        energy: (K,) float64, luminance x solid angle as the LDR picture shows it.
    """

    labels: NDArray[np.int32]
    edge_deg: NDArray[np.float32]
    solid_angle: NDArray[np.float64]
    energy: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.solid_angle)


def find_components(reduced: ReducedPanorama) -> Components:
    """The components of a reduced panorama, by solid angle, at most `MOST_COMPONENTS`."""
    mask = reduced.share >= LEAST_SHARE
    found, count = label_regions(mask)
    height, width = mask.shape
    weights = row_solid_angles(height, width)[:, None] * reduced.share
    sizes = np.bincount(found.ravel(), weights.ravel(), count + 1)
    sizes[0] = 0
    largest = np.argsort(-sizes, kind="stable")[: min(count, MOST_COMPONENTS)]
    renumber = np.zeros(count + 1, np.int32)
    renumber[largest] = np.arange(1, len(largest) + 1)
    labels = renumber[found]
    light = luminance(reduced.burnt) * row_solid_angles(height, width)[:, None]
    energies = np.bincount(labels.ravel(), light.ravel(), len(largest) + 1)
    return Components(
        labels=labels,
        edge_deg=_edge_distance(mask),
        solid_angle=np.asarray(sizes[largest], np.float64),
        energy=np.asarray(energies[1:], np.float64),
    )


def sum_by_component(values: NDArray[np.floating], components: Components) -> NDArray[np.float64]:
    """The sum of a map (H, W) within each component, (K,) float64."""
    sums = np.bincount(components.labels.ravel(), values.ravel(), len(components) + 1)
    return np.asarray(sums[1:], np.float64)


def _edge_distance(mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    height = len(mask)
    pixel_deg = 180 / height
    pad = min(int(np.ceil(WIDEST_DEG / pixel_deg)) + 1, height)
    padded = pad_sphere(mask.astype(np.uint8), pad)
    distance = pixel_distance(padded)[pad:-pad, pad:-pad]
    return np.minimum(distance * np.float32(pixel_deg), WIDEST_DEG)
