"""Tables that set entrants against something: baselines, the thesis, memory, kinds of light."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from panokit.evaluate.lighting.experiments import FINAL, OWN
from panokit.evaluate.lighting.outcome import Entrant, Outcome
from panokit.evaluate.lighting.published import (
    ARRAY_PARTS,
    SPHERE_PARTS,
    SPHERES,
    VARIANTS,
    name_of,
)
from panokit.evaluate.lighting.run import TO_MEMORY, TO_TRUTH
from panokit.evaluate.lighting.score_tables import HEADINGS, marks
from panokit.evaluate.lighting.scoring import DOMINANCE
from panokit.evaluate.lighting.statements import PRIMARY, against
from panokit.evaluate.lighting.tables import TextTable, figure, signed
from panokit.metrics.brightest import DOMINANT

_JUDGED = (PRIMARY, "thesis-dssim", "light-vector", "relit-diffuse-rmse")
_JUDGED_NOTE = (
    "Better or worse where the 95 % interval of the difference, by places, leaves out zero."
)


def strata(outcome: Outcome) -> TextTable:
    """The brightest pixel in degrees, by dominance of the light and by kind of scene."""
    groups = strata_of(outcome)
    rows = []
    for entrant in outcome.entrants_with("brightest"):
        cells = []
        for which in groups.values():
            spread = outcome.spread(entrant, "brightest", which)
            cells.append("–" if spread is None else figure(spread.percentiles[2]))
        rows.append((entrant.title + marks(outcome, entrant), *cells))
    return TextTable(
        id="F5.10-strata",
        title="Brightest pixel in degrees, median, by kind of light",
        columns=(
            "entrant", *(f"{name} ({int(which.sum())})" for name, which in groups.items())
        ),
        rows=tuple(rows),
        note=f"A light is dominant if its cap of 15° is {DOMINANT:g} times as bright as any other. "
        "Where none is, the brightest pixel is an accident.",
    )  # fmt: skip


def strata_of(outcome: Outcome) -> dict[str, NDArray[np.bool_]]:
    """Name -> which samples."""
    first = outcome.entrants_with("brightest")[0]
    dominance = outcome.scores(first, DOMINANCE)
    groups = {"all": np.ones(len(outcome.keys), bool),
              "dominant light": dominance >= DOMINANT, "none": dominance < DOMINANT}  # fmt: skip
    for category in sorted(set(outcome.categories)):
        groups[str(category or "unknown").replace("_", " ")] = outcome.categories == category
    return groups


def beside_thesis(outcome: Outcome) -> TextTable:
    """The thesis's figures beside ours."""
    ours = [e for e in (outcome.entrant(FINAL), outcome.entrant("panokit")) if e is not None]
    ours = ours or [e for e in outcome.entrants_with(PRIMARY) if not e.is_baseline][:1]

    def row(name: str, key: str, thesis: Sequence[str]) -> tuple[str, ...]:
        cells = []
        for entrant in ours:
            s = outcome.spread(entrant, key)
            cells.append(
                "–"
                if s is None
                else " / ".join([*(figure(p) for p in s.percentiles[1:4]), figure(s.mean)])
            )
        return (name, " / ".join(thesis), *cells)  # fmt: skip

    speeds = []
    for entrant in ours:
        told = [outcome.models[one]["speed"] for one in entrant.members if one in outcome.models]
        known = next((one for one in told if one), None)
        speeds.append("–" if known is None else f"{figure(known['p50_ms'])} (CPU)")
    return TextTable(
        id="T-2",
        title="The thesis's figures beside these",
        columns=("figure", "thesis, 2018", *(e.title for e in ours)),
        rows=(
            row("DSSIM: p25 / p50 / p75 / mean", "thesis-dssim", ("0.30", "0.34", "0.38", "0.34")),
            row("DSSIM of logs: the same", "thesis-dssim-log", ("not told",)),
            row("MSE: p25 / p50 / p75 / mean", "thesis-mse", ("0.56", "1.92", "7.42", "1134.83")),
            row("brightest, px (R, G, B): the same", "thesis-brightest-rgb",
                ("0.3", "20", "29", "“2”")),
            row("brightest, °: the same", "brightest", ("not told",)),
            ("latency, ms", "20 (GTX 1070)", *speeds),
        ),
        note="Other data: the thesis had 175 maps, IKEA furniture, 55,000 samples and another "
        "renderer, and does not say how its maps were coded for DSSIM. Its mean distance of 2 "
        "pixels does not go with its percentiles and is taken for a misprint of 20.",
    )  # fmt: skip


