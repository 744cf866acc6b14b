"""The viewer shows the right light in the right place at the right brightness."""

import numpy as np
import pytest

from panokit.metrics import diffuse_ball, glossy_ball, mirror_ball
from panokit.report import Gallery, Page, light_map

# The colors of the map `patches`: ahead, to the right, behind, to the left, above, elsewhere.
RED, GREEN, SUN = (0.5, 0.02, 0.02), (0.02, 0.25, 0.02), (20000, 20000, 20000)
BLUE, WHITE, GRAY = (0.02, 0.02, 0.6), (0.9, 0.9, 0.9), 0.18
EXACT = {"rtol": 0.02, "atol": 0.004}


def page_of(*entries):
    return Page(title="Maps", sections=(Gallery(title="Maps", entries=entries),))


@pytest.fixture
def tab(open_tab, patches):
    photo = np.full((128, 256, 3), 188, np.uint8)
    tab = open_tab(page_of(light_map(patches, "quay", photos={"Panorama": photo})))
    tab.open_map()
    return tab


def drag(tab, right, down=0.0):
    """Drag by shares of the picture's shorter side, starting in its middle."""
    box = tab.page.locator("#view").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    side = min(box["width"], box["height"])
    tab.page.mouse.move(x, y)
    tab.page.mouse.down()
    tab.page.mouse.move(x + right * side, y + down * side, steps=4)
    tab.page.mouse.up()
    tab.settle()


def test_it_opens_looking_ahead_at_the_exact_radiance(tab):
    np.testing.assert_allclose(tab.light(), RED, **EXACT)
    np.testing.assert_allclose(tab.light(0.5, 0.05), [GRAY] * 3, **EXACT)


def test_a_drag_turns_the_view_as_if_the_picture_were_held(tab):
    # At 80 degrees of view a share of the side is 2 tan 40 degrees of turn: here 90 degrees.
    quarter = np.pi / 2 / (2 * np.tan(np.deg2rad(40)))
    drag(tab, -0.4 * quarter)
    drag(tab, -0.6 * quarter)
    np.testing.assert_allclose(tab.light(), GREEN, **EXACT)
    drag(tab, 0.5 * quarter)
    drag(tab, 0.5 * quarter)
    np.testing.assert_allclose(tab.light(), RED, **EXACT)
    drag(tab, 0, 0.45)
    drag(tab, 0, 0.45)
    drag(tab, 0, 0.45)
    np.testing.assert_allclose(tab.light(), WHITE, **EXACT)


def test_right_is_right_and_up_is_up(tab):
    tab.slide("zoom", -120)
    tab.press("Control")
    tab.page.locator("#view").focus()
    tab.press(*["ArrowRight"] * 9)
    # Between red and green: red is left of the middle, green right of it.
    across = [tab.light(u) for u in np.linspace(0.02, 0.98, 25)]
    red = [i for i, c in enumerate(across) if c[0] > 2 * c[1]]
    green = [i for i, c in enumerate(across) if c[1] > 2 * c[0]]
    assert red
    assert green
    assert max(red) < 12 < min(green)


@pytest.mark.parametrize(
    ("key", "times", "color"),
    [("ArrowRight", 18, GREEN), ("ArrowLeft", 18, BLUE), ("ArrowUp", 18, WHITE)],
)
def test_arrows_look_around(tab, key, times, color):
    tab.press(*[key] * times)
    np.testing.assert_allclose(tab.light(), color, **EXACT)
    tab.press("Home")
    np.testing.assert_allclose(tab.light(), RED, **EXACT)


def test_a_stop_of_exposure_doubles_the_light(tab):
    before = tab.light(0.5, 0.05)
    tab.slide("exposure", 1)
    np.testing.assert_allclose(tab.light(0.5, 0.05), 2 * before, **EXACT)
    tab.slide("exposure", -1)
    np.testing.assert_allclose(tab.light(0.5, 0.05), before / 2, **EXACT)
    assert tab.page.locator("#exposure-value").text_content() == "−1 EV"
    tab.press("]", "]")
    np.testing.assert_allclose(tab.light(0.5, 0.05), 2 * before, **EXACT)


def test_a_sun_of_20000_is_not_clipped_once_the_exposure_is_down(tab):
    tab.press(*["ArrowRight"] * 36)
    assert list(tab.pixel()[:3]) == [255, 255, 255]
    tab.slide("exposure", -15)
    np.testing.assert_allclose(tab.light(), [20000 / 2**15] * 3, **EXACT)
    tab.slide("exposure", -16)
    np.testing.assert_allclose(tab.light(), [20000 / 2**16] * 3, **EXACT)


