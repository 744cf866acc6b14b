"""The page around the three places: where they are chosen, and what each tab owns."""

from collections.abc import Callable
from pathlib import Path

from nicegui import ui

import panokit
from panokit.app.desks import Desk, Desks
from panokit.app.settings import AppSettings
from panokit.app.widgets import box, words
from panokit.app.work import Work

_ASSETS = Path(__file__).parent / "assets"
_TITLES = {
    "lighting": "Lighting from video",
    "expand": "Expand a panorama",
    "probes": "Probe library",
}
_SHORT = {"lighting": "Lighting", "expand": "Expand", "probes": "Probes"}


def add_pages(settings: AppSettings, desks: Desks, work: Work) -> None:
    """Add the page, under an address for each of its places."""

    def page(place: str) -> Callable[[], None]:
        def show() -> None:
            desk = desks.open()
            ui.context.client.on_delete(lambda: desks.close(desk))
            _Shell(settings, desk, work).show(place)

        return show

    ui.page("/", title="panokit")(page("lighting"))
    for place, title in _TITLES.items():
        ui.page(f"/{place}", title=f"{title} · panokit")(page(place))


class _Shell:
    """One tab's page."""

    def __init__(self, settings: AppSettings, desk: Desk, work: Work) -> None:
        self.settings, self.desk, self.work = settings, desk, work
        self._made: set[str] = set()
        ui.add_css((_ASSETS / "app.css").read_text(encoding="utf-8"))
        ui.add_head_html('<meta name="color-scheme" content="light dark">')
        with box("shell"):
            skip = ui.element("a").classes("skip").props('href="#main"')
            with skip:
                words("span", "Skip to the content")
            self._header()
            with box("main", "main") as main:
                main.props["id"] = "main"
                self._places = {place: box("place", "section") for place in _TITLES}
            with box("foot", "footer"):
                words(
                    "p",
                    f"panokit {panokit.__version__} · Everything is computed on this machine; "
                    "nothing leaves it.",
                )

    def _header(self) -> None:
        with box("head", "header"), box("head-inner"):
            words("p", "panokit", "brand")
            nav = box("places", "nav")
            nav.props["aria-label"] = "Places"
            self._links = {}
            with nav:
                for place, title in _TITLES.items():
                    link = ui.element("a").props(f'href="/{place}"')
                    with link:
                        words("span", title, "long")
                        words("span", _SHORT[place], "short")
                    # Another tab, as for any link, if that is asked for; else what is here stays.
                    link.on(
                        "click",
                        lambda _, place=place: self.show(place),
                        js_handler="(e) => { if (e.ctrlKey || e.metaKey || e.shiftKey) return; "
                        f"e.preventDefault(); history.replaceState(null, '', '/{place}'); "
                        f"document.title = '{title} · panokit'; emit(); }}",
                    )
                    self._links[place] = link

    def show(self, place: str) -> None:
        """Show one of the places; it is made when it is first shown, and then kept."""
        if place not in self._made:
            self._made.add(place)
            with self._places[place]:
                self._make(place)
        for name, section in self._places.items():
            section.set_visibility(name == place)
            if name == place:
                self._links[name].props["aria-current"] = "page"
            else:
                self._links[name].props.pop("aria-current", None)
            self._links[name].update()

    def _make(self, place: str) -> None:
        if place == "expand":
            from panokit.app.expand_place import ExpandPlace

            ExpandPlace(self.settings, self.desk, self.work)
        elif place == "probes":
            from panokit.app.probes_place import ProbesPlace

            ProbesPlace(self.settings, self.desk, self.work)
        else:
            from panokit.app.lighting_place import LightingPlace

            LightingPlace(self.settings, self.desk, self.work)
