"""The page around the viewer: keys, screen readers, filters, sizes, and what is left without."""

import numpy as np
import pytest

from panokit.report import (
    Badge,
    Cell,
    Chart,
    Charts,
    Column,
    Count,
    Counts,
    Gallery,
    Page,
    Series,
    Table,
    Text,
    light_map,
)

HOSTILE = "<img src=x onerror=window.hacked=1>\"'&</script><script>window.hacked=1</script>"
NO_WEBGL = """
  const own = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    return kind === "webgl2" ? null : own.call(this, kind, ...rest);
  };"""
COUNT_CONTEXTS = NO_WEBGL.replace(
    "return kind",
    "if (kind === 'webgl2') window.contexts = (window.contexts ?? 0) + 1; return kind",
).replace('kind === "webgl2" ? null : ', "")


@pytest.fixture
def report(patches):
    """A page as reports have it; `names` are its maps, every third with a defect."""

    def make(*names):
        entries = []
        for number, name in enumerate(names):
            dim = patches.with_changes(radiance=patches.radiance * np.float32(0.5**number))
            fact = Table(
                title="Checks",
                columns=(Column(label="Figure"), Column(label="Value", numeric=True)),
                rows=((Cell(text=f"Range of {name}"), Cell(text=str(number))),),
                headings=False,
            )
            bad = number % 3 == 2
            entries.append(
                light_map(
                    dim,
                    name,
                    width_px=64,
                    badge=Badge(text="Defect" if bad else "No defect", tone="fail" if bad else ""),
                    category="indoor" if number % 2 else "outdoor",
                    figures={"Range": float(number), "Rest": None if number == 0 else -number},
                    subtitle=f"Place {number}",
                    facts=(fact,),
                )
            )
        rows = tuple((Cell(text=n, link=n), Cell(text=str(i), sort=i)) for i, n in enumerate(names))
        values = Series(label="These maps", values=tuple(float(i) for i in range(20)))
        return Page(
            title="Harbor probes",
            head=(Counts(counts=(Count(label="light maps", value=str(len(names))),)),),
            sections=(
                Gallery(title="Maps", entries=tuple(entries)),
                Charts(title="Distributions", charts=(Chart(title="Range", series=(values,)),) * 3),
                Table(
                    title="All maps",
                    columns=(Column(label="Map"), Column(label="Range", numeric=True)),
                    rows=rows,
                    sortable=True,
                ),
                Text(title="Method", paragraphs=("As said.",)),
            ),
        )

    return make


def shown(tab):
    return tab.page.locator(".card:not([hidden]) .name").all_text_contents()


def test_by_keyboard_alone(open_tab, report):
    tab = open_tab(report("quay", "mill", "dike"))
    focused = "document.activeElement"
    tab.page.keyboard.press("Tab")
    assert tab.page.evaluate(f"() => {focused}.textContent") == "Skip to the report"
    for _ in range(30):
        tab.page.keyboard.press("Tab")
        if tab.page.evaluate(f"() => {focused}.matches('.open')"):
            break
    # The focus can be seen.
    assert tab.page.evaluate(f"() => getComputedStyle({focused}).outlineStyle") == "solid"
    tab.page.keyboard.press("Enter")
    tab.wait_drawn()
    assert tab.page.evaluate(f"() => {focused}.id") == "view"
    assert tab.page.locator("#viewer-title").text_content() == "quay"
    tab.press("n")
    assert tab.page.locator("#viewer-title").text_content() == "mill"
    assert tab.page.locator("#viewer-place").text_content() == "2 of 3"
    assert "Range of mill" in tab.page.locator("#viewer-facts").text_content()
    assert "Range of quay" not in tab.page.locator("#viewer-facts").text_content()
    # From the picture every control can be reached, and the focus stays in the dialog.
    reached = set()
    for _ in range(14):
        tab.page.keyboard.press("Tab")
        reached.add(tab.page.evaluate(f"() => {focused}.id"))
    assert {"mode-look", "exposure", "zoom", "false-color", "reset", "viewer-close"} <= reached
    tab.page.locator("#exposure").focus()
    tab.press("ArrowRight")
    assert tab.page.locator("#exposure-value").text_content() == "+0.3 EV"
    tab.press("Escape")
    assert tab.page.evaluate("() => document.getElementById('viewer').open") is False
    assert tab.page.evaluate(f"() => {focused}.getAttribute('aria-label')") == "Look around in quay"


