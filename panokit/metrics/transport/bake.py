"""Make the tables that ship with panokit.

python -m panokit.metrics.transport.bake [FOLDER]
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.metrics.transport.scenes import ROUGH_BALLS, RoughBall

_AZIMUTHS = 512
_LEVELS = 4000


def ball_kernel(ball: RoughBall, radii: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fourier coefficients of a ball's response for some normals.

    The normal stands `radii` from the view axis, light at the rings' places; the response is
    sampled at 512 azimuths of a half turn, enough that no lobe of the scenes aliases.

    Args:
        ball: What it is made of.
        radii: (R,) angle between normal and view, radians, 0 to pi / 2.

    Returns:
        (orders, R, rings): the mean over azimuth of response x cos(m azimuth).
    """
    polar = ((np.arange(ball.rings) + 0.5) / ball.rings * np.pi)[:, None]
    azimuth = (np.arange(_AZIMUTHS) + 0.5) / _AZIMUTHS * np.pi
    waves = np.cos(np.arange(ball.orders)[:, None] * azimuth) / _AZIMUTHS
    kernel = np.empty((ball.orders, len(radii), ball.rings))
    for index, tilt in enumerate(radii):
        light = np.sin(tilt) * np.sin(polar) * np.cos(azimuth) + np.cos(tilt) * np.cos(polar)
        view = np.full_like(light, np.cos(tilt))
        between = np.cos(polar) + 0 * azimuth
        kernel[:, index] = waves @ ball.response(view, light, between).T
    return kernel


def ball_radii(ball: RoughBall) -> NDArray[np.float64]:
    """The angles between normal and view in a ball's table, from the middle to the rim."""
    return np.linspace(0, np.pi / 2, ball.radii)


def packed(kernel: NDArray[np.float64]) -> dict[str, Any]:
    """A kernel in whole units, four thousand to its greatest value, as differences along rings."""
    unit = np.abs(kernel).max() / _LEVELS
    whole = np.rint(kernel / unit).astype(np.int16)
    return {"steps": np.diff(whole, axis=2, prepend=np.int16(0)), "unit": unit}


def bake(folder: Path) -> None:
    """Write every table."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, ball in ROUGH_BALLS.items():
        np.savez_compressed(folder / f"{name}.npz", **packed(ball_kernel(ball, ball_radii(ball))))


if __name__ == "__main__":
    bake(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "tables")
