"""Linear RGB of other primaries, and XYZ, as linear Rec.709.

A file that names its primaries says which colors its R, G and B are; read as Rec.709 without
conversion, an ACEScg map lights a scene too dull. White stays white: where the file's white is
not D65, the Bradford transform adapts it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError

# x and y of red, green, blue and white.
REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)

# Cone responses of the Bradford transform (Lam 1985; as in the ICC profile specification).
_BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)


def xyz_from_rgb(primaries: Sequence[float]) -> NDArray[np.float64]:
    """The matrix (3, 3) that turns linear RGB of these primaries into XYZ, white at Y = 1.

    Args:
        primaries: x and y of red, green, blue and white, eight numbers.

    Raises:
        UsageError: If they are not eight finite numbers that span a color space.
    """
    xy = np.asarray(primaries, np.float64)
    if xy.shape != (8,) or not np.all(np.isfinite(xy)):
        raise UsageError(f"Primaries are eight numbers, x and y of R, G, B and white, not {xy}.")
    xy = xy.reshape(4, 2)
    columns = np.stack([xy[:, 0], xy[:, 1], 1 - xy.sum(axis=1)])
    if xy[3, 1] <= 0 or abs(np.linalg.det(columns[:, :3])) < 1e-6:
        raise UsageError(f"The primaries {xy.ravel().tolist()} do not span a color space.")
    white = columns[:, 3] / xy[3, 1]
    # SMPTE RP 177: scale the primaries so that they add up to white.
    return np.asarray(columns[:, :3] * np.linalg.solve(columns[:, :3], white))


def rec709_from_rgb(primaries: Sequence[float]) -> NDArray[np.float64] | None:
    """The matrix (3, 3) from linear RGB of these primaries to Rec.709; None where it is the same.

    Primaries are stored rounded; a difference below 0.002 is taken for rounding.

    Raises:
        UsageError: If the primaries do not span a color space.
    """
    source = xyz_from_rgb(primaries)
    if np.allclose(primaries, REC709, atol=2e-3):
        return None
    target = xyz_from_rgb(REC709)
    cones_source = _BRADFORD @ source.sum(axis=1)
    cones_target = _BRADFORD @ target.sum(axis=1)
    adapt = np.linalg.solve(_BRADFORD, np.diag(cones_target / cones_source) @ _BRADFORD)
    return np.asarray(np.linalg.solve(target, adapt @ source))


def luminance_weights(primaries: Sequence[float]) -> NDArray[np.float64]:
    """How much R, G and B of these primaries add to luminance; they sum to 1."""
    return np.asarray(xyz_from_rgb(primaries)[1])
