"""Probes that are ticked, or chosen to be different: for another tool, with their credits."""

import asyncio
from collections.abc import Callable, Sequence

from nicegui import ui

from panokit.app import browsing
from panokit.app.browsing import Shelf
from panokit.app.desks import Desk
from panokit.app.progress import Progress
from panokit.app.widgets import box, button, choice, notes, text_field, words
from panokit.app.work import Work
from panokit.errors import UsageError
from panokit.probes.settings import ExportSettings, SelectSettings

_TARGETS = {
    "exr": "EXR",
    "hdr": "Radiance HDR",
    "blender": "Blender",
    "usd": "USD",
    "gltf": "glTF",
    "mitsuba": "Mitsuba",
    "harmonics": "Harmonics",
    "parquet": "Table (Parquet)",
}
_SUNS = {"in-map": "in the map", "apart": "a light of its own"}
_WIDTHS = {"": "as it is", "512": "512 px", "1024": "1024 px", "2048": "2048 px"}
_POLL_S = 0.2


class ProbeExport:
    """The part of Probe library that selects and exports."""

    def __init__(
        self, desk: Desk, work: Work, shelf: Shelf, select: Callable[[Sequence[str]], None]
    ) -> None:
        self._desk, self._work, self._shelf, self._select = desk, work, shelf, select
        self._values: dict[str, str] = {"to": "exr", "sun": "in-map", "width_px": ""}
        self._number = "8"
        self._box = box()
        self._progress = Progress()
        self._notes = box()

    def show(self) -> None:
        """Say how many are ticked, and what can be done with them."""
        self._box.clear()
        self._notes.clear()
        if not self._shelf.entries:
            return
        count = len(self._shelf.selected)
        with self._box, box("panel export"):
            words("h2", f"{count} selected" if count else "Select and export")
            with box("bar-row"):
                button("Select all shown", self._all)
                button("None", lambda: self._select(()), label="Select none")
                text_field("Choose this many that differ most", self._number, self._count_typed,
                           kind="number")  # fmt: skip
                button("Choose", self._choose)
            with box("filters"):
                choice("For", _TARGETS, self._values["to"], lambda v: self._take("to", v))
                choice("The sun", _SUNS, self._values["sun"], lambda v: self._take("sun", v))
                choice("Width", _WIDTHS, self._values["width_px"],
                       lambda v: self._take("width_px", v))  # fmt: skip
            with box("bar-row"):
                export = button("Export the selected", self._export, kind="primary",
                                disabled=not count)  # fmt: skip
                export.props["aria-disabled"] = "false" if count else "true"

    def _take(self, name: str, value: str) -> None:
        self._values[name] = value

    def _count_typed(self, text: str) -> None:
        self._number = text

    def _all(self) -> None:
        self._select([entry.id for entry in self._shelf.entries])

    async def _choose(self) -> None:
        shelf, library = self._shelf, self._shelf.library
        if library is None:
            return

        async def work() -> None:
            if not self._number.isdigit() or int(self._number) < 1:
                raise UsageError("Say how many to choose: a whole number over 0.")
            settings = SelectSettings(count=int(self._number))
            ids = await self._work.in_thread(browsing.choose, library, dict(shelf.typed), settings)
            self._select(ids)

        await self._progress.run(work, "Choosing")

    async def _export(self) -> None:
        library, ids, values = self._shelf.library, tuple(self._shelf.selected), self._values
        if library is None or not ids:
            return
        done: list[None] = []

        async def work() -> None:
            settings = ExportSettings.model_validate(
                {**values, "width_px": int(values["width_px"]) if values["width_px"] else None}
            )
            exporting = asyncio.create_task(
                self._work.in_thread(
                    browsing.export, library, ids, settings, self._desk.room("export"),
                    lambda: done.append(None),
                )
            )  # fmt: skip
            while not exporting.done():
                await asyncio.wait([exporting], timeout=_POLL_S)
                self._progress.at(len(done) / len(ids), f"Exporting: {len(done)} of {len(ids)}")
            content, media_type, name, problems = await exporting
            with self._notes:
                notes(problems, "fail")
            ui.download(self._desk.publish(content, media_type, filename=name), name)

        self._notes.clear()
        await self._progress.run(work, "Exporting")
