"""The application as its users drive it: a video to light, a panorama to a map, the library."""

import re
import subprocess
import sys
import time
import zipfile
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.io import encode_jpeg, encode_png, read_environment_map, read_exr
from panokit.lighting import SessionSettings, light_from_video, open_frames
from panokit.lighting.clip import CLIP_CLICK, clip_path
from panokit.lighting.representations import square_radiance
from panokit.probes import Library
from panokit.reflectance.mirroring import direction_difference_deg

pytest.importorskip("nicegui", reason="needs the app extra")

# Generous: software WebGL and networks share a busy machine's cores.
PATIENCE_MS = 120_000
TRUTH = Path(__file__).parent.parent / "lighting" / "clip_truth.exr"
# By how much the mean of all training maps is off on the clip; see docs/commands/lighting.md.
MEAN_MAP_OFF_DEG = 63.0
SIZES = {"desktop": (1280, 900), "phone": (390, 844)}


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("library")
    rng = np.random.default_rng(0)
    with Library.create(folder) as shelves:
        for name, category in (("quay", "outdoor_sunny"), ("hall", "indoor")):
            radiance = rng.uniform(0.1, 0.5, (64, 128, 3)).astype(np.float32)
            radiance[10, 30] = 400
            shelves.add(EnvironmentMap(radiance=radiance), name=name, category=category)
    return folder


