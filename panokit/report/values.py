"""What a report is made of: frozen values that say what to show, never how."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from panokit.errors import UsageError
from panokit.report.layers import Layer
from panokit.report.pictures import Picture

Tone: TypeAlias = Literal["", "good", "fair", "poor", "fail", "note"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Badge:
    """A word that stands out: a verdict, a grade.

    Attributes:
        text: The word itself; color never says anything alone.
        tone: How it is colored.
    """

    text: str
    tone: Tone = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Count:
    """One large figure with its label.

    Attributes:
        label: What is counted or measured.
        value: The figure, as text.
        tone: How it is colored.
        badge: A word beside it, such as its grade.
    """

    label: str
    value: str
    tone: Tone = ""
    badge: Badge | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """A row of large figures."""

    counts: tuple[Count, ...]
    title: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Text:
    """Paragraphs; with a tone, set apart from the rest.

    Attributes:
        paragraphs: Plain text, no markup.
        title: The heading, "" for none.
        tone: "note" for what must not be overlooked.
        small: Whether it is an aside.
    """

    paragraphs: tuple[str, ...]
    title: str = ""
    tone: Tone = ""
    small: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One cell of a table.

    Attributes:
        text: What it says.
        note: A quieter line below.
        lines: One line for each of many things, instead of a text.
        badge: A word that stands out, after the text.
        link: The name of a map of the page's gallery that the text leads to.
        sort: What the column is sorted by, if not by the text.
        percent: 0 to 100: a mark on a bar, such as a percentile.
    """

    text: str = ""
    note: str = ""
    lines: tuple[str, ...] = ()
    badge: Badge | None = None
    link: str = ""
    sort: float | None = None
    percent: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column's heading.

    Attributes:
        label: What stands in it.
        numeric: Whether its cells are set to the right.
    """

    label: str
    numeric: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows of cells; the first cell of a row is its heading.

    Attributes:
        columns: The headings, as many as each row has cells.
        rows: The cells.
        title: The heading, "" for none.
        note: Below the table.
        headings: Whether the columns' headings are shown; they are always told.
        sortable: Whether a reader can sort by a column.
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    title: str = ""
    note: str = ""
    headings: bool = True
    sortable: bool = False

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise UsageError(
                    f"A row of the table {self.title!r} has {len(row)} cells for "
                    f"{len(self.columns)} columns. Give every row all cells."
                )


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """Values that are drawn as one.

    Attributes:
        label: Whose values they are.
        values: What is not finite is left out, and its number told. Of a chart of kind
            "bins" or "curve": the height of each bin, or at each point.
    """

    label: str
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A line across a chart, such as a limit."""

    label: str
    value: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Chart:
    """How values are distributed.

    Attributes:
        title: What is measured.
        series: One to four sets of values.
        unit: Of the values.
        kind: "histogram", bars of counts; "ecdf", the share of values up to each value; or
            what is counted already: "bins", counts between the edges `at`, and "curve",
            shares at the points `at`.
        at: The edges of bins, or the points of a curve, ascending.
        marks: Limits and the like.
        log: Whether the axis is logarithmic; only values above 0 are drawn then.
        meaning: One plain sentence below the title.
    """

    title: str
    series: tuple[Series, ...]
    unit: str = ""
    kind: Literal["histogram", "ecdf", "bins", "curve"] = "histogram"
    at: tuple[float, ...] = ()
    marks: tuple[Mark, ...] = ()
    log: bool = False
    meaning: str = ""

    def __post_init__(self) -> None:
        if not 1 <= len(self.series) <= 4:
            raise UsageError(
                f"The chart {self.title!r} has {len(self.series)} series. Give one to four; "
                "split what is more over several charts."
            )
        heights = {"bins": len(self.at) - 1, "curve": len(self.at)}.get(self.kind)
        if heights is not None and any(len(s.values) != heights for s in self.series):
            raise UsageError(
                f"The chart {self.title!r} of kind {self.kind!r} with {len(self.at)} places `at` "
                f"needs {heights} values in every series."
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Charts:
    """Charts beside one another."""

    charts: tuple[Chart, ...]
    title: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pictures:
    """Pictures beside one another; or, if wide, each over the whole width of the page."""

    pictures: tuple[Picture, ...]
    title: str = ""
    note: str = ""
    wide: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class MapEntry:
    """A light map in a gallery.

    Attributes:
        name: What it is called; unique within the gallery.
        thumbnail: What is seen without scripts.
        layers: The map first, then what it can be compared with.
        display_gain: What brings the first layer's radiance to the brightness of a photograph.
        ball_gain: What brings a white ball lit by it to just below white.
        unit: Of radiance, for readouts.
        badge: Its verdict.
        category: What it can be filtered by, "" for none.
        figures: Label -> value; what the gallery can be sorted by. The first two are shown.
        subtitle: Where it is from, in one line.
        summary: What is to be said of it at once.
        facts: All there is to know of it.
    """

    name: str
    thumbnail: Picture
    layers: tuple[Layer, ...]
    display_gain: float = 1.0
    ball_gain: float = 1.0
    unit: str = ""
    badge: Badge | None = None
    category: str = ""
    figures: Mapping[str, float | None] = field(default_factory=dict)
    subtitle: str = ""
    summary: str = ""
    facts: tuple["Section", ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Gallery:
    """Maps to look around in, to filter and to sort."""

    entries: tuple[MapEntry, ...]
    title: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Sections under one heading.

    Attributes:
        title: The heading.
        sections: What stands below it.
        folded: Whether it is closed until a reader opens it.
    """

    title: str
    sections: tuple["Section", ...]
    folded: bool = False


Section: TypeAlias = Counts | Text | Table | Charts | Pictures | Gallery | Group


@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """A whole report.

    Attributes:
        title: The page's heading.
        head: What a reader sees first.
        sections: The rest, in order; those with a title are in the list of contents.
        footer: Paragraphs at the end: how things were measured.
    """

    title: str
    head: tuple[Section, ...] = ()
    sections: tuple[Section, ...] = ()
    footer: tuple[str, ...] = ()
