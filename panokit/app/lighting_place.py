"""Lighting from video: load it, click an object, and follow it to a second view."""

import asyncio
from collections.abc import Callable
from functools import partial
from itertools import count
from pathlib import Path

from nicegui import ui
from nicegui.element import Element

from panokit.app import reading
from panokit.app.desks import Desk
from panokit.app.drop import Drop
from panokit.app.film import Film, Mode
from panokit.app.insertion import warm_up
from panokit.app.light_result import LightResult
from panokit.app.light_views import LightViews
from panokit.app.progress import Progress
from panokit.app.reading import Reading, Stroke
from panokit.app.settings import AppSettings
from panokit.app.widgets import (
    box,
    button,
    enable,
    fold,
    notes,
    slider,
    text_field,
    words,
)
from panokit.app.work import Work, in_words
from panokit.errors import PanokitError
from panokit.lighting.clip import CLIP_FOV_DEG, clip_path
from panokit.lighting.select import Selection
from panokit.lighting.settings import SessionSettings, SnapshotSettings
from panokit.lighting.track import TrackedFrame

_DROP = {
    "title": "Drop a video here",
    "hint": "The camera moves sideways past an object that stands free. MP4, MOV, WebM, MKV or "
    "AVI; or a folder of frames.",
    "button": "Choose a video",
    "folderButton": "Choose a folder of frames",
}
_HINT = "film-keys"
_KEYS = (
    "With the keyboard: the arrow keys move a cursor (with Shift a little), Enter clicks with it, "
    "space plays, comma and period step a frame."
)
_MODES: dict[Mode, str] = {"pick": "Select", "add": "Add", "remove": "Remove"}
_POLL_S = 0.15
# Where the object was in the last frames; an hour of boxes would be slow to send.
_BOXES = 400
_SLIDER = {"low": 2.0, "high": 60.0, "step": 1.0}