def test_suns_beyond_half_floats_are_told_apart(open_tab, patches):
    entries = []
    for name, sun in (("one", 1e6), ("two", 5e5)):
        radiance = patches.radiance.copy()
        radiance[radiance.max(-1) > 1000] = sun
        entries.append(light_map(patches.with_changes(radiance=radiance), name))
    tab = open_tab(page_of(*entries))
    tab.open_map()
    tab.press(*["ArrowRight"] * 36)
    tab.slide("exposure", -20)
    np.testing.assert_allclose(tab.light(), [1e6 / 2**20] * 3, **EXACT)
    tab.press("n")
    np.testing.assert_allclose(tab.light(), [5e5 / 2**20] * 3, **EXACT)


def test_a_map_of_no_known_scale_opens_with_its_median_at_middle_gray(open_tab, patches):
    loose = patches.with_changes(radiance=patches.radiance * np.float32(100), anchor="relative")
    tab = open_tab(page_of(light_map(loose, "quay")))
    tab.open_map()
    np.testing.assert_allclose(tab.light(0.5, 0.05), [0.18] * 3, **EXACT)


def test_false_color_is_the_legends(tab):
    tab.press("f")
    assert tab.page.locator("#legend").is_visible()

    def legend(stops):
        place = min(round((stops + 6) / 20 * 255), 255)
        return tab.page.evaluate(
            "(x) => [...document.getElementById('legend-bar').getContext('2d')"
            ".getImageData(x, 0, 1, 1).data]",
            place,
        )

    for turn, color in ((0, RED), (18, GREEN), (18, SUN)):
        tab.press(*["ArrowRight"] * turn)
        luminance = np.dot(color, (0.2126, 0.7152, 0.0722))
        expected = np.array(legend(np.log2(luminance / GRAY)))
        assert np.abs(tab.pixel() - expected).max() <= 4
    # It tells radiance, which no exposure changes.
    sun = tab.pixel()
    tab.press("[", "[")
    np.testing.assert_array_equal(tab.pixel(), sun)


def test_the_split_has_the_photograph_at_its_left(tab):
    gray = 0.5029  # sRGB 188
    assert tab.page.locator("#split-line").is_hidden()
    tab.press("c")
    np.testing.assert_allclose(tab.light(0.45), [gray] * 3, **EXACT)
    np.testing.assert_allclose(tab.light(0.53), RED, **EXACT)
    assert tab.page.locator("#label-before").text_content() == "Panorama"
    tab.slide("split", 40)
    np.testing.assert_allclose(tab.light(0.45), RED, **EXACT)
    np.testing.assert_allclose(tab.light(0.35), [gray] * 3, **EXACT)
    # Darker, the photograph's white turns gray: it has nothing beyond.
    tab.slide("exposure", -1)
    np.testing.assert_allclose(tab.light(0.35), [gray / 2] * 3, **EXACT)
    tab.press("c")
    assert tab.page.locator("#split-line").is_hidden()


def test_the_split_can_be_dragged(tab):
    tab.press("c")
    box = tab.page.locator("#view").bounding_box()
    middle = box["y"] + box["height"] / 2
    tab.page.mouse.move(box["x"] + box["width"] / 2, middle)
    tab.page.mouse.down()
    tab.page.mouse.move(box["x"] + box["width"] * 0.25, middle, steps=3)
    tab.page.mouse.up()
    tab.settle()
    assert tab.page.locator("#split").input_value() == "25"
    np.testing.assert_allclose(tab.light(0.5), RED, **EXACT)


def test_the_whole_map_is_as_in_its_file(tab, patches):
    tab.press("2")
    for u, color in ((0.5, RED), (0.75, GREEN), (0.25, BLUE)):
        np.testing.assert_allclose(tab.light(u), color, **EXACT)
    np.testing.assert_allclose(tab.light(0.4, 0.01), WHITE, **EXACT)
    assert list(tab.pixel(0.005)[:3]) == list(tab.pixel(0.995)[:3]) == [255] * 3


