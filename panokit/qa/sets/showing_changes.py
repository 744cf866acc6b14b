"""What is added and what is distorted, as a table and charts of a report."""

from collections.abc import Sequence

from panokit.qa.sets.changes import Change, Effect
from panokit.report.values import (
    Badge,
    Cell,
    Chart,
    Charts,
    Column,
    Group,
    Series,
    Table,
    Tone,
)
from panokit.report.wording import format_figure, words_of

THESE, REFERENCE = "These maps", "Reference"
TONES: dict[Effect, Tone] = {
    Effect.DISTORTS: "fail",
    Effect.ADDS: "good",
    Effect.SAME: "",
    Effect.UNDECIDED: "",
}


def change_table(changes: Sequence[Change]) -> Table:
    """Every figure with its effect, both ranges, the shift and the share outside."""
    return Table(
        title="What is added and what is distorted",
        columns=(
            Column(label="Figure"),
            Column(label="Effect"),
            Column(label=REFERENCE, numeric=True),
            Column(label=THESE, numeric=True),
            Column(label="Shift in IQR", numeric=True),
            Column(label="Distance in IQR", numeric=True),
            Column(label="Outside", numeric=True),
            Column(label="From own truth in IQR", numeric=True),
        ),
        rows=tuple(_change_row(change) for change in changes),
        note="Medians with the 5 to 95 % range. The distance is Wasserstein-1, beside what chance "
        "alone stays under in 95 of 100 cases.",
        sortable=True,
    )


def _change_row(change: Change) -> tuple[Cell, ...]:
    name = Cell(text=change.descriptor.label)
    badge = Badge(text=str(change.effect), tone=TONES[change.effect])
    shift, unit = change.shift, change.descriptor.unit
    if shift is None:
        return (name, Cell(badge=badge, note=change.reason), *(Cell(text="–") for _ in range(6)))
    own = change.own_change
    outside = shift.outside
    return (
        name,
        Cell(badge=badge, note=change.reason, sort=_order(change)),
        _range(shift.reference, unit),
        _range(shift.augmented, unit),
        _interval(shift.shift.value, shift.shift.low, shift.shift.high),
        Cell(
            text=format_figure(shift.distance.value),
            note=f"chance {format_figure(shift.distance_null)}",
            sort=shift.distance.value,
        ),
        Cell(
            text=percent(outside.value),
            note=f"{percent(shift.below)} below, {percent(shift.above)} above",
            sort=outside.value,
        ),
        _interval(own.value, own.low, own.high) if own else Cell(text="–"),
    )


def percent(share: float) -> str:
    """A share of 0 to 1 as a whole percent."""
    return f"{100 * share:.0f} %"


def _order(change: Change) -> float:
    return float(list(Effect).index(change.effect))


def _range(quantiles: Sequence[float], unit: str) -> Cell:
    low, _, median, _, high = quantiles
    return Cell(
        text=format_figure(median, unit),
        note=f"{format_figure(low)} to {format_figure(high)}",
        sort=median,
    )


def _interval(value: float, low: float, high: float) -> Cell:
    return Cell(
        text=format_figure(value), note=f"{format_figure(low)} to {format_figure(high)}", sort=value
    )


def change_charts(changes: Sequence[Change]) -> Group | None:
    """Both histograms of every figure; None where no figure was compared."""
    charts = []
    for change in changes:
        drawn = change.distribution
        if drawn is None or change.shift is None:
            continue
        effect = words_of(str(change.effect))
        reference, ours = (
            tuple(100 * count / max(sum(counts), 1) for count in counts)
            for counts in (drawn.reference_counts, drawn.augmented_counts)
        )
        charts.append(
            Chart(
                title=change.descriptor.label,
                unit=change.descriptor.unit,
                kind="bins",
                at=drawn.edges,
                series=(
                    Series(label=f"{REFERENCE}, %", values=reference),
                    Series(label=f"{THESE}, %", values=ours),
                ),
                meaning=f"{change.descriptor.meaning} {effect}: {change.reason}.",
            )
        )
    if not charts:
        return None
    inner = Charts(charts=tuple(charts), note="Heights are percent of the maps of each set.")
    return Group(title="Distributions side by side", sections=(inner,), folded=True)
