"""Make the tables that ship with panokit.

python -m panokit.metrics.transport.bake [FOLDER]
"""

import lzma
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.metrics.transport.figure import Hits, hidden, see
from panokit.metrics.transport.plane import Patches, grid_directions, patches
from panokit.metrics.transport.scenes import ROUGH_BALLS, RoughBall

_AZIMUTHS = 512
_LEVELS = 3000
_LEAST_EXPONENT = 14
_SIZE_PX = 64
_RAYS = 4
_COLUMNS = 320
_ROWS = 80
_UNIT = 16
_MOST = 3


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
    """A kernel in whole units, (radii, rings, orders), compressed.

    The unit is a power of two for each pair of a normal and a ring of light: far from a lobe the
    response is thousands of times less than in it, and under a sun its errors would show.
    """
    greatest = np.abs(kernel).max(axis=0)
    exponent = np.ceil(np.log2(np.maximum(greatest, 1e-12) / _LEVELS))
    exponent = np.maximum(exponent, exponent.max() - _LEAST_EXPONENT).astype(np.int8)
    whole = np.rint(kernel / 2.0**exponent).astype("<i2").transpose(1, 2, 0)
    return {"whole": _compressed(whole), "exponent": exponent, "orders": len(kernel)}


def _compressed(values: NDArray[Any]) -> NDArray[np.uint8]:
    return np.frombuffer(lzma.compress(values.tobytes(), preset=9), np.uint8)


def visible_share(seen: Patches, hits: Hits, chosen: NDArray[np.intp]) -> NDArray[np.int8]:
    """How much of the light from each node patches of the picture reflect.

    The share is of albedo x cosine, not of rays, since that is what the picture loses. It is
    counted against the cosine of the patch's mean normal, which its reading has too, so it is
    0 behind the patch and, where the normal varies, may leave 0 to 1 near the terminator.

    Args:
        seen: All patches of the picture.
        hits: The rays of the picture.
        chosen: (N,) which patches.

    Returns:
        (N, rows, columns) in units of 1 / `_UNIT`.
    """
    directions = grid_directions(_COLUMNS, _ROWS).swapaxes(0, 1).reshape(-1, 3)
    share = np.zeros((len(chosen), len(directions)), np.int8)
    count = hits.sphere.shape[-1]
    place, normal = (part.reshape(-1, count, 3) for part in (hits.place, hits.normal))
    sphere, albedo = (part.reshape(-1, count) for part in (hits.sphere, hits.albedo))
    for index, patch in enumerate(chosen):
        rays = seen.rays[patch]
        at = (seen.pixel[patch], rays)
        blocked = hidden(place[at], sphere[at], directions)
        cosine = np.where(blocked, 0, np.maximum(normal[at] @ directions.T, 0))
        reflected = (albedo[at] / np.pi) @ cosine / count
        mean = directions @ seen.normal[patch]
        least = np.where(mean < 0, -1, 1) * np.maximum(np.abs(mean), 1e-9)
        share[index] = np.rint(np.clip(reflected / least, -_MOST, _MOST) * _UNIT)
    return share.reshape(len(chosen), _ROWS, _COLUMNS)


def changes_along_rows(
    share: NDArray[np.int8],
) -> tuple[NDArray[np.uint8], NDArray[np.uint16], NDArray[np.int8]]:
    """Shares as changes: how many in each row, steps from one to the next, and their sizes."""
    change = np.diff(share, axis=-1, prepend=np.int8(0)).reshape(-1, _COLUMNS)
    row, column = np.nonzero(change)
    first = np.diff(row, prepend=-1) > 0
    steps = np.where(first, column, np.diff(column, prepend=0))
    counts = np.bincount(row, minlength=len(change))
    return counts.astype(np.uint8), steps.astype("<u2"), change[row, column]


def bake_plane() -> dict[str, Any]:
    """The table of the plane scene; about twenty seconds."""
    hits = see(_SIZE_PX, _RAYS)
    seen = patches(hits)
    parts = [
        changes_along_rows(visible_share(seen, hits, chosen))
        for chosen in np.array_split(np.arange(len(seen.pixel)), _SIZE_PX)
    ]
    counts, steps, changes = (
        _compressed(np.concatenate(part)) for part in zip(*parts, strict=True)
    )
    sizes = np.array([_SIZE_PX, _RAYS, _COLUMNS, _ROWS, _UNIT])
    return {"sizes": sizes, "counts": counts, "steps": steps, "changes": changes}


def bake(folder: Path) -> None:
    """Write every table."""
    folder.mkdir(parents=True, exist_ok=True)
    np.savez(folder / "plane.npz", **bake_plane())
    for name, ball in ROUGH_BALLS.items():
        np.savez(folder / f"{name}.npz", **packed(ball_kernel(ball, ball_radii(ball))))


if __name__ == "__main__":
    bake(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "tables")