def test_what_a_screen_reader_finds(open_tab, report):
    tab = open_tab(report("quay", "mill"))
    page = tab.page
    assert page.get_by_role("heading", name="Harbor probes", level=1).count() == 1
    assert page.get_by_role("navigation", name="Contents").get_by_role("link").count() == 4
    assert page.get_by_role("table").count() >= 1
    assert page.get_by_role("img", name="Histogram of Range.").count() == 3
    assert page.get_by_role("columnheader", name="Range").count() == 1
    page.get_by_role("button", name="Look around in mill").click()
    tab.wait_drawn()
    dialog = page.get_by_role("dialog", name="mill")
    assert dialog.is_visible()
    assert dialog.get_by_role("application", name="mill, view of the light map").count() == 1
    for name in ("Exposure", "Field of view"):
        assert dialog.get_by_role("slider", name=name).count() == 1
    assert dialog.get_by_role("slider", name="Exposure").get_attribute("aria-valuetext") == "0 EV"
    assert dialog.get_by_role("radio", name="Relit balls").count() == 1
    assert dialog.get_by_role("checkbox", name="Luminance in false color").count() == 1
    tab.wait_for("document.getElementById('view-status').textContent.includes('luminance')")
    tab.press("ArrowRight", "ArrowRight")
    tab.wait_for("document.getElementById('view-status').textContent.includes('Azimuth 10°')")


def test_hostile_names_do_nothing(open_tab, report):
    tab = open_tab(report(HOSTILE, "quay"))
    assert shown(tab)[0] == HOSTILE
    tab.open_map()
    assert tab.page.locator("#viewer-title").text_content() == HOSTILE
    tab.press("Escape")
    tab.page.locator("#filter-text").fill("<img")
    assert shown(tab) == [HOSTILE]
    assert tab.page.evaluate("() => window.hacked === undefined")
    assert tab.page.evaluate("() => document.querySelectorAll('img[src=\"x\"]').length") == 0


def test_a_script_that_got_in_would_not_run(open_tab, report):
    tab = open_tab(report("quay"))
    tab.page.evaluate(
        "() => { const s = document.createElement('script'); s.textContent = 'window.hacked = 1';"
        "document.body.append(s); }"
    )
    assert tab.page.evaluate("() => window.hacked === undefined")
    assert "Content Security Policy" in tab.complaints.pop()


def test_the_gallery_is_filtered_and_sorted(open_tab, report):
    tab = open_tab(report("quay", "mill", "dike", "lock"))
    count = tab.page.locator("#gallery-count")
    assert count.text_content() == "4 shown"
    tab.page.locator("#filter-verdict").select_option("Defect")
    assert shown(tab) == ["dike"]
    assert count.text_content() == "1 of 4 shown"
    tab.page.locator("#filter-verdict").select_option("")
    tab.page.locator("#filter-category").select_option("indoor")
    assert shown(tab) == ["mill", "lock"]
    tab.page.locator("#filter-category").select_option("")
    tab.page.locator("#filter-text").fill("place 3")
    assert shown(tab) == ["lock"]
    tab.page.locator("#filter-text").fill("")
    tab.page.locator("#sort").select_option("name|up")
    assert shown(tab) == ["dike", "lock", "mill", "quay"]
    tab.page.locator("#sort").select_option("Range|down")
    assert shown(tab) == ["lock", "dike", "mill", "quay"]
    # What has no value is last, whichever way.
    for way, order in (("up", ["lock", "dike", "mill"]), ("down", ["mill", "dike", "lock"])):
        tab.page.locator("#sort").select_option(f"Rest|{way}")
        assert shown(tab) == [*order, "quay"]
    # The viewer goes through the maps as they are shown.
    tab.open_map()
    tab.press("n")
    assert tab.page.locator("#viewer-title").text_content() == "dike"


def test_a_table_is_sorted_by_its_headings(open_tab, report):
    tab = open_tab(report("quay", "mill", "dike"))
    table = tab.page.locator("table.sortable")
    names = table.locator("tbody th a")
    table.get_by_role("button", name="Map").click()
    assert names.all_text_contents() == ["dike", "mill", "quay"]
    table.get_by_role("button", name="Range").click()
    table.get_by_role("button", name="Range").click()
    assert names.all_text_contents() == ["dike", "mill", "quay"]
    assert table.locator("th[aria-sort]").get_attribute("aria-sort") == "descending"
    names.nth(1).click()
    tab.wait_drawn()
    assert tab.page.locator("#viewer-title").text_content() == "mill"


def test_thumbnails_are_drawn_when_they_come_into_sight_all_by_one_context(open_tab, report):
    tab = open_tab(report(*(f"map {i}" for i in range(40))), script=COUNT_CONTEXTS, width=360)
    drawn = "[...document.querySelectorAll('.card canvas')].filter((c) => c.dataset.drawn).length"
    tab.page.locator("#thumbnails").select_option("exposure")
    tab.wait_for(f"{drawn} > 0")
    tab.page.wait_for_timeout(500)
    assert tab.page.evaluate(f"() => {drawn}") < 20
    tab.page.evaluate("() => document.querySelector('.card:last-child').scrollIntoView()")
    tab.wait_for("document.querySelector('.card:last-child canvas').dataset.drawn")
    tab.page.evaluate("() => scrollTo(0, 0)")
    tab.page.locator("#thumbnail-exposure").fill("1")
    tab.wait_for("document.querySelector('.card canvas').dataset.drawn === 'exposure 1'")
    pixel = tab.page.evaluate(
        "() => { const c = document.querySelector('.card canvas');"
        "return [...c.getContext('2d').getImageData(c.width / 2, c.height / 2, 1, 1).data]; }"
    )
    # Red ahead is 0.5, twice that is white's red.
    assert pixel[0] > 250
    assert pixel[1] < 70
    tab.page.locator("#thumbnails").select_option("balls")
    tab.wait_for("document.querySelector('.card canvas').dataset.drawn === 'balls 1'")
    tab.open_map()
    assert tab.page.evaluate("() => window.contexts") == 1


