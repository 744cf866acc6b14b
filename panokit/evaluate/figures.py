"""From the scores of pictures to the table: one figure per line, one method per column.

Intervals are 90 % percentile bootstraps over probes: how much another set of probes like these
could move the figure.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.evaluate.scoring import OTHER_ROLLS_PX, STRIDE_ROLLS_PX, Row

Reduce = Callable[[NDArray[np.float64]], NDArray[np.float64]]

_RESAMPLES = 1000
_LEVEL = (5, 95)


def _median(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.median(values, axis=-1))


def _mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.mean(values, axis=-1))


def _p90(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.percentile(values, 90, axis=-1))


def _value(name: str, row: Row) -> float | None:
    return row.values.get(name)


def _stops_off(row: Row) -> float | None:
    ratio = row.values.get("energy_ratio")
    return abs(float(np.log2(ratio))) if ratio else None


def _if_strong(name: str, row: Row) -> float | None:
    return row.values.get(name) if row.strong else None


def _sun_stops_off(row: Row) -> float | None:
    stops = _if_strong("sun_stops", row)
    return None if stops is None else abs(stops)


def _rolled(shifts: Sequence[int], row: Row) -> float | None:
    changes = [row.values.get(f"roll_{shift}") for shift in shifts]
    known = [change for change in changes if change is not None]
    return float(np.mean(known)) if known else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One line of the table.

    Attributes:
        key: In the JSON.
        title: In the table.
        pick: A picture's score, or None where it has none.
        reduce: All pictures' scores as one number.
        digits: To show.
        goal: Lowest and highest value that reaches the goal, by camera; "" is any camera.
    """

    key: str
    title: str
    pick: Callable[[Row], float | None]
    reduce: Reduce
    digits: int = 2
    goal: dict[str, tuple[float | None, float | None]] | None = None

    def goal_of(self, camera: str) -> tuple[float | None, float | None] | None:
        """The goal for a camera, or None where there is none."""
        goals = self.goal or {}
        return goals.get(camera, goals.get(""))

    def reaches(self, value: float, camera: str) -> bool:
        """Whether a value reaches the goal; False where there is none."""
        goal = self.goal_of(camera)
        if goal is None:
            return False
        low, high = goal
        return (low is None or value >= low) and (high is None or value <= high)


def _line(
    key: str,
    title: str,
    reduce: Reduce,
    digits: int,
    pick: Callable[[Row], float | None] | str,
    **goal: tuple[float | None, float | None],
) -> Line:
    picked = partial(_value, pick) if isinstance(pick, str) else pick
    goals = {"" if camera == "both" else camera: limits for camera, limits in goal.items()}
    return Line(key=key, title=title, pick=picked, reduce=reduce, digits=digits, goal=goals or None)


LINES: tuple[Line, ...] = (
    _line("energy_median", "energy ratio, median", _median, 2, "energy_ratio", both=(0.9, 1.1)),
    _line("energy_stops_median", "abs(log2 energy), median", _median, 2, _stops_off,
          both=(None, 0.5)),
    _line("energy_stops_p90", "abs(log2 energy), p90", _p90, 2, _stops_off, both=(None, 1.5)),
    _line("irradiance_median", "irradiance error, median", _median, 3, "irradiance_mean",
          both=(None, 0.20)),
    _line("irradiance_mean", "irradiance error, mean", _mean, 3, "irradiance_mean"),
    _line("light_vector_mean", "light vector error, mean (deg)", _mean, 1, "light_vector_deg",
          both=(None, 12.0)),
    _line("light_vector_median", "light vector error, median (deg)", _median, 1,
          "light_vector_deg"),
    _line("ball_median", "diffuse-ball RMSE, median", _median, 3, "ball", both=(None, 0.25)),
    _line("ball_si_median", "the same, scale-free", _median, 3, "ball_scale_invariant"),
    _line("ball_color_median", "ball color error, median (deg)", _median, 1, "ball_color_deg"),
    _line("pu21_crf_mean", "PU21-PSNR, tone-corrected, mean (dB)", _mean, 1, "pu21_crf_db",
          A=(29.0, None), B=(29.7, None)),
    _line("pu21_mean", "PU21-PSNR, mean (dB), not to be read alone", _mean, 1, "pu21_db"),
    _line("log_rmse_mean", "log10 RMSE, mean", _mean, 3, "log_rmse"),
    _line("beyond_clip_median", "energy beyond clipping, median", _median, 2,
          "beyond_clip_ratio"),
    _line("peak_median", "peak direction, median (deg)", _median, 1, "peak_deg"),
    _line("strong_energy_median", "strong sources: energy, median", _median, 2,
          partial(_if_strong, "energy_ratio"), both=(0.7, 1.4)),
    _line("strong_peak_median", "strong sources: peak, median (deg)", _median, 1,
          partial(_if_strong, "peak_deg"), both=(None, 10.0)),
    _line("strong_sun_stops_median", "strong sources: abs(stops) within 5 deg, median", _median,
          2, _sun_stops_off),
    _line("roll_stride_mean", "rolled by 256, 512 px (decades)", _mean, 5,
          partial(_rolled, STRIDE_ROLLS_PX), both=(None, 0.001)),
    _line("roll_other_mean", "rolled by 1, 37, 211 px (decades)", _mean, 4,
          partial(_rolled, OTHER_ROLLS_PX), both=(None, 0.01)),
    _line("cpu_seconds_median", "CPU seconds at 1024x512, median", _median, 2, "cpu_seconds",
          both=(None, 0.5)),
)  # fmt: skip


def summarize_rows(rows: Sequence[Row]) -> dict[str, dict[str, float | int] | None]:
    """Every line for the rows of one method and camera.

    Returns:
        Line's key -> {"value", "low", "high", "n"}; None where no picture has the score.
    """
    return {line.key: _figure(line, rows) for line in LINES}


def by_category(rows: Sequence[Row], keys: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Some lines for each category of the rows; "n" counts the pictures.

    Returns:
        Category -> {"n": count, line's key -> figure as in `summarize_rows`}.
    """
    lines = [line for line in LINES if line.key in keys]
    result: dict[str, dict[str, Any]] = {}
    for category in sorted({row.category for row in rows}):
        own = [row for row in rows if row.category == category]
        result[category] = {"n": len(own), **{line.key: _figure(line, own) for line in lines}}
    return result


def bootstrap(
    values: NDArray[np.float64], reduce: Reduce, digits: int, name: str = "value"
) -> dict[str, float]:
    """A figure with its 90 % percentile bootstrap interval, which is the same every time.

    Args:
        values: (N,), one for each picture.
        reduce: Many of them as one number, along the last axis.
        digits: To keep.
        name: Of the figure, beside "low" and "high".
    """
    random = np.random.default_rng(0)
    draws = random.integers(len(values), size=(_RESAMPLES, len(values)))
    low, high = np.percentile(reduce(values[draws]), _LEVEL)
    found = {name: reduce(values), "low": low, "high": high}
    return {key: round(float(value), digits) for key, value in found.items()}


def _figure(line: Line, rows: Sequence[Row]) -> dict[str, float | int] | None:
    picked = [line.pick(row) for row in rows]
    values = np.array([value for value in picked if value is not None], np.float64)
    if not len(values):
        return None
    return {**bootstrap(values, line.reduce, line.digits + 1), "n": len(values)}
