"""How the figures of all maps are distributed, with the limits and the references' spread."""

from collections.abc import Sequence

from panokit.qa.batch import JudgedMap
from panokit.qa.report.words import by_family
from panokit.qa.verdicts import Check
from panokit.report.values import Chart, Charts, Group, Mark, Series
from panokit.report.wording import words_of

_FEWEST_MAPS = 12
# From so many times the least value on, a linear axis hides most of them.
_LOG_FROM = 100.0


def check_charts(maps: Sequence[JudgedMap]) -> Group | None:
    """A histogram of every check that tells maps apart; None where there are too few maps."""
    checks: dict[str, list[Check]] = {}
    for judged in maps:
        for check in judged.report.checks if judged.report else ():
            checks.setdefault(check.name, []).append(check)
    told = {name: found for name, found in checks.items() if _varies(_values(found))}
    families = by_family([found[0] for found in told.values()])
    sections = tuple(
        Charts(
            title=words_of(family),
            charts=tuple(_check_chart(told[check.name]) for check in members),
        )
        for family, members in families.items()
    )
    return Group(title="Distributions", sections=sections) if sections else None


def difference_charts(maps: Sequence[JudgedMap]) -> Charts | None:
    """A cumulative curve of every difference from the truth."""
    found: dict[str, list[float]] = {}
    units: dict[str, tuple[str, str]] = {}
    for judged in maps:
        for difference in judged.comparison.differences if judged.comparison else ():
            found.setdefault(difference.label, []).append(difference.value)
            units[difference.label] = (difference.unit, difference.meaning)
    charts = [
        Chart(
            title=label,
            unit=units[label][0],
            meaning=units[label][1],
            kind="ecdf",
            series=(Series(label="These maps", values=tuple(values)),),
            log=_wide(values),
        )
        for label, values in found.items()
        if _varies(values)
    ]
    if not charts:
        return None
    return Charts(
        title="Accuracy",
        charts=tuple(charts),
        note="Each curve tells which share of the maps lies at or below a figure.",
    )


def _check_chart(checks: Sequence[Check]) -> Chart:
    first, values = checks[0], _values(checks)
    limits = [("at least", first.low), ("at most", first.high)]
    return Chart(
        title=words_of(first.name),
        unit=first.unit,
        meaning=first.meaning,
        series=(Series(label="These maps", values=tuple(values)),),
        marks=tuple(Mark(label=label, value=limit) for label, limit in limits if limit is not None),
        log=_wide(values),
    )


def _values(checks: Sequence[Check]) -> list[float]:
    return [float(check.value) for check in checks if check.value is not None]


def _varies(values: Sequence[float]) -> bool:
    return len(values) >= _FEWEST_MAPS and len(set(values)) > 1


def _wide(values: Sequence[float]) -> bool:
    return min(values) > 0 and max(values) > _LOG_FROM * min(values)
