"""Two methods on the same pictures: how often one errs less, and by how much on average.

Averages of two methods can differ by less than either would on another set of probes, while
one of them errs less on nearly every picture; and the other way round. Only differences between
scores of the same picture tell which.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from panokit.evaluate.figures import bootstrap
from panokit.evaluate.scoring import Row

# Errors whose differences are counted: score -> what it is called, and digits to show.
PAIRED = {
    "irradiance_mean": ("irradiance error", 3),
    "light_vector_deg": ("light vector (deg)", 1),
    "ball": ("ball RMSE", 3),
}


def compare_pairs(rows: Sequence[Row], method: str, other: str) -> dict[str, dict[str, float]]:
    """On how many pictures `method` errs less than `other`, and the mean difference.

    Args:
        rows: Scores of both, of one camera or of several.
        method: Its heading.
        other: The heading of what it is compared with.

    Returns:
        Score -> {"wins", "n", "difference", "low", "high"}: a negative difference, with its 90 %
        bootstrap interval over pictures, means that `method` errs less. Scores that no picture
        has of both are left out.
    """
    values = {(row.method, row.camera, row.probe): row.values for row in rows if not row.failed}
    result = {}
    for name, (_, digits) in PAIRED.items():
        differences = []
        for (column, camera, probe), own in values.items():
            against = values.get((other, camera, probe), {})
            first, second = own.get(name), against.get(name)
            if column == method and first is not None and second is not None:
                differences.append(first - second)
        if differences:
            result[name] = {
                "wins": sum(d < 0 for d in differences),
                "n": len(differences),
                **bootstrap(np.array(differences), _mean, digits + 1, name="difference"),
            }
    return result


def pairs_table(pairs: dict[str, dict[str, dict[str, float]]]) -> list[str]:
    """Lines of Markdown for one method: other method -> `compare_pairs`."""
    heads = [f"{title}: errs less | by, in the mean" for title, _ in PAIRED.values()]
    table = [f"| against | {' | '.join(heads)} |", "|---" * (2 * len(heads) + 1) + "|"]
    for other, found in pairs.items():
        cells = []
        for name, (_, digits) in PAIRED.items():
            cells += _cells(found.get(name), digits)
        table.append(f"| {other} | {' | '.join(cells)} |")
    return table


def _cells(found: dict[str, float] | None, digits: int) -> list[str]:
    if found is None:
        return ["", ""]
    # What it errs less by is the difference turned round.
    less, low, high = -found["difference"], -found["high"], -found["low"]
    return [
        f"{found['wins']} of {found['n']}",
        f"{less:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})",
    ]


def _mean(values: Any) -> Any:
    return np.mean(values, axis=-1)