@pytest.fixture(scope="module")
def address(library, tmp_path_factory):
    run = subprocess.Popen(
        [sys.executable, "-m", "panokit", "app", "--no-show", "--port", "18810",
         "--library", str(library)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        cwd=tmp_path_factory.mktemp("app"),
    )  # fmt: skip
    try:
        said = run.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+/", said)
        assert found, said
        yield found[0]
    finally:
        run.terminate()
        rest, _ = run.communicate(timeout=120)
        # Nothing happened that the application did not foresee.
        assert "Traceback" not in rest, rest


@pytest.fixture
def visit(chromium, address):
    """Open one of the places; afterwards nothing was asked elsewhere and nothing was wrong."""
    contexts, requests, complaints = [], [], []

    def make(place, size="desktop"):
        width, height = SIZES[size]
        context = chromium.new_context(viewport={"width": width, "height": height})
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.on("request", lambda request: requests.append(request.url))
        page.on("websocket", lambda socket: requests.append(socket.url))
        page.on("console", lambda m: m.type == "error" and complaints.append(m.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(address + place)
        return page

    yield make
    for context in contexts:
        context.close()
    own = tuple(address.replace("http", scheme, 1) for scheme in ("http", "ws"))
    foreign = [u for u in requests if not u.startswith((*own, "data:", "blob:"))]
    assert not foreign
    assert not complaints


def press(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def click_in_frame(page, column, row):
    """Click a pixel of the film's frame, wherever and however large it is shown."""
    stage = page.locator(".film-stage").first
    stage.scroll_into_view_if_needed()
    box = stage.bounding_box()
    stage.click(position={"x": box["width"] * column / 640, "y": box["height"] * row / 360})


@contextmanager
def downloaded(page, name, folder):
    with page.expect_download() as waiting:
        press(page, name)
    path = folder / waiting.value.suggested_filename
    waiting.value.save_as(path)
    yield path


def is_within(page):
    """Nothing is wider than the window."""
    return page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")


def wait_for_map(page):
    page.frame_locator("iframe:visible").locator("#view[data-drawn]").wait_for()


def open_clip(page):
    press(page, "Take the sample clip")
    page.locator(".film-bar input").fill(str(CLIP_CLICK.frame))
    page.get_by_text(f"{CLIP_CLICK.frame + 1} / ").wait_for()


@pytest.mark.parametrize("size", SIZES)
def test_a_click_in_a_video_becomes_an_environment_map(visit, size, tmp_path):
    page = visit("lighting", size)
    open_clip(page)
    click_in_frame(page, CLIP_CLICK.column, CLIP_CLICK.row)
    page.get_by_text("Is this the object?").wait_for()
    page.locator(".film-mask").wait_for()
    press(page, "Follow the object")
    page.get_by_text("Do both views show the object?").wait_for()
    assert page.locator(".pair .film-mask").count() == 2
    press(page, "Read the light")
    wait_for_map(page)
    page.get_by_text("With a gray and a mirror ball").wait_for()
    assert is_within(page)
    with downloaded(page, "Download as EXR", tmp_path) as path:
        radiance = read_environment_map(path).radiance
    assert radiance.shape == (128, 256, 3)
    assert np.isfinite(radiance).all()
    off = direction_difference_deg(square_radiance(radiance), read_exr(TRUTH)[0])
    print(f"light off by {off:.1f} degrees")
    assert off < MEAN_MAP_OFF_DEG
    if size == "desktop":
        # The pages add nothing of their own to what the functions say.
        theirs = light_from_video(
            open_frames(clip_path()), [CLIP_CLICK], SessionSettings()
        ).estimate
        assert direction_difference_deg(square_radiance(radiance), theirs.radiance) < 5
    for name, ending in (
        ("Download as Radiance HDR", ".hdr"), ("Download as Blender world", ".zip"),
        ("Download as USD dome light", ".zip"), ("Download as Harmonics", ".zip"),
    ):  # fmt: skip
        with downloaded(page, name, tmp_path) as path:
            assert path.suffix == ending
            assert path.stat().st_size > 0


def test_the_tolerance_changes_the_mask_at_once(visit):
    page = visit("lighting")
    open_clip(page)
    click_in_frame(page, CLIP_CLICK.column, CLIP_CLICK.row)
    page.locator(".film-mask").wait_for()
    seen = set()
    for tolerance in (3, 20, 45):
        before = page.locator(".film-mask").get_attribute("src")
        page.get_by_label("Tolerance").fill(str(tolerance))
        page.wait_for_function(
            "before => document.querySelector('.film-mask')?.getAttribute('src') !== before",
            arg=before,
        )
        seen.add(page.locator(".film-mask").get_attribute("src"))
    assert len(seen) == 3


def test_the_background_is_told_and_not_followed(visit):
    page = visit("lighting")
    open_clip(page)
    click_in_frame(page, 80, 120)  # a wall
    page.locator(".panel .notice.fail").wait_for()
    assert page.get_by_role("button", name="Follow the object").is_disabled()


def test_the_keyboard_alone_selects_and_plays(visit):
    page = visit("lighting")
    open_clip(page)
    page.locator(".film-stage").focus()
    for key in ["ArrowRight"] * 6 + ["Enter"]:
        page.keyboard.press(key)
    page.get_by_text("Is this the object?").wait_for()
    page.keyboard.press(".")
    page.get_by_text(f"{CLIP_CLICK.frame + 2} / ").wait_for()
    page.keyboard.press("Space")
    page.get_by_role("button", name="Pause").wait_for()
    page.keyboard.press("Space")
    page.get_by_role("button", name="Play").wait_for()


def test_masks_are_corrected_by_hand_before_the_light_is_read(visit):
    page = visit("lighting")
    open_clip(page)
    click_in_frame(page, CLIP_CLICK.column, CLIP_CLICK.row)
    page.locator(".film-mask").wait_for()
    press(page, "Follow the object")
    page.get_by_text("Do both views show the object?").wait_for()
    press(page, "Add to the mask")
    view = page.locator(".pair .film-stage").nth(1)
    view.scroll_into_view_if_needed()
    before = view.locator(".film-mask").get_attribute("src")
    box = view.bounding_box()
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 0.8 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.8 * box["height"], steps=5)
    page.mouse.up()
    page.wait_for_function(
        "old => document.querySelectorAll(`.pair .film-mask`)[1]?.getAttribute(`src`) != old",
        arg=before,
    )


def test_a_folder_of_frames_is_played_in_the_order_of_its_numbers(visit, tmp_path):
    page = visit("lighting")
    for number in (1, 2, 10):
        picture = np.full((90, 160, 3), 20 * number, np.uint8)
        (tmp_path / f"frame{number}.png").write_bytes(encode_png(picture))
    (tmp_path / "notes.txt").write_text("no picture")
    page.locator("input[type=file]").nth(1).set_input_files(tmp_path)
    page.get_by_text("1 / 3").wait_for()
    page.locator(".film-bar input").fill("2")
    page.get_by_text("3 / 3").wait_for()
    gray = page.evaluate(
        "() => { const c = document.createElement('canvas'), x = c.getContext('2d');"
        "x.drawImage(document.querySelector('.film-stage img'), 0, 0);"
        "return x.getImageData(80, 45, 1, 1).data[0]; }"
    )
    assert abs(gray - 200) < 6


def test_what_is_too_large_is_told_before_it_is_sent(visit, tmp_path):
    page = visit("expand")
    path = tmp_path / "huge.jpg"
    with path.open("wb") as file:
        file.truncate(201_000_000)
    page.locator("input[type=file]").first.set_input_files(path)
    page.get_by_text("larger than 200 MB").wait_for()


def test_what_is_no_video_is_told(visit, tmp_path):
    page = visit("lighting")
    path = tmp_path / "holiday.mp4"
    path.write_bytes(b"no video at all" * 100)
    page.locator("input[type=file]").first.set_input_files(path)
    page.locator(".notice.fail").wait_for()
    said = page.locator(".notice.fail").text_content()
    assert said.startswith("holiday.mp4")


@pytest.mark.parametrize("size", SIZES)
def test_a_panorama_becomes_a_map(visit, size, tmp_path):
    pixels = np.full((256, 512, 3), 120, np.uint8)
    pixels[128:] = 80
    pixels = cv2.GaussianBlur(pixels, (9, 9), 0)
    pixels[40:50, 100:112] = 255
    path = tmp_path / "street.jpg"
    path.write_bytes(encode_jpeg(np.asarray(pixels, np.uint8)))
    page = visit("expand", size)
    page.get_by_label("Method").select_option("area")
    page.locator("input[type=file]").first.set_input_files(path)
    wait_for_map(page)
    assert is_within(page)
    page.get_by_role("checkbox", name="sRGB curve undone").check()
    viewer = page.frame_locator("iframe:visible")
    viewer.locator("#compare option", has_text="sRGB curve undone").wait_for(state="attached")
    with downloaded(page, "Download as EXR", tmp_path) as found:
        radiance = read_environment_map(found).radiance
    assert radiance.max() > 2


def test_the_rest_answers_while_a_panorama_is_expanded(visit):
    page = visit("expand")
    press(page, "Take the sample instead")
    page.locator(".step").wait_for()
    page.get_by_role("link", name="Probe library").click()
    page.get_by_text("2 probes", exact=True).wait_for()
    assert page.locator("iframe").count() == 0  # the map is still being made
    page.get_by_role("link", name="Expand a panorama").click()
    wait_for_map(page)


def test_a_square_picture_is_told(visit, tmp_path):
    page = visit("expand")
    path = tmp_path / "square.jpg"
    path.write_bytes(encode_jpeg(np.full((64, 64, 3), 90, np.uint8)))
    page.locator("input[type=file]").first.set_input_files(path)
    page.locator(".notice.fail").wait_for()


@pytest.mark.parametrize("size", SIZES)
def test_the_library_is_filtered_looked_at_and_exported(visit, size, tmp_path):
    page = visit("probes", size)
    page.get_by_text("2 probes", exact=True).wait_for()
    page.get_by_label("Category").select_option("indoor")
    page.get_by_text("1 of 2 probes").wait_for()
    press(page, "Open hall")
    wait_for_map(page)
    assert is_within(page)
    page.get_by_text("All checks").click()
    page.get_by_role("rowheader", name="Dynamic range").wait_for()
    page.get_by_label("Select hall").check()
    page.get_by_text("1 selected").wait_for()
    with downloaded(page, "Export the selected", tmp_path) as path:
        names = zipfile.ZipFile(path).namelist()
    assert {"ATTRIBUTION.md", "hall.exr"} <= set(names)


def test_of_two_libraries_named_in_a_row_the_last_is_shown(visit, library, tmp_path):
    with Library.create(tmp_path / "empty"):
        pass
    page = visit("probes")
    page.get_by_text("2 probes", exact=True).wait_for()
    path = page.get_by_label("The library's folder on this machine")
    for folder in (tmp_path / "nowhere", tmp_path / "empty", library, tmp_path / "empty"):
        path.fill(str(folder))
        path.press("Enter")
    page.get_by_text("The library is empty").wait_for()
    assert page.locator(".notice.fail").count() == 0
    assert page.get_by_label("Category").count() == 1


def test_two_tabs_do_not_disturb_each_other(visit):
    one, two = visit("lighting"), visit("lighting")
    for page in (one, two):
        open_clip(page)
    click_in_frame(one, CLIP_CLICK.column, CLIP_CLICK.row)
    one.locator(".film-mask").wait_for()
    time.sleep(0.5)
    assert two.locator(".film-mask").count() == 0
    two.locator(".film-bar input").fill("3")
    two.get_by_text("4 / ").wait_for()
    assert one.locator(".film-bar output").text_content().startswith(f"{CLIP_CLICK.frame + 1} /")


def test_a_place_that_is_left_is_as_it_was(visit):
    page = visit("lighting")
    open_clip(page)
    page.get_by_role("link", name="Probe library").click()
    page.get_by_text("2 probes", exact=True).wait_for()
    assert page.url.endswith("/probes")
    page.get_by_role("link", name="Lighting from video").click()
    assert page.locator(".film-bar output").text_content().startswith(f"{CLIP_CLICK.frame + 1} /")


def test_the_clip_is_there():
    assert clip_path().is_file()