def test_balls_are_lit_from_where_the_light_is(open_tab, east):
    entry = light_map(east, "lamp")
    tab = open_tab(page_of(entry))
    tab.open_map()
    tab.press("3")
    box = tab.page.locator("#view").bounding_box()
    radius = 0.46 * min(box["width"] / 3, box["height"])

    def place(column, x, y):
        return ((column + 0.5) / 3 + x * radius / box["width"], 0.5 - y * radius / box["height"])

    for column, ball, gain in (
        (0, diffuse_ball(east.radiance, 200), entry.ball_gain),
        (1, glossy_ball(east.radiance, 200), 1.0),
        (2, mirror_ball(east.radiance, 200), 1.0),
    ):
        for x, y in ((0.6, 0.0), (-0.6, 0.0), (0.3, 0.5), (0.0, 0.0), (0.2, -0.6)):
            expected = ball[round(100 - 100 * y), round(100 + 100 * x), :3] * gain
            np.testing.assert_allclose(
                tab.light(*place(column, x, y)), np.clip(expected, 0, 1), rtol=0.12, atol=0.02
            )
    right, left = tab.light(*place(0, 0.6, 0)), tab.light(*place(0, -0.6, 0))
    assert right.mean() > 5 * left.mean()
    assert right[0] > 1.5 * right[2]
    # Between the balls there is nothing.
    assert tab.pixel(1 / 3, 0.02)[3] == 0
    # Looking east the lamp is behind the balls, looking west it is before them.
    tab.press(*["ArrowRight"] * 18)
    assert tab.light(*place(0, 0, 0)).mean() < 0.1
    tab.press(*["ArrowRight"] * 36)
    assert tab.light(*place(0, 0, 0)).mean() > 0.4


def test_compared_balls_stand_one_above_the_other(open_tab, east):
    dim = east.with_changes(radiance=east.radiance * np.float32(0.25))
    tab = open_tab(page_of(light_map(east, "lamp", references={"Reference": (dim, 1.0)})))
    tab.open_map()
    tab.press("3", "c")
    tab.settle()
    box = tab.page.locator("#view").bounding_box()
    right = 0.6 * 0.46 * min(box["width"] / 3, box["height"] / 2) / box["width"]
    above, below = (tab.light(1 / 6 + right, v) for v in (0.25, 0.75))
    np.testing.assert_allclose(below, above / 4, rtol=0.05, atol=0.004)


def test_a_reference_is_shown_on_the_maps_scale(open_tab, patches):
    half = patches.with_changes(radiance=patches.radiance * np.float32(0.5))
    tab = open_tab(page_of(light_map(patches, "quay", references={"Reference": (half, 2.0)})))
    tab.open_map()
    tab.press("c")
    tab.settle()
    np.testing.assert_allclose(tab.light(0.47), RED, **EXACT)
    np.testing.assert_allclose(tab.light(0.53), RED, **EXACT)


def test_zoom_narrows_the_view(tab):
    edge = tab.light(0.5, 0.3)
    np.testing.assert_allclose(edge, [GRAY] * 3, **EXACT)
    tab.press(*["+"] * 9)
    np.testing.assert_allclose(tab.light(0.5, 0.3), RED, **EXACT)
    tab.page.locator("#view").hover()
    for _ in range(10):
        tab.page.mouse.wheel(0, 200)
    tab.settle()
    np.testing.assert_allclose(tab.light(0.5, 0.3), [GRAY] * 3, **EXACT)


def test_under_the_pointer_it_tells_direction_and_luminance(tab):
    box = tab.page.locator("#view").bounding_box()
    tab.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    told = tab.page.locator("#readout").text_content()
    assert told.startswith("Azimuth 0°, elevation 0°: luminance 0.12")
    assert "× white" in told


def test_a_lost_context_comes_back(open_tab, patches):
    keep = """
      const own = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        const context = own.call(this, kind, ...rest);
        if (kind === "webgl2") (window.contexts ??= []).push(context);
        return context;
      };"""
    tab = open_tab(page_of(light_map(patches, "quay"), light_map(patches, "mill")), script=keep)
    tab.open_map()
    tab.press("n", "p")
    assert tab.page.evaluate("() => window.contexts.length") == 1
    tab.page.evaluate(
        "async () => { const lose = window.contexts[0].getExtension('WEBGL_lose_context');"
        "lose.loseContext(); await new Promise((r) => setTimeout(r, 50)); lose.restoreContext();"
        "await new Promise((r) => setTimeout(r, 300)); }"
    )
    tab.press("ArrowRight", "ArrowLeft")
    np.testing.assert_allclose(tab.light(), RED, **EXACT)
