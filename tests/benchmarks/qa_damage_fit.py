"""What QA takes from the half of the captured probes that sets thresholds.

    python tests/benchmarks/qa_damage_fit.py PANOKIT_DATA

prints the weights of the contrast check and the range of every figure, and writes
panokit/qa/reference.json. The other half is not read.
"""

import json
import os
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from qa_damage_split import Reference, references

from panokit.qa import encoding
from panokit.qa.checks import RULES
from panokit.qa.measurements import Measurements
from panokit.qa.plausibility import FIGURES, place, plausibility_figures
from panokit.qa.reference_set import SCHEMA, ReferenceSet

# Added to the variances, in square octaves, so that few probes do not give wild weights.
RIDGE = 0.05
OUT = Path(encoding.__file__).parent / "reference.json"


def fit_contrast(maps: list[Measurements]) -> None:
    found = [encoding.contrast_distances(m) for m in maps]
    names = list(encoding.WEIGHTS)
    logs = np.array([[f[name] for name in names] for f in found])
    covariance = np.cov(logs.T) + RIDGE * np.eye(len(names))
    weights = np.linalg.solve(covariance, np.ones(len(names)))
    weights /= weights.sum()
    rounded = dict(zip(names, weights.round(2).tolist(), strict=True))
    rounded["local"] = round(1 - sum(v for k, v in rounded.items() if k != "local"), 2)
    sums = logs @ np.array([rounded[name] for name in names])
    print(f"WEIGHTS = {rounded}\nTYPICAL = {sums.mean():.3f}  (deviation {sums.std():.2f} octaves)")


def fit_reference(probes: list[Reference], maps: list[Measurements]) -> None:
    categories: dict[str, list[list[float]]] = {"outdoor": [], "indoor": []}
    for probe, measured in zip(probes, maps, strict=True):
        figures = plausibility_figures(measured)
        if probe.usable and figures is not None:
            category = "indoor" if probe.category.startswith("indoor") else "outdoor"
            categories[category].append([round(figures[name], 3) for name in FIGURES])
    record = {
        "schema": SCHEMA,
        "source": (
            "Figures of captured CC0 probes of HDRI Haven (now Poly Haven): "
            f"{sum(map(len, categories.values()))} maps, one half of the places, "
            "by tests/benchmarks/qa_damage_fit.py"
        ),
        "license": "CC0-1.0",
        "figures": list(FIGURES),
    }
    OUT.write_text(_lines(record, categories), encoding="utf-8")
    for name, rows in categories.items():
        distances = []
        for index, row in enumerate(rows):
            others = {k: np.array(v) for k, v in categories.items()}
            others[name] = np.array(rows[:index] + rows[index + 1 :])
            reference = ReferenceSet(figures=FIGURES, categories=others, source="")
            distances.append(place(dict(zip(FIGURES, row, strict=True)), reference).distance)
        print(f"{name}: {len(rows)} maps, distance without itself {np.sort(distances).round(2)}")


def _lines(record: dict[str, object], categories: dict[str, list[list[float]]]) -> str:
    """JSON with one map on a line."""
    head = json.dumps(record, indent=1)[:-2]
    parts = [
        f'  "{name}": [\n' + ",\n".join(f"   {json.dumps(row)}" for row in sorted(rows)) + "\n  ]"
        for name, rows in categories.items()
    ]
    return head + ',\n "categories": {\n' + ",\n".join(parts) + "\n }\n}\n"


def main() -> None:
    probes = [probe for probe in references(Path(sys.argv[1])) if not probe.scored]
    maps = [Measurements(probe.read()) for probe in probes]
    usable = [m for probe, m in zip(probes, maps, strict=True) if probe.usable]
    print(f"{len(probes)} probes, {len(usable)} of them usable")
    fit_contrast(usable)
    fit_reference(probes, maps)
    for rule in RULES:
        values = [v for m in usable if (v := rule.measure(m).value) is not None]
        if values:
            low, median, high = np.percentile(values, [0, 50, 100])
            print(f"{rule.name:18} n {len(values):2}  {low:10.4g} {median:10.4g} {high:10.4g}")


if __name__ == "__main__":
    main()
