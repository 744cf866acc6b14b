"""Any JSON as sections, so that figures nobody wrote a page for appear all the same.

Single values by name become a table, lists of numbers become charts, and so do counts between
`edges` and shares at `points`; lists of records become tables, with what is nested in a record as
further columns; what is nested deeper becomes a group. Nothing is left out.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from panokit.report.values import (
    Badge,
    Cell,
    Chart,
    Charts,
    Column,
    Group,
    Section,
    Series,
    Table,
    Text,
    Tone,
)
from panokit.report.wording import format_figure, words_of

_TONES: Mapping[str, Tone] = {
    "pass": "",
    "fail": "fail",
    "poor": "poor",
    "fair": "fair",
    "good": "good",
    "distorts": "fail",
    "adds": "good",
    "same": "",
}
_LONGEST_LINE = 8
_LONGEST_OPEN_TABLE = 40
_MOST_SERIES = 4
# What a record is called by, in order.
_NAMES = ("label", "title", "name", "id")
# Numbers that are counted already: what they stand at, how many more places than heights there
# are, how they are drawn, and the word of their keys that says no more than that.
_COUNTED = (("edges", 1, "bins", "counts"), ("points", 0, "curve", "below"))


def sections_of(title: str, value: Any) -> tuple[Section, ...]:
    """The sections that show a JSON value under a heading.

    Args:
        title: The heading.
        value: What `json.load` gives: a dictionary, a list, or a single value.
    """
    if isinstance(value, Mapping) and value:
        return _mapping(title, value)
    if _is_records(value):
        return _records(title, value)
    if _is_numbers(value) and len(value) > _LONGEST_LINE:
        return (_charts(title, {title: value}),)
    if isinstance(value, list | tuple):
        return (Text(title=title, paragraphs=tuple(in_words(v) for v in value) or ("None.",)),)
    return (Text(title=title, paragraphs=("None." if value == {} else in_words(value),)),)


def _mapping(title: str, value: Mapping[str, Any]) -> tuple[Section, ...]:
    """Each kind of entry in a section of its own; one section alone takes the title."""
    drawn, left = _counted(title, value)
    single = {k: v for k, v in left.items() if _is_single(v)}
    numbers = {k: v for k, v in left.items() if k not in single and _is_chart(v)}
    rows = {
        k: v
        for k, v in left.items()
        if k not in numbers and isinstance(v, Mapping) and v and all(map(_is_single, v.values()))
    }
    rows = rows if len(rows) > 1 and len({tuple(sorted(v)) for v in rows.values()}) == 1 else {}
    known = {*single, *numbers, *rows}
    rest = {k: v for k, v in left.items() if k not in known}
    alone = title if (bool(drawn) + bool(single) + bool(numbers) + bool(rows) == 1) else ""
    alone = "" if rest else alone
    parts: list[Section] = []
    if single:
        parts.append(_figures(alone, single))
    if rows:
        parts += _records(alone, [{"": words_of(k), **v} for k, v in rows.items()])
    if drawn:
        parts.append(Charts(title=alone, charts=drawn))
    if numbers:
        parts.append(_charts(alone, numbers))
    for name, inner in rest.items():
        parts += sections_of(words_of(name), inner)
    if alone:
        return tuple(parts)
    return (Group(title=title, sections=tuple(parts)),) if parts else ()


def _counted(title: str, value: Mapping[str, Any]) -> tuple[tuple[Chart, ...], dict[str, Any]]:
    """Charts of what is counted already, and what is left of the mapping."""
    charts, left = [], dict(value)
    for at, more, kind, word in _COUNTED:
        places = value.get(at)
        if not isinstance(places, list | tuple) or not _is_numbers(places) or len(places) < 2:
            continue
        heights = {
            k: v
            for k, v in value.items()
            if k != at and k.endswith(word) and _is_numbers(v) and len(v) == len(places) - more
        }
        if not 1 <= len(heights) <= _MOST_SERIES:
            continue
        series = tuple(
            Series(label=words_of(k.removesuffix(word)) or words_of(k), values=_floats(v))
            for k, v in heights.items()
        )
        charts.append(
            Chart(title=title, kind=kind, at=_floats(places), series=series)  # type: ignore[arg-type]
        )
        left = {k: v for k, v in left.items() if k != at and k not in heights}
    return tuple(charts), left


def _records(title: str, records: Sequence[Mapping[str, Any]]) -> tuple[Section, ...]:
    """A table, what is drawn in the records as charts, and what is nested deeper below it."""
    charts: list[Chart] = []
    deeper: list[Section] = []
    flat = []
    for record in records:
        name = _name_of(record)
        row: dict[str, Any] = {}
        for key, value in record.items():
            if isinstance(value, Mapping):
                drawn, left = _counted(name, value)
                charts += drawn
                for inner, one in left.items():
                    if _is_single(one):
                        row[f"{key}: {inner}"] = one
                    else:
                        deeper += sections_of(f"{name}: {words_of(inner)}", one)
            elif _is_single(value):
                row[key] = value
            else:
                deeper += sections_of(f"{name}: {words_of(key)}", value)
        flat.append(row)
    alone = not charts and not deeper and len(flat) <= _LONGEST_OPEN_TABLE
    parts: list[Section] = [_table(title if alone else "", flat)] if any(flat) else []
    if charts:
        parts.append(Charts(charts=tuple(charts)))
    parts += deeper
    if alone:
        return tuple(parts)
    return (Group(title=title, sections=tuple(parts), folded=len(flat) > _LONGEST_OPEN_TABLE),)


def _name_of(record: Mapping[str, Any]) -> str:
    return next((str(record[key]) for key in _NAMES if record.get(key)), "")


def _is_single(value: Any) -> bool:
    short = isinstance(value, list | tuple) and len(value) <= _LONGEST_LINE
    if short and all(v is None or isinstance(v, str | int | float) for v in value):
        return True
    return value is None or isinstance(value, str | int | float)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_numbers(value: Any) -> bool:
    return (
        isinstance(value, list | tuple)
        and len(value) > 0
        and all(v is None or _is_number(v) for v in value)
    )


def _is_chart(value: Any) -> bool:
    """A list of numbers, or a few of them by name."""
    if isinstance(value, Mapping):
        return 1 <= len(value) <= _MOST_SERIES and all(_is_numbers(v) for v in value.values())
    return _is_numbers(value)


def _is_records(value: Any) -> bool:
    return (
        isinstance(value, list | tuple)
        and len(value) > 0
        and all(isinstance(v, Mapping) and v for v in value)
    )


def _figures(title: str, values: Mapping[str, Any]) -> Table:
    return Table(
        title=title,
        columns=(Column(label="Figure"), Column(label="Value", numeric=True)),
        rows=tuple((Cell(text=words_of(k)), _cell(v)) for k, v in values.items()),
        headings=False,
    )


def _table(title: str, records: Sequence[Mapping[str, Any]]) -> Table:
    names = list(dict.fromkeys(name for record in records for name in record))
    numeric = {
        name: all(r.get(name) is None or _is_number(r[name]) for r in records) for name in names
    }
    return Table(
        title=title,
        columns=tuple(
            Column(label=words_of(name) or "Name", numeric=numeric[name]) for name in names
        ),
        rows=tuple(tuple(_cell(record.get(name)) for name in names) for record in records),
        sortable=len(records) > 1,
    )


def _charts(title: str, numbers: Mapping[str, Any]) -> Charts:
    charts = []
    for name, value in numbers.items():
        parts = value if isinstance(value, Mapping) else {name: value}
        series = tuple(Series(label=words_of(k), values=_floats(vs)) for k, vs in parts.items())
        charts.append(Chart(title=words_of(name), series=series, log=_wants_log(series)))
    return Charts(title=title, charts=tuple(charts))


def _floats(values: Sequence[float | None]) -> tuple[float, ...]:
    return tuple(float("nan") if v is None else float(v) for v in values)


def _wants_log(series: Sequence[Series]) -> bool:
    """Whether all values are above 0 and the largest is a thousand times the least."""
    values = [v for one in series for v in one.values if v == v]
    return len(values) > 1 and min(values) > 0 and max(values) > 1000 * min(values)


def _cell(value: Any) -> Cell:
    if _is_number(value):
        return Cell(text=format_figure(value), sort=float(value))
    if isinstance(value, str) and value in _TONES:
        return Cell(badge=Badge(text=value, tone=_TONES[value]))
    return Cell(text=in_words(value))


def in_words(value: Any) -> str:
    """Any JSON value as one line, with its figures as a person would write them."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if _is_number(value):
        return format_figure(value)
    if isinstance(value, list | tuple):
        return ", ".join(in_words(v) for v in value) or "none"
    if isinstance(value, Mapping):
        return ", ".join(f"{words_of(k)}: {in_words(v)}" for k, v in value.items()) or "none"
    return str(value)
