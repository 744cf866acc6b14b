"""A few figures of an evaluation, as they fit a terminal of 80 columns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from panokit.evaluate.lighting.evaluation import Evaluation
from panokit.evaluate.lighting.models import ModelFacts
from panokit.evaluate.lighting.run import Result
from panokit.evaluate.lighting.score_tables import MARKS

_LIGHT = {
    "code-ssd": "SSD",
    "thesis-dssim": "DSSIM",
    "relit-diffuse-si-rmse": "ball",
    "light-vector": "deg",
    "brightest": "peak",
}
_REFLECTANCE = {
    "reflectance-code-ssd": "SSD",
    "reflectance-mse": "MSE",
    "reflectance-dssim": "DSSIM",
}
_NAME_WIDTH = 31


@dataclass(frozen=True, slots=True, kw_only=True)
class TerminalTable:
    """Rows of text with notes below.

    Attributes:
        header: Of the columns.
        rows: As many cells as there are columns.
        notes: What the marks beside names mean.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...]


def table_of(found: Evaluation) -> list[TerminalTable]:
    """The tables: light, and reflectance where there is some."""
    facts = {one.name: one for one in found.models}
    by_name: dict[str, list[Result]] = {}
    for result in found.results:
        if not result.control:
            by_name.setdefault(result.predictor, []).append(result)
    tables = []
    for title, columns in (("light", _LIGHT), ("reflectance", _REFLECTANCE)):
        first = next(iter(columns))
        several = {name: rows for name, rows in by_name.items() if first in rows[0].scores}
        if several:
            tables.append(_table(title, columns, several, facts, found.seen))
    return tables


def _table(
    title: str,
    columns: Mapping[str, str],
    by_name: Mapping[str, Sequence[Result]],
    facts: Mapping[str, ModelFacts],
    seen: Mapping[str, list[str] | None],
) -> TerminalTable:
    rows, marks = [], set()
    first = next(iter(columns))
    means = {
        name: {figure: float(np.nanmean([row.scores[figure] for row in results]))
               for figure in columns}
        for name, results in by_name.items()
    }  # fmt: skip
    for name in sorted(by_name, key=lambda one: means[one][first]):
        mark = _mark(facts.get(name), seen)
        marks |= set(mark)
        seconds = float(np.median([row.seconds for row in by_name[name]]))
        rows.append((
            _short(name) + mark,
            str(len(by_name[name])),
            *(f"{means[name][figure]:.3g}" for figure in columns),
            f"{1000 * seconds:.0f}",
        ))  # fmt: skip
    texts = MARKS | {"~": "training had not converged"}
    notes = [f"{mark} {text}" for mark, text in texts.items() if mark in marks]
    return TerminalTable(
        header=(title, "n", *columns.values(), "ms"), rows=tuple(rows), notes=tuple(notes)
    )


def _mark(facts: ModelFacts | None, seen: Mapping[str, list[str] | None]) -> str:
    if facts is None:
        return ""
    mark = "~" if facts.converged is False else ""
    places = seen.get(facts.name)
    return mark + ("?" if places is None else "*" if places else "")


def _short(name: str) -> str:
    return name if len(name) <= _NAME_WIDTH else f"{name[: _NAME_WIDTH - 1]}…"