class LightingPlace:
    """One tab's view of it."""

    def __init__(self, settings: AppSettings, desk: Desk, work: Work) -> None:
        self.settings, self.desk, self.work = settings, desk, work
        self.reading: Reading | None = None
        self._numbers = count(1)
        self._held = {"fov_deg": CLIP_FOV_DEG, "pitch_deg": 0.0, "roll_deg": 0.0}
        self._wanted: float | None = None
        self._sliding = False
        words("h1", "Lighting from video")
        words(
            "p",
            "Click an object in a video whose camera moves sideways past it. Two views of it tell "
            "what light falls on it, from everywhere: an HDR environment map.",
            "lead",
        )
        self._input()
        self._progress = Progress()
        self._stage = box("result")
        views, result = box(), box()
        self.result = LightResult(result, desk, work, self._begin_another)
        self.views = LightViews(views, settings, desk, work, lambda: self.reading, self.result)

    def _input(self) -> None:
        with box("split-input"):
            with box():
                Drop(self.desk, "video", _DROP, self.open, self._fail)
            with box("options", "fieldset"):
                words("legend", "Or")
                if clip_path().is_file():
                    button("Take the sample clip", self._sample)
                self._path = text_field(
                    "Path on this machine", "", self._open_path,
                    placeholder="/videos/vase.mp4 or a folder",
                )  # fmt: skip
                with fold("How the camera was held"):
                    for name, label in (
                        ("fov_deg", "Field of view across, degrees"),
                        ("pitch_deg", "Looking up by, degrees"),
                        ("roll_deg", "Leaning right by, degrees"),
                    ):
                        text_field(
                            label, f"{self._held[name]:g}",
                            partial(self._hold, name), kind="number",
                        )  # fmt: skip

    def _fail(self, text: str) -> None:
        self._progress.fail(text)

    def session_settings(self) -> SessionSettings:
        """How to read, with what is known of the camera."""
        model = self.settings.lighting_model or SessionSettings().model
        return SessionSettings(model=model, snapshot=SnapshotSettings(**self._held))

    def _hold(self, name: str, text: str) -> None:
        before = dict(self._held)
        try:
            self._held[name] = float(text)
            settings = self.session_settings()
        except ValueError:
            self._held = before
            self._fail(
                f"{text!r} cannot be. The field of view is over 5 and under 150 degrees, the pitch "
                "between -90 and 90, the roll too."
            )
            return
        self._progress.clear()
        if self.reading is not None:
            # Views that were cut out for another camera are not true any more.
            self.reading.settings, self.reading.found = settings, None
            self._after_change()

    async def _sample(self) -> None:
        await self.open(clip_path(), "The sample clip")

    async def _open_path(self, text: str) -> None:
        if text.strip():
            path = Path(text.strip()).expanduser()
            await self.open(path, path.name)

    async def open(self, path: Path, name: str) -> None:
        """Open a video or a folder of frames."""

        async def work() -> None:
            self.reading = await self.work.in_thread(Reading, path, self.session_settings())
            self._show_film(name)
            self._warm()

        if not self._progress.busy:
            self._leave()
            await self._progress.run(work, "Opening the video")

    def _warm(self) -> None:
        """Load what is needed later while the object is being chosen; errors are told then."""

        async def load() -> None:
            try:
                model = reading.chosen_model(self.settings.lighting_model)
                await self.work.in_thread(reading.loaded_model, model)
                await self.work.in_thread(warm_up)
            except PanokitError:
                return

        self._warming = asyncio.create_task(load())

    def _leave(self) -> None:
        """Everything of the video before is gone."""
        if self.reading is not None:
            self.reading.close()
        self.reading = None
        self._stage.clear()
        self.views.clear()
        self.result.clear()
        for kind in [kind for kind in self.desk.pictures if kind.startswith(("film", "view"))]:
            del self.desk.pictures[kind]

    def _show_film(self, name: str) -> None:
        if self.reading is None:
            return
        frames = self.reading.frames
        kind = f"film{next(self._numbers)}"
        self.desk.pictures[kind] = self.reading.jpeg
        with self._stage, box("two"):
            with box("two-main"):
                words("h2", name)
                self.film = Film(
                    f"/desk/{self.desk.token}/picture/{kind}",
                    frames.count,
                    frames.size_px,
                    name,
                    fps=frames.fps,
                    hint_id=_HINT,
                )
                self.film.on_pick(self._pick)
                self.film.on_stroke(self._stroke)
            with box("two-side"):
                self._panel = box("panel")
                self._show_panel(None)
        self._following = Progress()

    def _show_panel(self, selection: Selection | None) -> None:
        self._panel.clear()
        with self._panel:
            if selection is None:
                words("h2", "Click the object")
                words("p", "One object of one material, not cut off by the frame, before a "
                      "background of other colors. Click it early in the video.")  # fmt: skip
            else:
                words("h2", "Is this the object?")
                self._tolerance = slider(
                    "Tolerance", **_SLIDER, value=round(max(selection.tolerance, 2)),
                    take=self._tolerate,
                )  # fmt: skip
                self._mode_buttons()
                self._problem = box()
                self._follow_button = button("Follow the object", self._follow, kind="primary")
                self._tell(selection)
            words("p", _KEYS, "small quiet-text").props(f'id="{_HINT}"')

    def _mode_buttons(self) -> None:
        made: dict[Mode, Element] = {}

        def choose(mode: Mode) -> None:
            self.film.set_mode(mode)
            for one, element in made.items():
                element.props["aria-pressed"] = "true" if one == mode else "false"
                element.update()

        with box("buttons").props('role="group" aria-label="What a click does"'):
            for mode, text in _MODES.items():
                made[mode] = button(text, partial(choose, mode))
        choose("pick")

    def _tell(self, selection: Selection) -> None:
        self._problem.clear()
        with self._problem:
            if selection.problem:
                notes([selection.problem], "fail")
            elif selection.touches_edge:
                notes(["The object is cut off by the frame. Take a frame that shows it whole."])
        enable(self._follow_button, on=not selection.problem)

    async def _pick(self, frame: int, x: float, y: float) -> None:
        current = self.reading
        if current is None or self._following.busy:
            return
        self._after_change()
        await self._selected(lambda: current.click(frame, (x, y)), anew=True)

    async def _tolerate(self, tolerance: float) -> None:
        """The slider moves on while a mask is made: the last place counts."""
        current = self.reading
        self._wanted = tolerance
        if self._sliding or current is None or self._following.busy:
            return
        self._sliding = True
        try:
            while self._wanted is not None:
                wanted, self._wanted = self._wanted, None
                self._after_change()
                await self._selected(partial(current.tolerate, wanted))
        finally:
            self._sliding = False

    async def _stroke(self, stroke: Stroke) -> None:
        current = self.reading
        if current is not None and not self._following.busy:
            self._after_change()
            await self._selected(lambda: current.edit(stroke))

    async def _selected(self, select: Callable[[], Selection], *, anew: bool = False) -> None:
        try:
            selection = await self.work.in_thread(select)
            png = await self.work.in_thread(reading.overlay, selection.mask)
        except PanokitError as error:
            self._following.fail(in_words(error))
            return
        first = self.reading.first if self.reading else None
        if first is None:
            return
        self.film.set_mask(self.desk.publish(png, "image/png", key="mask"), first.number)
        if anew:
            self._show_panel(selection)
        else:
            self._tell(selection)

    def _after_change(self) -> None:
        """Another object: what came of the one before is not true any more."""
        self._following.clear()
        self.film.set_boxes({})
        self.views.clear()
        self.result.clear()

    async def _follow(self) -> None:
        current = self.reading
        if current is None:
            return
        seen: list[TrackedFrame] = []

        async def work() -> None:
            following = asyncio.create_task(self.work.in_thread(current.follow, seen.append))
            shown = 0
            while not following.done():
                await asyncio.wait([following], timeout=_POLL_S)
                if len(seen) > shown:
                    shown = len(seen)
                    self._show_seen(seen)
            self._show_seen(seen)
            found = await following
            self.film.show(found.pair.right.number)
            self.views.show()

        with self._panel:
            stop = button("Stop", current.stop.set, kind="quiet")
        enable(self._follow_button, on=False)
        try:
            await self._following.run(work, "Following the object")
        finally:
            stop.delete()
            enable(self._follow_button, on=True)

    def _show_seen(self, seen: list[TrackedFrame]) -> None:
        if not seen or self.reading is None:
            return
        self.film.set_boxes(
            {
                one.number: (one.box.x, one.box.y, one.box.width, one.box.height, one.state)
                for one in seen[-_BOXES:]
            }
        )
        last = seen[-1].number
        self.film.show(last)
        self._following.at((last + 1) / self.reading.frames.count, f"Following: frame {last + 1}")

    async def _begin_another(self) -> None:
        """Keep what was read, and select another object in the same video."""
        if self.reading is None:
            return
        self.reading.keep_and_go_on()
        self.film.set_mask("", -1)
        self._after_change()
        self._show_panel(None)
        ui.run_javascript("window.scrollTo({ top: 0, behavior: 'smooth' })")