def beats(outcome: Outcome) -> TextTable:
    """Every trained model against the mean and the random map."""
    others = [e for e in (outcome.entrant("mean map"), outcome.entrant("random map")) if e]
    rows = []
    for entrant in outcome.entrants_with(PRIMARY):
        if entrant.is_baseline:
            continue
        cells = [_against(outcome, entrant, other, name) for other in others for name in _JUDGED]
        rows.append((entrant.title, *cells))
    return TextTable(
        id="T-3",
        title="Trained models against the mean map and the random map",
        columns=("model", *(f"{other.name}: {HEADINGS[name]}" for other in others
                            for name in _JUDGED)),
        rows=tuple(rows) if others else (),
        note=_JUDGED_NOTE,
    )  # fmt: skip


def own_model(outcome: Outcome) -> TextTable:
    """The model of this house against every other network."""
    own = outcome.entrant(OWN)
    rows = [
        (other.title, *(_against(outcome, own, other, name) for name in _JUDGED))
        for other in outcome.entrants_with(PRIMARY)
        if own is not None and not other.is_baseline and other.name != own.name
    ]
    return TextTable(
        id="T-4",
        title="panokit against every other network",
        columns=("panokit against", *(HEADINGS[name] for name in _JUDGED)),
        rows=tuple(rows),
        note=_JUDGED_NOTE,
    )


def _against(outcome: Outcome, entrant: Entrant, other: Entrant, name: str) -> str:
    found = against(outcome, entrant, other, name)
    return "–" if found is None else f"{found[1]}, {signed(100 * found[0].relative, 0)} %"


def published(outcome: Outcome) -> list[TextTable]:
    """The three-sphere and nine-sphere protocols and light direction, in both variants."""
    ids = {"spheres": "three spheres", "array": "nine spheres on a plane"}
    tables = []
    for variant in VARIANTS:
        said = "as published" if variant == "compat" else "corrected"
        columns = {f"{ball.replace('_', ' ')}: {part.replace('_', ' ')}":
                   name_of("spheres", ball, part, variant)
                   for ball in SPHERES for part in SPHERE_PARTS}  # fmt: skip
        tables.append(
            _published(outcome, f"T-G-spheres-{variant}", f"{ids['spheres']}, {said}", columns,
                       np.nanmean, "Means over samples.")
        )  # fmt: skip
        columns = {part.replace("_", " "): name_of("array", part, variant) for part in ARRAY_PARTS}
        columns["light direction, °"] = name_of("light-direction", variant)
        tables.append(
            _published(outcome, f"T-G-array-{variant}", f"{ids['array']}, {said}", columns,
                       np.nanmedian, "Medians over samples, as published.")
        )  # fmt: skip
    return [table for table in tables if table.rows]


def _published(
    outcome: Outcome,
    id_: str,
    title: str,
    columns: dict[str, str],
    reduce: Callable[..., np.floating],
    note: str,
) -> TextTable:
    rows, counts = [], set()
    for entrant in outcome.entrants:
        found = [outcome.scores(entrant, name) for name in columns.values()]
        there = [values[np.isfinite(values)] for values in found]
        if any(len(values) for values in there):
            counts.add(max(len(values) for values in there))
            cells = [figure(float(reduce(values))) if len(values) else "–" for values in there]
            rows.append((entrant.title, *cells))
    n = (
        ""
        if not counts
        else f" n = {min(counts)}" + ("." if len(counts) == 1 else f" to {max(counts)}.")
    )
    return TextTable(
        id=id_, title=title[0].upper() + title[1:], columns=("entrant", *columns),
        rows=tuple(rows),
        note=f"{note}{n} Scenes by panokit's precomputed transport, not by Blender: compare within "
        "the table only.",
    )  # fmt: skip


def memory(outcome: Outcome) -> TextTable:
    """How often a prediction is nearer to a training map than to its truth."""
    rows = []
    for entrant in outcome.entrants_with(TO_MEMORY):
        truth, known = (outcome.scores(entrant, name) for name in (TO_TRUTH, TO_MEMORY))
        nearer = float(np.mean(known < truth))
        rows.append((entrant.title, f"{float(np.nanmean(truth)):.3f}",
                     f"{float(np.nanmean(known)):.3f}", f"{100 * nearer:.0f} %"))  # fmt: skip
    return TextTable(
        id="F-E",
        title="Memory: distance to the truth and to the nearest training map",
        columns=("entrant", "to truth", "to training map", "nearer to memory"),
        rows=tuple(rows),
        note="Root mean squared difference of logs, decades. A network that looks up training maps "
        "comes near 100 % with a small distance to them. The mean map, which is not far from any "
        "map, comes near 100 % too: read the share beside the distances.",
    )
