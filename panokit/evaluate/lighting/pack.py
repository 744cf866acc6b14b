"""All figures and tables of an evaluation, from its folder alone: no model, no dataset."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panokit.evaluate.lighting import comparison_tables, model_tables, score_tables
from panokit.evaluate.lighting.figures.curves import draw_curves
from panokit.evaluate.lighting.figures.drawing import FigureFile
from panokit.evaluate.lighting.figures.probes import draw_probes
from panokit.evaluate.lighting.figures.sheets import draw_sheets
from panokit.evaluate.lighting.figures.spread import (
    draw_bars,
    draw_brightest,
    draw_distributions,
)
from panokit.evaluate.lighting.figures.sweeps import (
    NOISE,
    draw_controls,
    draw_memory,
    draw_noise,
    noise_curve,
)
from panokit.evaluate.lighting.outcome import Outcome
from panokit.evaluate.lighting.run import memorization, read_results
from panokit.evaluate.lighting.statements import PRIMARY, Finding, findings
from panokit.evaluate.lighting.tables import TextTable

SCHEMA = "panokit.evaluation.lighting/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Pack:
    """What there is to show.

    Attributes:
        outcome: It is made from.
        figures: By id.
        tables: By id.
        findings: How the statements came out.
    """

    outcome: Outcome
    figures: dict[str, FigureFile]
    tables: dict[str, TextTable]
    findings: list[Finding]


def make_pack(folder: Path, tick: Callable[[], object] = lambda: None) -> Pack:
    """Draw everything.

    Raises:
        StorageError: If the folder holds no results.
    """
    outcome = Outcome(folder)
    found = findings(outcome)
    figures: list[FigureFile] = []
    drawers: list[Callable[[Outcome], list[FigureFile]]] = [draw_curves]
    if outcome.entrants_with(PRIMARY):
        drawers += [draw_bars, draw_distributions, draw_brightest, draw_sheets, draw_memory]
    for draw in [*drawers, draw_noise, draw_controls, draw_probes]:
        figures += draw(outcome)
        tick()
    tables = _tables(outcome, found)
    return Pack(
        outcome=outcome,
        figures={one.id: one for one in figures},
        tables={one.id: one for one in tables if one.rows},
        findings=found,
    )


def _tables(outcome: Outcome, found: list[Finding]) -> list[TextTable]:
    light: list[TextTable] = []
    if outcome.entrants_with(PRIMARY):
        light = [
            score_tables.league(outcome),
            comparison_tables.beside_thesis(outcome),
            comparison_tables.beats(outcome),
            comparison_tables.own_model(outcome),
            score_tables.ablation(outcome),
            score_tables.all_figures(outcome),
            score_tables.percentiles(outcome, "F5.7", "thesis-dssim-log",
                                     "DSSIM of logs: how it is distributed"),
            score_tables.percentiles(outcome, "F5.8", "thesis-mse",
                                     "MSE: how it is distributed"),
            score_tables.percentiles(outcome, "F5.9", "thesis-dssim",
                                     "DSSIM: how it is distributed"),
            score_tables.percentiles(outcome, "F5.10", "brightest",
                                     "Brightest pixel, degrees: how it is distributed"),
            score_tables.percentiles(outcome, "F5.10-rgb", "thesis-brightest-rgb",
                                     "Brightest pixel, pixels, mean of R, G and B"),
            score_tables.percentiles(outcome, "F5.10-luma", "thesis-brightest-luma",
                                     "Brightest pixel, pixels, luma"),
            score_tables.percentiles(outcome, "F5.10-wrapped", "brightest-luma-wrapped",
                                     "Brightest pixel, pixels, luma, columns wrapped"),
            comparison_tables.strata(outcome),
            comparison_tables.memory(outcome),
            *comparison_tables.published(outcome),
        ]  # fmt: skip
    reflectance = score_tables.reflectance(outcome)
    return [
        model_tables.verdicts(found),
        model_tables.secondary(found),
        *light,
        *([] if reflectance is None else [reflectance]),
        model_tables.convergence(outcome),
        model_tables.ratios(outcome),
        model_tables.speed(outcome),
        model_tables.controls(outcome),
        model_tables.splits(outcome),
        model_tables.probes(outcome),
    ]


def summary_of(pack: Pack) -> dict[str, Any]:
    """Every entrant's distribution of every figure, and all findings."""
    outcome = pack.outcome
    names = [*score_tables.HEADINGS]
    entrants = {}
    for entrant in outcome.entrants:
        spreads = {name: outcome.spread(entrant, name) for name in names
                   if outcome.has(entrant.members[0], name)}  # fmt: skip
        entrants[entrant.name] = {
            "title": entrant.title,
            "members": list(entrant.members),
            "not_converged": outcome.not_converged(entrant),
            "seen": outcome.seen(entrant),
            "figures": {
                name: {"n": s.n, "mean": _short(s.mean), "low": _short(s.low),
                       "high": _short(s.high), "sd": _short(s.sd),
                       "percentiles": [_short(p) for p in s.percentiles], "max": _short(s.most),
                       "seeds": [_short(one) for one in s.seeds]}
                for name, s in spreads.items() if s is not None
            },
        }  # fmt: skip
    curves = {base: noise_curve(outcome, base, rival, name) for base, rival, name, _ in NOISE}
    return {
        "schema": SCHEMA,
        "samples": len(outcome.keys),
        "places": sorted(set(outcome.place_names)),
        "dataset": outcome.dataset.get("name", ""),
        "entrants": entrants,
        "findings": [one.to_json() for one in pack.findings],
        "memorization": memorization(read_results(outcome.folder)),
        "crossings": {base: curve.crossing_text() for base, curve in curves.items() if curve},
        "figures": sorted(pack.figures),
        "tables": sorted(pack.tables),
    }


def _short(value: float) -> float:
    """Seven significant digits, which are the same on every machine."""
    return float(json.loads(f"{value:.7g}"))
