"""Expand a panorama: drop one, look around in its light, compare methods, download it."""

from functools import partial
from pathlib import Path

from nicegui import ui

from panokit.app import expanding
from panokit.app.desks import Desk
from panokit.app.drop import Drop
from panokit.app.expanding import Expanded, Filled
from panokit.app.packing import packed
from panokit.app.progress import Progress
from panokit.app.settings import AppSettings
from panokit.app.widgets import (
    box,
    button,
    check,
    choice,
    facts,
    fold,
    image,
    map_frame,
    words,
)
from panokit.app.work import Work
from panokit.errors import PanokitError
from panokit.expand.settings import ExpandSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.synthetic.embedded import embedded_city

_WIDTHS = {"512": "512 px", "1024": "1024 px", "2048": "2048 px"}
_DROP = {
    "title": "Drop a 360° panorama here",
    "hint": "An equirectangular JPEG, PNG, WebP or TIFF, twice as wide as high.",
    "button": "Choose a picture",
}


class ExpandPlace:
    """One tab's view of it."""

    def __init__(self, settings: AppSettings, desk: Desk, work: Work) -> None:
        self.desk, self.work = desk, work
        self.model, self.width_px, self.fill = settings.model, 1024, True
        self.source: Path | None = None
        self.name = self.license = ""
        self.filled: Filled | None = None
        self.maps: dict[str, Expanded] = {}
        self.compared: set[str] = set()
        self._models = expanding.expansion_models()
        words("h1", "Expand a panorama")
        words(
            "p",
            "An ordinary 360° photograph becomes an HDR light map: what the camera did not see is "
            "filled, and the light that its white clipped is recovered.",
            "lead",
        )
        self._input = box()
        with self._input:
            self._drop()
        self._progress = Progress()
        self._result = box("result")

    def _drop(self) -> None:
        with box("split-input"):
            Drop(self.desk, "picture", _DROP, self._take, self._progress_fail)
            with box("options", "fieldset"):
                words("legend", "How")
                choice("Method", self._models, self.model, self._choose_model)
                choice("Width of the map", _WIDTHS, str(self.width_px), self._choose_width)
                check("Find holes and fill them", value=self.fill, take=self._choose_fill)
                button("Take the sample instead", self._sample, kind="quiet")

    def _progress_fail(self, text: str) -> None:
        self._progress.fail(text)

    async def _sample(self) -> None:
        picture = embedded_city()[0]
        terms = picture.capture.license
        said = f"{terms.id}. {terms.attribution}".strip()
        await self._take(picture.image, "A square of the embedded city", said)

    async def _take(self, source: Path, name: str, license: str = "") -> None:
        self.source, self.name, self.license = source, name, license
        self.filled, self.maps, self.compared = None, {}, set()
        self._result.clear()
        await self._again()

    async def _choose_model(self, model: str) -> None:
        self.model = model
        await self._again()

    async def _choose_width(self, width: str) -> None:
        self.width_px = int(width)
        self.maps = {}
        await self._again()

    async def _choose_fill(self, fill: bool) -> None:
        self.fill, self.filled, self.maps = fill, None, {}
        await self._again()

    async def _compare(self, model: str, on: bool) -> None:
        (self.compared.add if on else self.compared.discard)(model)
        await self._again()

    async def _again(self) -> None:
        if self.source is not None and not self._progress.busy:
            await self._progress.run(self._compute, "Working")

    def _wanted(self) -> tuple[object, ...]:
        """What is to be shown, as it is chosen now."""
        return self.source, self.model, self.width_px, self.fill, frozenset(self.compared)

    async def _compute(self) -> None:
        """Everything that is not there yet; again, if something else was chosen meanwhile."""
        while True:
            wanted = self._wanted()
            try:
                await self._compute_once(wanted)
            except PanokitError:
                # What was wrong with a picture that was replaced is not told any more.
                if wanted == self._wanted():
                    raise
            if wanted == self._wanted():
                return

    async def _compute_once(self, wanted: tuple[object, ...]) -> None:
        source, filled, maps = self.source, self.filled, dict(self.maps)
        if source is None:
            return
        step, run = self._progress.step, self.work.in_process
        if filled is None:
            step("Looking for holes and filling them" if self.fill else "Reading the panorama")
            holes = InpaintSettings() if self.fill else None
            filled = await run(expanding.fill_holes, source, self.desk.room("filled"), holes)
        compared = sorted(self.compared)
        for model in [self.model, *compared]:
            if wanted != self._wanted():
                return
            if model not in maps:
                step(f"Expanding with {self._models[model]}")
                settings = ExpandSettings(model=model, width_px=self.width_px)
                folder = self.desk.folder / "maps"
                folder.mkdir(exist_ok=True)
                maps[model] = await run(expanding.expand_picture, filled.path, folder, settings)
        if wanted != self._wanted():
            return
        self.filled, self.maps = filled, maps
        step("Preparing the viewer")
        shown = maps[self.model]
        others = [maps[one] for one in compared if one != shown.model]
        page = await run(expanding.viewer_page, shown, others, filled.path, self.name)
        if wanted == self._wanted():
            self._show(filled, shown, page)

    def _show(self, filled: Filled, shown: Expanded, page: bytes) -> None:
        address = self.desk.publish(page, "text/html; charset=utf-8", key="expanded")
        self._result.clear()
        with self._result, box("two"):
            with box("two-main"):
                words("h2", self.name)
                map_frame(address, f"{self.name}: look around in the light map")
                self._comparison()
            with box("two-side"):
                self._downloads(shown)
                words("h3", "What was found")
                facts(expanding.expansion_facts(shown.values))
                self._holes(filled)
                words("h3", "License")
                words("p", self._license(filled), "small")

    def _comparison(self) -> None:
        with box("compare", "fieldset"):
            words("legend", "Compare with")
            for model, name in self._models.items():
                if model != self.model:
                    check(
                        name,
                        value=model in self.compared,
                        take=partial(self._compare, model),
                    )
        words(
            "p",
            "What is ticked, and the photograph itself, can be chosen under Compare in the viewer.",
            "small quiet-text",
        )

    def _holes(self, filled: Filled) -> None:
        words("h3", "Holes")
        if not self.fill:
            words("p", "Holes were not looked for.", "small")
            return
        for sentence in expanding.hole_sentences(filled):
            words("p", sentence, "small")
        if filled.before:
            before = self.desk.publish(filled.before, "image/jpeg", key="before")
            after = self.desk.publish(filled.after, "image/jpeg", key="after")
            with fold("Before and after"):
                image(before, "The panorama; what was filled is outlined", "shot")
                image(after, "The panorama after filling", "shot")

    def _downloads(self, shown: Expanded) -> None:
        words("h3", "Download")
        place = box("downloads")
        state = Progress()
        stem = f"{Path(self.source or 'map').stem}-{shown.model}"

        async def make(form: str) -> None:
            async def work() -> None:
                room = self.desk.room(f"form-{form}")
                files = await self.work.in_process(
                    expanding.write_forms, shown.path, stem, form, room
                )
                content, media_type, filename = await self.work.in_thread(packed, files, stem, form)
                ui.download(self.desk.publish(content, media_type, filename=filename), filename)

            await state.run(work, f"Writing {expanding.FORMS[form]}")

        with place:
            for form, name in expanding.FORMS.items():
                kind = "primary" if form == "exr" else ""
                button(name, partial(make, form), kind=kind, label=f"Download as {name}")

    def _license(self, filled: Filled) -> str:
        if self.license:
            return self.license
        if filled.license == "unknown":
            return "Not known: the picture says nothing of it. Whoever took it decides."
        return f"{filled.license}. {filled.attribution}".strip()
