"""Figures about the two places where an equirectangular picture is cut: the seam and the poles.

Both compare the cut with the rest of the picture, in log luminance, so that neither a bright nor
a busy picture counts as broken.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.qa.measurements import Finding, Measurements, absent

# Rows nearer to a pole than this say nothing of a seam.
_POLAR_SHARE = 0.08
# Steps below this many stops cannot be seen.
_LEAST_STEP_STOPS = 0.004
# A steady deviation has this many of its mean absolute deviations in a standard deviation.
_MAD_TO_SIGMA = 1.4826
# The steps to compare that at the seam with, on either side of it.
_BESIDE = (1, 2)
_LEAST_WIDTH_PX = 32
# The rows around a pole to compare it with; what counts as fine; and what cannot be seen.
_RING_ROWS = (12, 25)
# Below 256x128 noise looks like a pinwheel: the ring has too few pixels to tell.
_LEAST_HEIGHT_PX = 128
_COARSE_WAVES = 12
_LEAST_DETAIL_STOPS = 0.1


def seam_step(measured: Measurements) -> Finding:
    """How far the columns at the seam stand out among all columns, in standard deviations.

    A seam runs through most rows with one sign, while a lamp or a door frame that happens to
    stand there does not. So each column is compared with the mean of its neighbors, each step
    between columns with the mean of the steps beside it, and the median over the rows counts.
    The scale is the median absolute deviation of the same figure over all columns.
    """
    if measured.width_px < _LEAST_WIDTH_PX:
        return absent(f"narrower than {_LEAST_WIDTH_PX} pixels")
    stops = _without_poles(measured.stops)
    left, right = np.roll(stops, 1, axis=1), np.roll(stops, -1, axis=1)
    columns = np.abs(np.median(stops - (left + right) / 2, axis=0))
    steps = np.median(right - stops, axis=0)
    jumps = np.abs(steps - (np.roll(steps, 1) + np.roll(steps, -1)) / 2)
    own = max(
        columns[0] / _scale(columns), columns[-1] / _scale(columns), jumps[-1] / _scale(jumps)
    )
    return Finding(value=float(own))


def seam_repeat(measured: Measurements) -> Finding:
    """The step across the seam over the steps beside it: near 0 where a column is repeated.

    A grid whose first and last column show the same direction, as libraries make that align
    the corners of pictures, has no step there at all.
    """
    if measured.width_px < _LEAST_WIDTH_PX:
        return absent(f"narrower than {_LEAST_WIDTH_PX} pixels")
    stops = _without_poles(measured.stops)
    reach = max(_BESIDE) + 1
    near = np.concatenate([stops[:, -reach:], stops[:, :reach]], axis=1)
    roots = np.sqrt(np.abs(np.diff(near, axis=1))).mean(axis=0)
    middle = len(roots) // 2
    beside = float(np.mean([roots[middle + side * k] for k in _BESIDE for side in (-1, 1)]))
    if beside**2 < _LEAST_STEP_STOPS:
        return absent("too smooth at the seam to tell")
    return Finding(value=float(roots[middle]) / beside)


def pole_detail(measured: Measurements) -> Finding:
    """How much of the fine detail around the worse pole is still there at the pole itself.

    The outermost row of pixels is a ring hardly wider than a pixel: the world can show an
    edge in it, but no fine detail along it. A picture that was painted flat, without regard
    to the pole, carries the detail of the rows around it right into the pole, as a pinwheel.
    0 is the world, 1 a pinwheel.
    """
    if measured.envmap.height_px < _LEAST_HEIGHT_PX:
        return absent("below 256x128 there are too few pixels around a pole")
    stops = measured.stops
    return Finding(value=max(_pole_detail(stops), _pole_detail(stops[::-1])))


def _without_poles(stops: NDArray[np.float32]) -> NDArray[np.float32]:
    cut = round(stops.shape[0] * _POLAR_SHARE)
    # Every second row of a large map says as much as all of them.
    return stops[cut : stops.shape[0] - cut : 2 if stops.shape[0] >= 4 * _LEAST_HEIGHT_PX else 1]


def _scale(deviations: NDArray[np.floating]) -> float:
    return float(np.median(deviations)) * _MAD_TO_SIGMA + _LEAST_STEP_STOPS


def _pole_detail(stops: NDArray[np.float32]) -> float:
    around = _fine_detail(stops[slice(*_RING_ROWS)]).mean()
    return float(_fine_detail(stops[:1]).mean() / max(float(around), _LEAST_DETAIL_STOPS))


def _fine_detail(rows: NDArray[np.float32]) -> NDArray[np.floating]:
    """The size of what changes more than a dozen times along each row, in stops."""
    waves = np.fft.rfft(rows, axis=1)
    waves[:, : _COARSE_WAVES + 1] = 0
    return np.asarray(np.abs(np.fft.irfft(waves, rows.shape[1], axis=1)))
