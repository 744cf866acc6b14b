"""Make the picture of a report from the run of `panokit demo`; needs the extra `browser`.

python docs/pictures/make_report.py demo/qa/report.html docs/pictures/report.jpg
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

MAP = "#map-panoramax-figtree-place-7-002"
WEBGL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]


def main(report, out):
    with sync_playwright() as playwright:
        program = shutil.which("chromium") or shutil.which("google-chrome")
        browser = playwright.chromium.launch(executable_path=program, args=WEBGL)
        page = browser.new_page(viewport={"width": 1280, "height": 860})
        page.goto(Path(report).resolve().as_uri() + MAP)
        page.wait_for_selector("#view[data-drawn]", timeout=60_000)
        # Toward the sun, two stops down, against the photograph.
        for key in ["ArrowLeft"] * 30 + ["ArrowUp"] * 5 + ["c"] * 2 + ["["] * 2:
            page.keyboard.press(key)
        page.wait_for_timeout(3000)
        page.screenshot(path=out, type="jpeg", quality=84)
        browser.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