def test_without_webgl_the_figures_and_a_flat_picture_remain(open_tab, report):
    tab = open_tab(report("quay", "mill"), script=NO_WEBGL)
    tab.page.locator("#thumbnails").select_option("balls")
    assert tab.page.locator("#thumbnails").input_value() == "picture"
    assert tab.page.locator("#thumbnails").is_disabled()
    assert "no WebGL2" in tab.page.locator("#gallery-count").text_content()
    assert tab.page.locator(".card img").first.is_visible()
    tab.page.locator(".open").first.click()
    message = tab.page.get_by_role("alert")
    assert "no WebGL2" in message.text_content()
    assert tab.page.locator("#stage-picture").is_visible()
    assert tab.page.locator("#controls").is_hidden()
    assert "Range of quay" in tab.page.locator("#viewer-facts").text_content()
    tab.page.keyboard.press("n")
    assert tab.page.locator("#stage-picture").get_attribute("alt") == "mill, tone mapped"


def test_without_scripts_everything_is_there_to_read(open_tab, report):
    tab = open_tab(report("quay", "mill"), java_script_enabled=False)
    assert tab.page.locator("noscript p").is_visible()
    assert tab.page.locator(".card img").first.is_visible()
    tab.page.get_by_text("All figures").first.click()
    assert tab.page.get_by_text("Range of quay").is_visible()
    assert tab.page.locator("#gallery-tools").is_hidden()


@pytest.mark.parametrize("width", [320, 360, 768, 1280, 1920])
def test_nothing_is_wider_than_the_window(open_tab, report, width):
    tab = open_tab(report("a_very_long_name_of_a_map_" * 3, HOSTILE, "mill"), width=width)
    wide = "document.documentElement.scrollWidth <= innerWidth"
    assert tab.page.evaluate(f"() => {wide}")
    tab.open_map()
    tab.press("f", "3")
    assert tab.page.evaluate(f"() => {wide}")
    assert tab.page.evaluate(
        "() => { const d = document.getElementById('viewer'); return d.scrollWidth <= d.clientWidth"
        " && [...d.querySelectorAll('button, select, input')].filter((e) => e.offsetParent)"
        ".every((e) => e.getBoundingClientRect().right <= innerWidth + 1); }"
    )


def test_a_phone_has_room_for_fingers(open_tab, report):
    tab = open_tab(report("quay", "mill"), width=360, height=740, has_touch=True, is_mobile=True)
    tab.page.locator(".open").first.tap()
    tab.wait_drawn()
    sizes = tab.page.evaluate(
        "() => [...document.querySelectorAll('#viewer button')].filter((e) => e.offsetParent)"
        ".map((e) => Math.min(e.offsetWidth, e.offsetHeight))"
    )
    assert min(sizes) >= 32
    view = tab.page.locator("#view").bounding_box()
    assert view["width"] == 360
    assert view["y"] + view["height"] < 740


def test_dark_and_light_as_the_reader_wants(open_tab, report):
    grounds = []
    for scheme in ("light", "dark"):
        tab = open_tab(report("quay"), color_scheme=scheme)
        ground, ink = tab.page.evaluate(
            "() => { const s = getComputedStyle(document.body);"
            "return [s.backgroundColor, s.color].map((c) => c.match(/\\d+/g).map(Number)); }"
        )
        grounds.append([np.mean(ground), np.mean(ink)])
    (light, dark_ink), (dark, light_ink) = grounds
    assert light > 230
    assert dark_ink < 60
    assert dark < 40
    assert light_ink > 200


def test_paper_has_no_controls(open_tab, report):
    tab = open_tab(report("quay", "mill"))
    tab.page.emulate_media(media="print")
    assert tab.page.locator("#gallery-tools").is_hidden()
    assert tab.page.locator(".contents").is_hidden()
    assert tab.page.locator(".card img").first.is_visible()
    assert tab.page.locator(".chart svg").first.is_visible()


def test_a_link_to_a_map_opens_it(open_tab, report):
    tab = open_tab(report("quay", "mill"), hash="#map-mill")
    tab.wait_drawn()
    assert tab.page.locator("#viewer-title").text_content() == "mill"
    tab.press("ArrowRight")
    tab.wait_for("document.getElementById('view-status').textContent.includes('Azimuth 5°')")


def test_keys_work_after_a_click_beside_the_controls(open_tab, report):
    tab = open_tab(report("quay", "mill"))
    tab.open_map()
    tab.page.locator("#viewer-subtitle").click()
    tab.press("ArrowRight")
    tab.wait_for("document.getElementById('view-status').textContent.includes('Azimuth 5°')")
    tab.press("n")
    assert tab.page.locator("#viewer-title").text_content() == "mill"
