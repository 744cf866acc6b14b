"""The Frechet distance between two sets of panoramas, from features that you bring.

EnvMapNet (Somanath and Kurz 2021; apple/ml-envmapnet, FIDCalculations.py) judges sets of
predicted maps by FID: tone-mapped panoramas are cut into cube faces, the four side faces go
through ImageNet's InceptionV3, and the pooled 2048 numbers of both sets are compared as if they
were Gaussian (Heusel et al. 2017): d^2 = |m1 - m2|^2 + tr(C1 + C2 - 2 (C1 C2)^(1/2)).

panokit has no Inception network: `side_faces` prepares its input, any framework computes the
features, `frechet_distance` compares them. It tells whether *sets* look alike: whether generated
probes look like captured ones, say. It tells nothing of one map, it is blind to the sun (the
pictures are clipped), it needs thousands of maps (with fewer than 2048 faces the covariances
are singular and the distance is biased upward), and it means nothing for 64x64 maps, which fill
a face of 299 pixels with 16.
"""

from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import sqrtm

from panokit.errors import ImageError, UsageError
from panokit.frames import Rotation
from panokit.sphere.cubemap import FACES, cubemap_directions
from panokit.sphere.sampling import sample

Variant = Literal["compat", "fixed"]

FACE_PX = 299
SIDES = ("front", "right", "back", "left")
_MIRRORED = {"right", "back"}


def side_faces(
    panorama: NDArray[Any], variant: Variant = "fixed", *, size_px: int = FACE_PX
) -> NDArray[np.float32]:
    """The four side faces of a tone-mapped panorama, as InceptionV3 takes them.

    "compat" repeats what the published code gets from py360convert as it was then: the right and
    the back face are mirror images, the first and last pixels of a face lie on its edges, and a
    large panorama is sampled without averaging. Both sets being treated alike, the distance
    changes little; figures in a table must still be of one variant.

    Args:
        panorama: (H, W, 3), 2:1, display-encoded: uint8, or floating point in [0, 1].
        variant: "compat" or "fixed".
        size_px: Width of a face.

    Returns:
        (4, size, size, 3) float32 in [-1, 1]: front, right, back, left.

    Raises:
        UsageError: If the variant is not known or a face has fewer than 2 pixels.
        ImageError: If it is not a display-encoded panorama.
    """
    _check_variant(variant)
    if size_px < 2:
        raise UsageError(f"A face is at least 2 pixels wide, not {size_px}.")
    picture = _display_values(np.asarray(panorama))
    if variant == "compat":
        faces = [sample(picture, _edge_to_edge(side, size_px)) for side in SIDES]
        faces = [
            face[:, ::-1] if side in _MIRRORED else face
            for side, face in zip(SIDES, faces, strict=True)
        ]
    else:
        if picture.shape[1] > 4 * size_px:
            size = (4 * size_px, 2 * size_px)
            picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))
        faces = [sample(picture, cubemap_directions(size_px, side)) for side in SIDES]
    return np.asarray(np.stack(faces) * 2 - 1, np.float32)


def frechet_distance(
    features: NDArray[np.floating[Any]],
    others: NDArray[np.floating[Any]],
    variant: Variant = "fixed",
) -> float:
    """The squared Frechet distance between Gaussians fitted to two sets; 0 for equal sets.

    "compat" takes the square root of the product of the covariances as a general matrix, whose
    rounding errors leave an imaginary part that is thrown away, and can come out below zero.
    "fixed" takes it as symmetric, (C1^(1/2) C2 C1^(1/2))^(1/2), in float64: real and stable.

    Args:
        features: (n, d), one row for each picture.
        others: (m, d).
        variant: "compat" or "fixed".

    Raises:
        UsageError: If the variant is not known, or sets do not fit together, or hold fewer than
            two rows or values that are not finite.
    """
    _check_variant(variant)
    a, b = (_features(given, variant) for given in (features, others))
    if a.ndim != 2 or b.ndim != 2 or a.shape[1] != b.shape[1] or min(len(a), len(b)) < 2:
        raise UsageError(
            f"Features are (n, d) with two or more rows and one d, not {a.shape} and {b.shape}."
        )
    if not np.isfinite(a).all() or not np.isfinite(b).all():
        raise UsageError("Features are finite numbers; some are not.")
    means = float(np.square(a.mean(axis=0) - b.mean(axis=0)).sum())
    spread, other_spread = (_covariance(x) for x in (a, b))
    if variant == "compat":
        root = sqrtm(spread @ other_spread)
        return float(np.real(means + np.trace(spread + other_spread - 2 * root)))
    half = _symmetric_root(spread)
    values = np.linalg.eigvalsh(half @ other_spread @ half)
    shared = float(np.sqrt(np.maximum(values, 0)).sum())
    return max(means + float(np.trace(spread) + np.trace(other_spread)) - 2 * shared, 0.0)


def _features(given: NDArray[Any], variant: Variant) -> NDArray[np.floating[Any]]:
    return np.asarray(given, np.float32 if variant == "compat" else np.float64)


def _covariance(features: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    return np.atleast_2d(np.asarray(np.cov(features, rowvar=False), np.float64))


def _display_values(panorama: NDArray[Any]) -> NDArray[np.float32]:
    if panorama.ndim != 3 or panorama.shape[2] != 3 or panorama.shape[1] != 2 * panorama.shape[0]:
        raise ImageError(
            f"A panorama to cut into faces is (H, 2 H, 3), not {panorama.shape}.",
            reason="not-equirectangular",
        )
    scale = 255 if panorama.dtype == np.uint8 else 1
    picture = np.asarray(panorama, np.float32) / np.float32(scale)
    if not np.isfinite(picture).all() or picture.min() < 0 or picture.max() > 1:
        raise ImageError(
            "Faces are cut from display-encoded values: uint8, or [0, 1]. Tone-map the map first, "
            "with panokit.color.srgb_encode.",
            reason="not-tonemapped",
        )
    return picture


def _edge_to_edge(side: str, size_px: int) -> NDArray[np.float32]:
    """Directions of a face whose outer pixels' centers lie on its edges."""
    across = np.linspace(-1, 1, size_px)
    directions = np.empty((size_px, size_px, 3))
    directions[..., 0], directions[..., 1], directions[..., 2] = across, -across[:, None], -1.0
    facing: Rotation = FACES[side]
    return np.asarray(facing.apply(directions), np.float32)


def _symmetric_root(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray((vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T)


def _check_variant(variant: str) -> None:
    if variant not in ("compat", "fixed"):
        raise UsageError(f"The variant is 'compat' or 'fixed', not {variant!r}.")
