"""The experiment's figures: per method and camera, with intervals, and per category."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.train.crossval import ScoreRow

# What the tables show: field of the score, how a method's probes are summed up, digits.
COLUMNS: dict[str, tuple[str, Callable[[NDArray[np.float64]], float], int]] = {
    "irradiance median": ("irradiance_mean", lambda x: float(np.median(x)), 3),
    "irradiance mean": ("irradiance_mean", lambda x: float(np.mean(x)), 3),
    "light vector mean (deg)": ("light_vector_deg", lambda x: float(np.mean(x)), 1),
    "ball RMSE median": ("ball", lambda x: float(np.median(x)), 3),
    "energy median": ("energy_ratio", lambda x: float(np.median(x)), 3),
    "energy log2 median": ("energy_ratio", lambda x: float(np.median(np.abs(np.log2(x)))), 2),
    "energy log2 p90": ("energy_ratio", lambda x: float(np.percentile(np.abs(np.log2(x)), 90)), 2),
    "peak median (deg)": ("peak_deg", lambda x: float(np.median(x)), 1),
    "PU21-crf mean (dB)": ("pu21_crf_db", lambda x: float(np.mean(x)), 1),
}

_RESAMPLES = 2000


def summarize(rows: Sequence[ScoreRow]) -> dict[str, Any]:
    """Every column for every method and camera, with its 90 % bootstrap interval over probes.

    Returns:
        camera -> method -> column -> {"value", "low", "high"}, for `json.dump`; the key
        "categories" holds the same without intervals, camera -> category -> method -> column.
    """
    cameras = sorted({row.camera for row in rows})
    methods = list(dict.fromkeys(row.method for row in rows))
    categories = sorted({row.category for row in rows})
    result: dict[str, Any] = {}
    for camera in cameras:
        of_camera = [row for row in rows if row.camera == camera]
        result[camera] = {
            method: _figures([row for row in of_camera if row.method == method])
            for method in methods
        }
    result["categories"] = {
        camera: {
            category: {
                method: _values(
                    [
                        row
                        for row in rows
                        if (row.camera, row.category, row.method) == (camera, category, method)
                    ]
                )
                for method in methods
            }
            for category in categories
        }
        for camera in cameras
    }
    return result


def paired_wins(rows: Sequence[ScoreRow], field: str, method: str, other: str) -> tuple[int, int]:
    """On how many pictures `method` has the lower value of a score than `other`, and of how many.

    The scores of the same probe and camera are compared.
    """
    values = {(row.method, row.camera, row.probe): float(getattr(row.score, field)) for row in rows}
    pairs = [
        (values[key], values[(other, *key[1:])])
        for key in values
        if key[0] == method and (other, *key[1:]) in values
    ]
    return sum(a < b for a, b in pairs), len(pairs)


def markdown_table(summary: dict[str, Any], camera: str) -> str:
    """The table of one camera, with intervals, as Markdown."""
    lines = [
        "| method | " + " | ".join(COLUMNS) + " |",
        "|---" * (len(COLUMNS) + 1) + "|",
    ]
    for method, figures in summary[camera].items():
        cells = [
            f"{figures[name]['value']:.{digits}f} "
            f"({figures[name]['low']:.{digits}f}-{figures[name]['high']:.{digits}f})"
            for name, (_, _, digits) in COLUMNS.items()
        ]
        lines.append(f"| {method} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _values(rows: Sequence[ScoreRow]) -> dict[str, float]:
    result: dict[str, float] = {"pictures": len(rows)}
    for name, (field, reduce, digits) in COLUMNS.items():
        result[name] = round(reduce(_field(rows, field)), digits)
    return result


def _figures(rows: Sequence[ScoreRow]) -> dict[str, dict[str, float]]:
    random = np.random.default_rng(0)
    draws = random.integers(len(rows), size=(_RESAMPLES, len(rows)))
    result = {}
    for name, (field, reduce, digits) in COLUMNS.items():
        values = _field(rows, field)
        spread = [reduce(values[draw]) for draw in draws]
        low, high = np.percentile(spread, [5, 95])
        result[name] = {
            "value": round(reduce(values), digits),
            "low": round(float(low), digits),
            "high": round(float(high), digits),
        }
    return result


def _field(rows: Sequence[ScoreRow], field: str) -> NDArray[np.float64]:
    return np.array([getattr(row.score, field) for row in rows], np.float64)
