"""Probe library: a gallery with filters, one probe at a time, selections and exports."""

from collections.abc import Awaitable, Callable, Sequence
from functools import partial
from pathlib import Path

from nicegui import ui

from panokit.app import browsing
from panokit.app.browsing import Shelf
from panokit.app.desks import Desk
from panokit.app.probe_export import ProbeExport
from panokit.app.probe_page import ProbePage
from panokit.app.progress import Progress
from panokit.app.settings import AppSettings
from panokit.app.widgets import (
    badge,
    box,
    button,
    check,
    choice,
    fold,
    image,
    say,
    text_field,
    words,
)
from panokit.app.work import Work
from panokit.errors import PanokitError
from panokit.probes.entry import Entry

_MORE = 48
_ANY = {"": "any"}
_YES_NO = {"": "any", "yes": "yes", "no": "no"}
_KINDS = {"": "any", "native": "captured", "lifted": "lifted", "synthetic": "rendered"}
_VERDICTS = {"": "any", "pass": "pass", "fail": "fail"}


class ProbesPlace:
    """One tab's view of it."""

    def __init__(self, settings: AppSettings, desk: Desk, work: Work) -> None:
        self.desk, self.work = desk, work
        self.shelf = Shelf(library=settings.library)
        self._shown = _MORE
        # Of which the filters are shown; another one may have been named while that one was opened.
        self._opened: Path | None = None
        words("h1", "Probe library")
        words(
            "p",
            "HDR light maps with what is known of each: what QA says, where it is from, and what "
            "its license permits.",
            "lead",
        )
        self._where = box("panel library-path")
        with self._where:
            text_field(
                "The library's folder on this machine",
                str(settings.library or ""),
                self._open,
                placeholder="/data/probes; Enter opens it",
            )
        self._progress = Progress()
        self._filters = box()
        self.page = ProbePage(desk, work, self.shelf)
        self.export = ProbeExport(desk, work, self.shelf, self.select)
        self._bar = box()
        self._gallery = box("gallery-place")
        with self._bar:
            self._count = words("p", "", "gallery-count").props('role="status"')
        self._bar.set_visibility(False)
        if self.shelf.library is not None:
            ui.timer(0.05, self._begin, once=True)

    async def _open(self, text: str) -> None:
        self.shelf.library = Path(text.strip()).expanduser() if text.strip() else None
        await self._begin()

    async def _begin(self) -> None:
        """Another library."""
        self.shelf.typed, self.shelf.selected, self.shelf.entries = {}, {}, ()
        self._opened = None
        for place in (self._filters, self._gallery):
            place.clear()
        self.page.close()
        self.export.show()
        self._bar.set_visibility(False)
        if self.shelf.library is not None and not self._progress.busy:
            await self._progress.run(self._show_library, "Opening the library")

    async def _show_library(self) -> None:
        """Open the library; another one, if that was named meanwhile."""
        while (library := self.shelf.library) is not None:
            try:
                options = await self.work.in_thread(browsing.options_of, library)
            except PanokitError:
                # What was wrong with a folder that is not wanted any more is not told.
                if library == self.shelf.library:
                    raise
                continue
            if library == self.shelf.library:
                self._opened = library
                self.desk.pictures["preview"] = partial(browsing.preview, library)
                self._filters.clear()
                with self._filters:
                    self._form(options)
                await self._find()
            if library == self.shelf.library:
                return

    def _form(self, options: dict[str, list[str]]) -> None:
        def take(name: str) -> Callable[[str], Awaitable[None]]:
            async def taken(text: str) -> None:
                self.shelf.typed[name] = str(text)
                self._shown = _MORE
                await self._again()

            return taken

        def of(name: str) -> dict[str, str]:
            return _ANY | {one: one.replace("_", " ") for one in options[name]}

        with box("filters", "search").props('aria-label="Which probes"'):
            text_field("Name", "", take("name"), placeholder="a part of it", kind="search")
            choice("Category", of("category"), "", take("category"))
            choice("Kind", _KINDS, "", take("kind"))
            choice("QA", _VERDICTS, "", take("verdict"))
            choice("Sun in it", _YES_NO, "", take("has_sun"))
            choice("May train models", _YES_NO, "", take("trainable"))
        with fold("More filters"), box("filters"):
            choice("License", of("license"), "", take("license"))
            choice("Provider", of("provider"), "", take("provider"))
            choice("Place", of("place"), "", take("place"))
            text_field("Taken from", "", take("date_from"), kind="date")
            text_field("Taken to", "", take("date_to"), kind="date")
            text_field("Least range, stops", "", take("dynamic_range_min_stops"), kind="number")
            text_field("Most plausibility", "", take("plausibility_max"), kind="number")
            text_field("Tags", "", take("tags"), placeholder="forest, dawn")
            text_field("Box", "", take("bbox"), placeholder="west, south, east, north")
            choice("May make works", _YES_NO, "", take("derivable"))
            choice("May keep copies", _YES_NO, "", take("storable"))

    async def _again(self) -> None:
        if self._progress.busy:
            return
        await self._progress.run(self._find, "Looking")
        if self._opened != self.shelf.library:
            await self._progress.run(self._show_library, "Opening the library")

    async def _find(self) -> None:
        while True:
            library, typed = self.shelf.library, dict(self.shelf.typed)
            if library is None:
                return
            self.shelf.entries, total = await self.work.in_thread(browsing.find, library, typed)
            if (library, typed) == (self.shelf.library, self.shelf.typed):
                break
        self._bar.set_visibility(True)
        shown = len(self.shelf.entries)
        said = f"{shown} probes" if shown == total else f"{shown} of {total} probes"
        if total == 0:
            add = f"panokit probes add {self.shelf.library} MAP..."
            said = f"The library is empty. Add maps with: {add}"
        elif shown == 0:
            said = f"None of the {total} probes passes. Ask for less."
        say(self._count, said)
        self._show(self.shelf.entries[: self._shown])
        self.export.show()

    def _show(self, entries: Sequence[Entry]) -> None:
        self._gallery.clear()
        with self._gallery:
            with box("cards", "ul"):
                for entry in entries:
                    self._card(entry)
            left = len(self.shelf.entries) - len(entries)
            if left > 0:
                with box("bar-row"):
                    button(f"Show {min(left, _MORE)} more of {left}", self._more)

    def _more(self) -> None:
        self._shown += _MORE
        self._show(self.shelf.entries[: self._shown])

    def _card(self, entry: Entry) -> None:
        with box("card", "li"):
            with box("card-open", "button") as opened:
                opened.props.update({"type": "button", "aria-label": f"Open {entry.name}"})
                image(
                    f"/desk/{self.desk.token}/picture/preview/{entry.id}",
                    f"{entry.name}, tone mapped",
                )
            opened.on("click", lambda _: self.page.open(entry.id), [])
            with box("card-words"):
                words("h3", entry.name)
                with box("card-line"):
                    badge(f"QA {entry.verdict}", entry.verdict)
                    words("span", self._line(entry), "small quiet-text")
                self._tick(entry)

    @staticmethod
    def _line(entry: Entry) -> str:
        stops = entry.dynamic_range_stops
        parts = (
            entry.category.replace("_", " "),
            "" if stops is None else f"{stops:.1f} stops",
            "sun" if entry.has_sun else "",
            entry.license if entry.license != "unknown" else "license not known",
        )
        return " · ".join(part for part in parts if part)

    def _tick(self, entry: Entry) -> None:
        def ticked(on: bool) -> None:
            if on:
                self.shelf.selected[entry.id] = entry.name
            else:
                self.shelf.selected.pop(entry.id, None)
            self.export.show()

        check("Selected", value=entry.id in self.shelf.selected, take=ticked).props[
            "aria-label"
        ] = f"Select {entry.name}"

    def select(self, ids: Sequence[str]) -> None:
        """Tick these probes, and no others."""
        names = {entry.id: entry.name for entry in self.shelf.entries}
        self.shelf.selected = {id: names.get(id, id) for id in ids}
        self._show(self.shelf.entries[: self._shown])
        self.export.show()
