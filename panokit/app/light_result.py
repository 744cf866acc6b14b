"""What was read: the map, how sure it is, what to mind, relit balls in the frame, and files."""

from collections.abc import Awaitable, Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from nicegui import ui
from nicegui.element import Element

from panokit.app import reading
from panokit.app.desks import Desk
from panokit.app.light_words import estimate_facts
from panokit.app.packing import packed
from panokit.app.progress import Progress
from panokit.app.widgets import (
    box,
    button,
    choice,
    facts,
    image,
    map_frame,
    notes,
    scroll_to,
    words,
)
from panokit.app.work import Work
from panokit.lighting.session import SessionResult

FORMS = {
    "exr": "EXR",
    "hdr": "Radiance HDR",
    "blender": "Blender world",
    "usd": "USD dome light",
    "harmonics": "Harmonics",
    "gltf": "glTF",
    "mitsuba": "Mitsuba scene",
    "all": "Everything",
}
_WIDTHS = {"256": "256 px", "1024": "1024 px, smooth"}


class LightResult:
    """The part of Lighting that shows what came of it."""

    def __init__(
        self, place: Element, desk: Desk, work: Work, another: Callable[[], Awaitable[None]]
    ) -> None:
        self._box, self._desk, self._work, self._another = place, desk, work, another
        self._record: dict[str, Any] | None = None
        self._width_px = 256

    def clear(self) -> None:
        """Nothing was read."""
        self._box.clear()
        self._record = None

    def show(self, result: SessionResult, page: bytes) -> None:
        """Show what was read, in the viewer whose page this is."""
        self.clear()
        address = self._desk.publish(page, "text/html; charset=utf-8", key="light")
        with self._box, box("stage-step", "section"):
            words("h2", "The light")
            with box("two"):
                with box("two-main"):
                    map_frame(address, "The light that was read: look around in it")
                with box("two-side"):
                    self._downloads(result)
                    words("h3", "How sure it is")
                    facts(estimate_facts(result))
                    if result.estimate.warnings:
                        words("h3", "To mind")
                        notes(result.estimate.warnings)
            self._balls = box()
            with box("bar-row"):
                button("Add another object", self._another)
                words("p", "Several objects in the same light are fused into one map.",
                      "small quiet-text")  # fmt: skip
        scroll_to(self._box)

    def show_balls(self, pictures: tuple[bytes, bytes]) -> None:
        """Show the frame as it is, and with relit balls; JPEG."""
        texts = (
            ("frame", "The frame", "The frame as it is"),
            (
                "relit",
                "The frame with two relit balls and their shadows",
                "With a gray and a mirror ball, lit by what was read",
            ),
        )
        self._balls.clear()
        with self._balls:
            words("h3", "Relit balls in the frame")
            with box("pair"):
                for picture, (key, alt, caption) in zip(pictures, texts, strict=True):
                    with box("", "figure"):
                        image(self._desk.publish(picture, "image/jpeg", key=key), alt, "shot")
                        words("figcaption", caption)

    def _downloads(self, result: SessionResult) -> None:
        words("h3", "Download")
        place = box("downloads")

        def choose(width: str) -> None:
            self._width_px, self._record = int(width), None

        choice("Width of the map", _WIDTHS, str(self._width_px), choose)
        state = Progress()

        async def make(form: str) -> None:
            work, desk = self._work, self._desk

            async def write() -> None:
                if self._record is None:
                    self._room = desk.room("light")
                    self._record = await work.in_thread(
                        reading.write_results, result, self._room, self._width_px
                    )
                files = files_of(form, self._record, self._room)
                content, media_type, name = await work.in_thread(packed, files, "light", form)
                ui.download(desk.publish(content, media_type, filename=name), name)

            await state.run(write, "Writing the files")

        with place:
            for form, name in FORMS.items():
                kind = "primary" if form == "exr" else ""
                button(name, partial(make, form), kind=kind, label=f"Download as {name}")


def files_of(form: str, record: dict[str, Any], room: Path) -> Sequence[Path]:
    """Which files of a written result make a download."""
    if form == "all":
        # The archive itself may lie there from before.
        found = sorted(room.rglob("*"))
        return [path for path in found if path.is_file() and path.suffix != ".zip"]
    if form in ("exr", "hdr"):
        return [room / f"light.{form}"]
    if form == "harmonics":
        return sorted(room.glob("light.harmonics-*.json"))
    return [room / name for name in record["tools"][form]]
