"""The two snapshots side by side, to be confirmed, or corrected with a brush."""

from collections.abc import Callable
from functools import partial
from itertools import count

from nicegui.element import Element

from panokit.app import reading
from panokit.app.desks import Desk
from panokit.app.film import Film, Mode
from panokit.app.light_result import LightResult
from panokit.app.progress import Progress
from panokit.app.reading import SIDES, Reading, Stroke
from panokit.app.settings import AppSettings
from panokit.app.widgets import box, button, notes, scroll_to, words
from panokit.app.work import Work, in_words
from panokit.errors import PanokitError
from panokit.lighting.snapshots import StereoPair

_MODES: dict[Mode, str] = {"look": "Look", "add": "Add to the mask", "remove": "Remove from it"}


class LightViews:
    """The part of Lighting that shows two views of an object."""

    def __init__(
        self,
        place: Element,
        settings: AppSettings,
        desk: Desk,
        work: Work,
        current: Callable[[], Reading | None],
        result: LightResult,
    ) -> None:
        self._box, self._desk, self._work = place, desk, work
        self._settings, self._current, self._result = settings, current, result
        self._numbers = count(1)
        self._films: dict[str, Film] = {}

    def clear(self) -> None:
        """Nothing was followed."""
        self._box.clear()
        self._films = {}

    def show(self) -> None:
        """Show the snapshots that were found."""
        current = self._current()
        found = current and current.found
        if not found:
            return
        self.clear()
        with self._box, box("stage-step", "section"):
            words("h2", "Do both views show the object?")
            words(
                "p",
                "The masks should cover the object and nothing else. Draw over a view to add to "
                "its mask or to remove from it.",
                "lead",
            )
            with box("pair"):
                for side in SIDES:
                    self._view(side, found.pair)
            self._tools()
            self._notes = box()
            self._tell(found.warnings)
            self._reading = Progress()
            with box("bar-row"):
                button("Read the light", self._read, kind="primary")
        scroll_to(self._box)

    def _view(self, side: str, pair: StereoPair) -> None:
        snapshot = getattr(pair, side)
        kind = f"view-{side}-{next(self._numbers)}"
        picture = reading.snapshot_jpeg(snapshot)
        self._desk.pictures[kind] = lambda _: picture
        size = (snapshot.picture.shape[1], snapshot.picture.shape[0])
        with box("", "figure"):
            film = Film(
                f"/desk/{self._desk.token}/picture/{kind}", 1, size, f"The {side} view", mode="look"
            )
            self._films[side] = film

            async def drawn(stroke: Stroke) -> None:
                await self._drawn(side, stroke)

            film.on_stroke(drawn)
            words("figcaption", f"{side.capitalize()} view, frame {snapshot.number + 1}")
        self._show_mask(side, pair)

    def _show_mask(self, side: str, pair: StereoPair) -> None:
        png = reading.overlay(getattr(pair, side).selection.mask)
        self._films[side].set_mask(self._desk.publish(png, "image/png", key=f"mask-{side}"), 0)

    def _tools(self) -> None:
        made: dict[Mode, Element] = {}

        def choose(mode: Mode) -> None:
            for film in self._films.values():
                film.set_mode(mode)
            for one, element in made.items():
                element.props["aria-pressed"] = "true" if one == mode else "false"
                element.update()

        with box("bar-row buttons").props('role="group" aria-label="What a pointer does"'):
            for mode, text in _MODES.items():
                made[mode] = button(text, partial(choose, mode))
        choose("look")

    def _tell(self, warnings: tuple[str, ...]) -> None:
        self._notes.clear()
        with self._notes:
            notes(warnings)

    async def _drawn(self, side: str, stroke: Stroke) -> None:
        current = self._current()
        if current is None or self._reading.busy:
            return
        self._result.clear()
        try:
            pair = await self._work.in_thread(current.edit_view, side, stroke)
        except PanokitError as error:
            self._reading.fail(in_words(error))
            return
        self._reading.clear()
        for one in SIDES:
            self._show_mask(one, pair)
        self._tell(current.found.warnings if current.found else pair.warnings)

    async def _read(self) -> None:
        current, work = self._current(), self._work
        if current is None:
            return

        async def read() -> None:
            name = reading.chosen_model(self._settings.lighting_model)
            model = await work.in_thread(reading.loaded_model, name)
            self._reading.step("Reading the light")
            result = await work.in_thread(current.read, model)
            self._result.show(result, await work.in_thread(reading.light_page, result.estimate))
            self._reading.step("Lighting two balls")
            self._result.show_balls(await work.in_thread(current.shown, result))

        self._result.clear()
        await self._reading.run(read, "Loading the model")
