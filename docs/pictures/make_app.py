"""Pictures of the application for its page in the docs.

    panokit app --no-show --library LIB
    python docs/pictures/make_app.py http://127.0.0.1:8710

Needs the extra `browser` and a Chromium on the path.
"""

import io
import shutil
import sys
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

from panokit.lighting.clip import CLIP_CLICK

HERE = Path(__file__).parent
GL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox")
PATIENCE_MS = 120_000


def shot(page: Page, name: str, height: int) -> None:
    """What is in the window, as a small JPEG."""
    page.set_viewport_size({"width": page.viewport_size["width"], "height": height})
    page.wait_for_timeout(1500)
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    if picture.width > 1000:
        picture = picture.resize((1000, round(1000 * picture.height / picture.width)))
    picture.save(HERE / f"{name}.jpg", quality=80, optimize=True)


def wait_for_map(page: Page) -> None:
    page.frame_locator("iframe:visible").locator("#view[data-drawn]").wait_for()


def light(page: Page, address: str) -> None:
    page.goto(f"{address}/lighting")
    page.get_by_role("button", name="Take the sample clip").click()
    page.locator(".film-bar input").fill(str(CLIP_CLICK.frame))
    page.get_by_text(f"{CLIP_CLICK.frame + 1} / ").wait_for()
    stage = page.locator(".film-stage")
    box = stage.bounding_box()
    place = {
        "x": CLIP_CLICK.column / 640 * box["width"],
        "y": CLIP_CLICK.row / 360 * box["height"],
    }
    stage.click(position=place)
    page.locator(".film-mask").wait_for()
    page.evaluate("scrollTo(0, 0)")


def read(page: Page) -> None:
    page.get_by_role("button", name="Follow the object").click()
    page.get_by_role("button", name="Read the light").click()
    wait_for_map(page)
    page.get_by_text("With a gray and a mirror ball").wait_for()
    page.evaluate("document.querySelectorAll('.stage-step')[1].scrollIntoView()")


def main(address: str) -> None:
    with sync_playwright() as run:
        browser = run.chromium.launch(executable_path=shutil.which("chromium"), args=list(GL))
        page = browser.new_page(viewport={"width": 1280, "height": 1000})
        page.set_default_timeout(PATIENCE_MS)
        light(page, address)
        shot(page, "app-lighting", 1000)
        read(page)
        shot(page, "app-light", 1230)
        page.goto(f"{address}/expand")
        page.get_by_role("button", name="Take the sample instead").click()
        wait_for_map(page)
        page.evaluate("scrollTo(0, 0)")
        shot(page, "app-expand", 1240)
        page.goto(f"{address}/probes")
        page.locator(".card img").first.wait_for()
        shot(page, "app-probes", 1120)
        page = browser.new_page(viewport={"width": 390, "height": 844}, device_scale_factor=1.5)
        page.set_default_timeout(PATIENCE_MS)
        light(page, address)
        page.evaluate("document.querySelector('.two h2').scrollIntoView()")
        shot(page, "app-phone", 844)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1].rstrip("/"))
