"""Tables of an evaluation as text, whatever they are shown in: page, Markdown or CSV."""

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass

from panokit.report.wording import format_figure


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTable:
    """Rows of text.

    Attributes:
        id: Of the file and in the text, such as "T-A".
        title: What it shows.
        columns: Their headings; the first is of the rows' names.
        rows: As many cells as there are columns.
        note: How to read it.
    """

    id: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""

    @property
    def file(self) -> str:
        """The name of its CSV."""
        return f"{self.id.lower().replace('.', '-').replace(' ', '-')}.csv"

    def csv(self) -> str:
        """The rows, with a line of headings."""
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(self.rows)
        return buffer.getvalue()

    def markdown(self) -> str:
        """The table with its title and note."""
        rule = "|".join(("", "---", *("---:" for _ in self.columns[1:]), ""))
        lines = [f"### {self.id}: {self.title}", "", _line(self.columns), rule]
        lines += [_line(row) for row in self.rows]
        lines += ["", self.note] if self.note else []
        return "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"


def figure(value: float | None) -> str:
    """Three significant digits."""
    return format_figure(value)


def interval(mean: float, low: float, high: float) -> str:
    """A mean with its interval: "0.340 (0.310–0.360)"."""
    return f"{figure(mean)} ({figure(low)}–{figure(high)})"


def signed(value: float, digits: int = 1) -> str:
    """With its sign, and a minus that is one."""
    said = f"{round(value, digits) + 0.0:+.{digits}f}" if math.isfinite(value) else f"{value:+}"
    return said.replace("-", "−").replace("inf", "∞")
