"""A headless Chromium with a software WebGL2, and pages to open in it.

    make test-browser

Tests skip where there is no Chromium (PANOKIT_CHROMIUM names one that is not on the path) or no
playwright. Nothing may be asked of any server, and no test may leave an error in the console.
"""

import os
import shutil

import numpy as np
import pytest

from panokit.envmap import Anchor, EnvironmentMap
from panokit.sphere import equirect_directions

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
ARGUMENTS = (
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-sandbox",
)
# Ahead, to the right, behind, to the left, above.
PATCHES = (
    ((0, 0, -1), (0.5, 0.02, 0.02)),
    ((1, 0, 0), (0.02, 0.25, 0.02)),
    ((0, 0, 1), (20000, 20000, 20000)),
    ((-1, 0, 0), (0.02, 0.02, 0.6)),
    ((0, 1, 0), (0.9, 0.9, 0.9)),
)


def pytest_collection_modifyitems(items):
    for item in items:
        if "browser" in item.path.parts:
            item.add_marker(pytest.mark.browser)


@pytest.fixture(scope="session")
def chromium():
    playwright = pytest.importorskip("playwright.sync_api", reason="needs the browser extra")
    found = os.environ.get("PANOKIT_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip("there is no Chromium; name one with PANOKIT_CHROMIUM")
    with playwright.sync_playwright() as run:
        browser = run.chromium.launch(executable_path=found, args=list(ARGUMENTS))
        yield browser
        browser.close()


class Tab:
    """A page in the browser, with what it asked for and what it complained about."""

    def __init__(self, context, script=""):
        self.page = context.new_page()
        self.requests, self.complaints = [], []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("console", lambda m: m.type == "error" and self.complaints.append(m.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        if script:
            self.page.add_init_script(script)

    def settle(self):
        """Until two pictures have been drawn after what was done before."""
        self.page.evaluate(
            "() => new Promise((done) => setTimeout(() => requestAnimationFrame(() => "
            "requestAnimationFrame(() => setTimeout(done, 30))), 30))"
        )

    def wait_for(self, script, seconds=10):
        """Until an expression is true; the page's policy allows no polling of its own."""
        for _ in range(int(seconds / 0.05)):
            if self.page.evaluate(f"() => Boolean({script})"):
                return
            self.page.wait_for_timeout(50)
        raise AssertionError(f"never true: {script}")

    def open_map(self, number=0):
        self.page.locator(".card:not([hidden]) .open").nth(number).click()
        self.wait_drawn()

    def wait_drawn(self):
        drawn = "document.getElementById('view').dataset.drawn"
        self.wait_for(drawn)
        self.settle()

    def press(self, *keys):
        for key in keys:
            self.page.keyboard.press(key)
        self.settle()

    def slide(self, name, value):
        """Move a slider as a script for assistive technology would."""
        self.page.locator(f"#{name}").fill(str(value))
        self.settle()

    def pixel(self, u=0.5, v=0.5):
        """The display value, 0 to 255, at shares of the picture's width and height."""
        return np.array(
            self.page.evaluate(
                "([u, v]) => { const c = document.getElementById('view');"
                "return [...c.getContext('2d').getImageData("
                "Math.floor(u * c.width), Math.floor(v * c.height), 1, 1).data]; }",
                [u, v],
            )
        )

    def light(self, u=0.5, v=0.5):
        """The linear radiance that a pixel shows, at the exposure set."""
        encoded = self.pixel(u, v)[:3] / 255
        return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


@pytest.fixture
def open_tab(chromium, tmp_path):
    """Open a page of sections at a size; afterwards nothing was asked and nothing was wrong."""
    from panokit.report import write_page

    tabs, contexts = [], []

    def make(page, *, width=1000, height=620, script="", hash="", **options):
        path = write_page(page, tmp_path / f"report-{len(tabs)}.html")
        context = chromium.new_context(
            viewport={"width": width, "height": height}, offline=True, **options
        )
        tab = Tab(context, script)
        tab.page.goto(path.as_uri() + hash)
        contexts.append(context)
        tabs.append(tab)
        return tab

    yield make
    for context in contexts:
        context.close()
    for tab in tabs:
        asked = [u for u in tab.requests[1:] if not u.startswith(("data:", "blob:"))]
        assert not asked
        assert not tab.complaints


@pytest.fixture
def patches():
    """Gray, with a patch of its own color on each axis; a sun of 20000 is behind."""
    directions = equirect_directions(256, 128)
    radiance = np.full((128, 256, 3), 0.18, np.float32)
    for toward, color in PATCHES:
        radiance[directions @ np.array(toward) > np.cos(np.deg2rad(15))] = color
    return EnvironmentMap(radiance=radiance, anchor=Anchor.LDR_WHITE)


@pytest.fixture
def east():
    """Dark, with one lamp in the east."""
    directions = equirect_directions(256, 128)
    radiance = np.full((128, 256, 3), 0.05, np.float32)
    radiance[directions @ np.array([1, 0, 0]) > np.cos(np.deg2rad(10))] = (60, 50, 30)
    return EnvironmentMap(radiance=radiance, anchor=Anchor.LDR_WHITE)
