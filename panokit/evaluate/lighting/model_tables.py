"""The tables of trainings, speed, controls, probes, and of the verdicts."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from panokit.evaluate.lighting.experiments import experiment
from panokit.evaluate.lighting.outcome import Outcome, epochs_to_within
from panokit.evaluate.lighting.score_tables import HEADINGS, marks, marks_note
from panokit.evaluate.lighting.statements import EPOCHS, PRIMARY, Finding, Statement
from panokit.evaluate.lighting.tables import TextTable, figure, signed
from panokit.evaluate.lighting.verdicts import place_interval

# Thesis's figure -> experiments in it, in the order of its legend.
CURVES: Mapping[str, tuple[str, ...]] = {
    "F5.1": ("concat-unshared-deep", "concat-shared-deep"),
    "F5.2": ("concat-shared-deep", "dot-product-deep"),
    "F5.3": ("concat-shared", "dot-product"),
    "F5.4": ("no-background", "dot-product"),
    "F5.5": ("dot-product", "background-branch", "dot-product-deep"),
    "F5.6": ("background-branch", "pyramid", "pyramid-multi-scale"),
}


def convergence(outcome: Outcome) -> TextTable:
    """Final and best validation SSD, and how soon each came near its end."""
    rows = []
    for entrant in outcome.entrants:
        curves = outcome.curves(entrant)
        if not curves.size:
            continue
        fast = [epochs_to_within(curve) for curve in curves]
        models = [outcome.models[one] for one in entrant.members]
        converged = sum(one["converged"] is True for one in models)
        rows.append((
            entrant.title, figure(float(curves[:, -1].mean())),
            f"{figure(float(curves[:, -1].min()))} to {figure(float(curves[:, -1].max()))}",
            figure(float(curves.min(axis=1).mean())), figure(float(np.mean(fast))),
            f"{curves.shape[1]}", _steps(models), _hours(models), f"{converged} of {len(models)}",
        ))  # fmt: skip
    return TextTable(
        id="F5-curves",
        title="Validation: sum of squared differences of code values for a sample",
        columns=("model", "last", "seeds", "best", "epochs to within 5 %", "epochs", "steps",
                 "CPU hours", "converged"),
        rows=tuple(rows),
        note="Means over seeds. Converged: the validation loss fell by less than 1 % over the last "
        "fifth.",
    )  # fmt: skip


def ratios(outcome: Outcome) -> TextTable:
    """How many times faster the second of each pair of curves converges."""
    rows = []
    for id_, names in CURVES.items():
        for other in names[1:]:
            pair = [outcome.entrant(names[0]), outcome.entrant(other)]
            if None in pair:
                continue
            one, two = (outcome.curves(e) for e in pair if e is not None)
            if not (one.size and two.size):
                continue
            slow, fast = (float(np.mean([epochs_to_within(c) for c in curves]))
                          for curves in (one, two))  # fmt: skip
            change = float(two[:, -1].mean() / one[:, -1].mean()) - 1
            rows.append((id_, f"{experiment(other).title} over {experiment(names[0]).title}",
                         figure(slow / fast), f"{signed(100 * change)} %"))  # fmt: skip
    return TextTable(
        id="F5-ratios",
        title="Convergence and final validation SSD, pair by pair",
        columns=("figure", "pair", "times as fast", "final SSD"),
        rows=tuple(rows),
        note="Times as fast: the ratio of epochs to within 5 % of the mean of the own last fifth.",
    )


def speed(outcome: Outcome) -> TextTable:
    """Parameters, operations, memory and latency."""
    rows, machines = [], set()
    for entrant in outcome.entrants:
        models = [outcome.models[one] for one in entrant.members if one in outcome.models]
        told = next((one["speed"] for one in models if one.get("speed")), None)
        if told is None:
            continue
        machines.add(str(told["hardware"]))
        learned = models[0].get("parameters") or told["parameters"]
        rows.append((
            entrant.title, f"{models[0]['input_px']}", f"{learned / 1e6:.3f}",
            figure(told["gflops"]), figure(told["file_mb"]), figure(told["memory_mb"]),
            figure(told["p50_ms"]), figure(told["p95_ms"]), figure(told["fps"]),
            figure(told["cpu_ms"]),
        ))  # fmt: skip
    return TextTable(
        id="T-B",
        title="Size and speed, one pair at a time",
        columns=("model", "px", "parameters, M", "GFLOP", "file, MB", "peak memory, MB",
                 "p50, ms", "p95, ms", "pairs/s", "CPU, ms"),
        rows=tuple(rows),
        note=f"Measured on {'; '.join(sorted(machines))}. Memory is the process's peak over that "
        "without the network. CPU time does not depend on what else the machine does. The thesis: "
        "20 ms on a GTX 1070.",
    )  # fmt: skip


def controls(outcome: Outcome) -> TextTable:
    """What spoiled inputs do to the score."""
    rows = []
    for entrant, control, change, low, high, n in control_changes(outcome):
        rows.append((entrant, control, str(n), f"{signed(100 * change)} %",
                     f"{signed(100 * low)} to {signed(100 * high)} %"))  # fmt: skip
    return TextTable(
        id="F-F",
        title="Controls: SSD of code values with spoiled inputs",
        columns=("model", "control", "n", "change", "95 % interval"),
        rows=tuple(rows),
        note="A network that reads the second view gets worse without it. An interval that spans "
        "zero: no use of it is shown.",
    )


def control_changes(outcome: Outcome) -> list[tuple[str, str, float, float, float, int]]:
    """Title, control, mean relative change of the score with its interval, and n."""
    found = []
    for entrant in outcome.entrants:
        for figure_name in (PRIMARY, "reflectance-code-ssd"):
            plain = outcome.scores(entrant, figure_name)
            for control in outcome.controls_of(entrant):
                spoiled = outcome.scores(entrant, figure_name, control)
                both = np.isfinite(plain) & np.isfinite(spoiled)
                if not both.any():
                    continue
                base = float(plain[both].mean())
                difference = (spoiled - plain)[both] / base
                places = np.asarray(np.unique(outcome.places[both], return_inverse=True)[1])
                low, high = place_interval(difference, places)
                found.append((entrant.title, control, float(difference.mean()), low, high,
                              int(both.sum())))  # fmt: skip
    return found


def splits(outcome: Outcome) -> TextTable:
    """What the dataset holds."""
    rows = []
    for name, split in outcome.dataset.get("splits", {}).items():
        kinds = ", ".join(f"{kind} {count}" for kind, count in split["kinds"].items())
        rows.append((name, str(split["samples"]), str(len(split["places"])), str(split["maps"]),
                     str(split["objects"]), kinds or "–"))  # fmt: skip
    return TextTable(
        id="T-K",
        title=f"The dataset {outcome.dataset.get('name', '')}: what is in its splits",
        columns=("split", "samples", "places", "maps", "objects", "samples by kind of map"),
        rows=tuple(rows),
        note="No place and no object is in two splits.",
    )


def probes(outcome: Outcome) -> TextTable:
    """The light maps of the test, one by one."""
    rows = []
    for probe in outcome.dataset.get("probes", []):
        if probe["split"] == outcome.dataset.get("judged"):
            rows.append((
                str(probe["probe"]), str(probe["place"]), str(probe["category"] or "–"),
                str(probe["samples"]), figure(probe.get("directedness")),
                figure(probe.get("elevation_deg")),
            ))  # fmt: skip
    return TextTable(
        id="T-K-test",
        title="The light maps of the test",
        columns=("map", "place", "kind of scene", "samples", "directedness", "elevation, °"),
        rows=tuple(rows),
        note="Directedness: the length of the light vector over the energy; 1 is a single lamp. "
        "Elevation of most light, in the mean over samples.",
    )


def verdicts(found: Sequence[Finding]) -> TextTable:
    """Every statement by its primary figure."""
    rows = []
    several = len({one.size for one in found}) > 1
    for one in found:
        if one.figure != one.statement.primary:
            continue
        rows.append((
            _statement(one) + (f" ({one.size})" if several else ""),
            one.word + (f": {one.why}" if one.why else ""),
            _difference(one), _figure(one.figure), str(one.comparison.n),
            str(one.comparison.places or "–"), str(one.comparison.seeds), said_of(one),
        ))  # fmt: skip
    return TextTable(
        id="V",
        title="What the thesis says, and what the data say",
        columns=("statement", "verdict", "difference (95 % interval)", "figure", "n", "places",
                 "seeds", "compared"),
        rows=tuple(rows),
        note="With the thesis's figure or section where it says so; the others it never reported. "
        "Difference: the first minus the second, relative to the second; lower is better. "
        "Intervals by drawing places anew, of epochs by Student's t over seeds. “Same” needs an "
        "interval within 2 %.",
    )  # fmt: skip


def secondary(found: Sequence[Finding]) -> TextTable:
    """Every statement by its other figures, a column for each."""
    others = [one for one in found if one.figure != one.statement.primary]
    names = list(dict.fromkeys(_figure(one.figure) for one in others))
    by_pair: dict[tuple[str, str, str], dict[str, str]] = {}
    for one in others:
        pair = one.statement.first, one.statement.second, one.size
        by_pair.setdefault(pair, {})[_figure(one.figure)] = f"{_difference(one)}, {one.word}"
    several = len({size for *_, size in by_pair}) > 1
    return TextTable(
        id="V-2",
        title="The same comparisons by other figures",
        columns=("compared", *names),
        rows=tuple(
            (f"{first} and {second}" + (f" ({size})" if several else ""),
             *(cells.get(name, "–") for name in names))
            for (first, second, size), cells in by_pair.items()
        ),
        note="These decide nothing; they show whether the primary figure stands alone.",
    )  # fmt: skip


def _statement(one: Finding) -> str:
    text = one.statement.text
    number = one.statement.number
    return f"{number}: {text}" if number else text[0].upper() + text[1:]


def said_of(one: Finding) -> str:
    """Which entrants were compared, and how."""
    statement: Statement = one.statement
    sign = "=" if statement.expected == "same" else "<"
    return f"{statement.first} {sign} {statement.second}"


def _figure(name: str) -> str:
    return "epochs to within 5 %" if name == EPOCHS else HEADINGS.get(name, name)


def _difference(one: Finding) -> str:
    found = one.comparison
    scale = found.mean / found.relative if found.relative else 0.0
    if not scale:
        return f"{figure(found.mean)} ({figure(found.low)} to {figure(found.high)})"
    ends = 100 * found.low / scale, 100 * found.high / scale
    return f"{signed(100 * found.relative)} % ({signed(ends[0])} to {signed(ends[1])} %)"


def _steps(models: Sequence[Mapping[str, Any]]) -> str:
    steps = {one["steps"] for one in models if one["steps"]}
    return "–" if not steps else " / ".join(f"{one:,}" for one in sorted(steps))


def _hours(models: Sequence[Mapping[str, Any]]) -> str:
    hours = [one["cpu_hours"] for one in models if one["cpu_hours"]]
    return "–" if not hours else figure(float(np.mean(hours)))


def all_marks(outcome: Outcome) -> str:
    """The marks in use, explained; "" where there are none."""
    return marks_note(outcome) if any(marks(outcome, e) for e in outcome.entrants) else ""
