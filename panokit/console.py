"""What a command says while it works: bars on a terminal, plain lines otherwise, JSON on request.

Progress goes to standard error and results to standard output, so that output can be piped.
"""

import json
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Protocol

from rich.console import Console as RichConsole
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

_PLAIN_INTERVAL_S = 5.0
# Over a night nobody wants a line every five seconds.
_INTERVAL_GROWS_AFTER_S = 600.0


class Tick(Protocol):
    """Counts one item done, or rejected."""

    def __call__(self, *, rejected: bool = False) -> None:
        """One more item is done."""
        ...


class Console:
    """The voice of a command.

    Args:
        as_json: Print results as JSON and nothing else.
        quiet: Print results only.
    """

    def __init__(self, *, as_json: bool = False, quiet: bool = False) -> None:
        self.as_json = as_json
        self.quiet = quiet or as_json
        self._errors = RichConsole(stderr=True, highlight=False)
        self._output = RichConsole(highlight=False, soft_wrap=True)

    def note(self, text: str) -> None:
        """A line for the person watching."""
        if not self.quiet:
            self._errors.print(text, markup=False, soft_wrap=True)

    def result(self, text: str) -> None:
        """A line of the command's result; not printed when results are JSON."""
        if not self.as_json:
            self._output.print(text, markup=False)

    def table(self, header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
        """Rows of text in columns; not printed when results are JSON."""
        widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]
        for row in [header, *rows]:
            cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
            self.result("  ".join(cells).rstrip())

    def value(self, value: Mapping[str, Any] | list[Any]) -> None:
        """The command's result for machines; printed only when asked for."""
        if self.as_json:
            sys.stdout.write(json.dumps(value, indent=1, sort_keys=True, default=str) + "\n")

    @contextmanager
    def stage(self, name: str, total: int | None, *, unit: str = "") -> Iterator[Tick]:
        """Show the progress of one stage; call what it yields once per item.

        Args:
            name: The stage.
            total: How many items there are, or None if nobody knows.
            unit: What the items are called ("samples"); if given, tell how many are done in an
                hour, and how long it will take.
        """
        if self.quiet or total == 0:
            yield lambda *, rejected=False: None
        elif self._errors.is_terminal:
            yield from self._bar(name, total, unit)
        else:
            yield from self._lines(name, total, unit)

    def _bar(self, name: str, total: int | None, unit: str) -> Iterator[Tick]:
        with Progress(
            TextColumn("{task.description:<8}"),
            BarColumn(bar_width=14 if unit else 24),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rejected]}"),
            TimeElapsedColumn(),
            TimeRemainingColumn(elapsed_when_finished=False),
            TextColumn("{task.fields[rate]}"),
            console=self._errors,
        ) as progress:
            task = progress.add_task(name, total=total, rejected="", rate="")
            started = time.monotonic()

            def advance(done: int, rejected: int) -> None:
                rate = f"{_per_hour(done, time.monotonic() - started)}/h" if unit else ""
                said = f"{rejected} rejected" if rejected else ""
                progress.update(task, advance=1, rejected=said, rate=rate)

            yield self._counter(advance)

    def _lines(self, name: str, total: int | None, unit: str) -> Iterator[Tick]:
        started = last = time.monotonic()
        counts = {"done": 0, "rejected": 0}

        def report(done: int, rejected: int) -> None:
            nonlocal last
            counts.update(done=done, rejected=rejected)
            now = time.monotonic()
            interval = _PLAIN_INTERVAL_S * max(1.0, (now - started) / _INTERVAL_GROWS_AFTER_S)
            # The last item is told of at the end, once.
            if now - last >= interval and done != total:
                last = now
                self._say(name, counts, total, now - started, unit)

        yield self._counter(report)
        self._say(name, counts, total, time.monotonic() - started, unit)

    def _say(
        self, name: str, counts: Mapping[str, int], total: int | None, seconds: float, unit: str
    ) -> None:
        done = counts["done"]
        of = "" if total is None else f" of {total}"
        rejected = f", {counts['rejected']} rejected" if counts["rejected"] else ""
        rate = f", {_per_hour(done, seconds)} {unit}/h" if unit and done else ""
        left = ""
        if unit and total is not None and 0 < done < total:
            left = f", {duration_text(seconds / done * (total - done))} left"
        self.note(f"{name}: {done}{of}{rejected}, {duration_text(seconds)}{rate}{left}")

    def _counter(self, report: Callable[[int, int], None]) -> Tick:
        done = rejections = 0

        def tick(*, rejected: bool = False) -> None:
            nonlocal done, rejections
            done += 1
            rejections += rejected
            report(done, rejections)

        return tick


def _per_hour(done: int, seconds: float) -> str:
    return f"{done / max(seconds, 1e-3) * 3600:,.0f}"


def duration_text(seconds: float) -> str:
    """A duration for people: "12 s", "25 min", "3 h 5 min"."""
    if seconds < 120:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 120 else f"{minutes // 60} h {minutes % 60} min"


def size_text(count: float) -> str:
    """A number of bytes for people: "3.2 MB"."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} TB"
