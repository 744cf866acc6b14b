"""The file: everything in it, nothing around it, and no text taken for markup."""

import base64
import hashlib
import json
import re
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import panokit.report
from panokit.errors import UsageError
from panokit.report import (
    Badge,
    Cell,
    Chart,
    Charts,
    Column,
    Count,
    Counts,
    Gallery,
    Group,
    Mark,
    Page,
    Pictures,
    Series,
    Table,
    Text,
    light_map,
    picture,
    render_page,
    write_page,
)
from panokit.report.bfloat import decode_radiance

HOSTILE = "<img src=x onerror=alert(1)>\"'&</script><script>alert(2)</script>"
ASSETS = Path(panokit.report.__file__).parent / "assets"


class Html(HTMLParser):
    """What stands in a page: tags with their attributes, ids, texts of scripts and styles."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.inside, self.current = [], {"script": [], "style": []}, None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.current = tag if tag in self.inside else None
        if self.current:
            self.inside[tag].append("")

    def handle_endtag(self, tag):
        self.current = None if tag == self.current else self.current

    def handle_data(self, data):
        if self.current:
            self.inside[self.current][-1] += data

    def all(self, tag, **attributes):
        return [a for t, a in self.tags if t == tag and attributes.items() <= a.items()]


@pytest.fixture
def full_page(patches, street):
    def make(name="quay", word="word"):
        fact = Table(columns=(Column(label=word),), rows=((Cell(text=word, note=word),),))
        entry = light_map(
            patches,
            name,
            photos={word: street.pixels},
            badge=Badge(text=word, tone="fail"),
            category=word,
            figures={word: 1.5, "none": None, "infinite": float("inf")},
            subtitle=word,
            summary=word,
            facts=(fact,),
        )
        series = Series(label=word, values=(1.0, 2.0, 3.0))
        pixels = np.zeros((8, 8, 3), np.uint8)
        return Page(
            title=word,
            head=(Counts(counts=(Count(label=word, value=word, badge=Badge(text=word)),)),),
            sections=(
                Text(paragraphs=(word,), title=word, tone="note"),
                Gallery(entries=(entry, light_map(patches, "other")), title="Maps", note=word),
                Charts(
                    charts=(
                        Chart(
                            title=word,
                            unit=word,
                            meaning=word,
                            series=(series, series),
                            marks=(Mark(label=word, value=2.0),),
                        ),
                    )
                ),
                Pictures(pictures=(picture(pixels, alt=word, caption=word),), title="Pictures"),
                Table(
                    columns=(Column(label=word), Column(label="n", numeric=True)),
                    rows=(
                        (Cell(text=word, link=name), Cell(text="1", sort=1.0, percent=99.5)),
                        (Cell(lines=(word, word)), Cell(badge=Badge(text=word))),
                    ),
                    sortable=True,
                ),
                Group(title="Group", sections=(Text(paragraphs=(word,)),), folded=True),
                Group(title="Group", sections=(Text(paragraphs=(word,), title=word),)),
            ),
            footer=(word,),
        )

    return make


def test_nothing_is_asked_of_anybody(full_page):
    text = render_page(full_page())
    page = Html(text)
    sources = [a[n] for _, a in page.tags for n in ("src", "srcset", "data", "poster") if n in a]
    assert sources
    assert all(source.startswith("data:") for source in sources)
    assert not page.all("link")
    assert all(a["href"].startswith("#") for a in page.all("a"))
    code = "".join(page.inside["style"]) + page.inside["script"][1]
    for loader in ("http:", "https:", "url(", "@import", "fetch(", "XMLHttpRequest", "WebSocket"):
        assert loader not in code, loader


def test_the_policy_allows_its_own_script_and_style_alone(full_page):
    page = Html(render_page(full_page()))
    (policy,) = [m["content"] for m in page.all("meta") if "http-equiv" in m]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    running = [
        code
        for code, (_, a) in zip(
            page.inside["script"], [t for t in page.tags if t[0] == "script"], strict=True
        )
        if "type" not in a
    ]
    assert len(running) == len(page.inside["style"]) == 1
    for code in (*running, *page.inside["style"]):
        digest = base64.b64encode(hashlib.sha256(code.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy
    # The policy forbids these: none may be needed.
    assert not [a for _, a in page.tags if "style" in a or any(n.startswith("on") for n in a)]


def test_hostile_names_stay_text(full_page):
    plain, hostile = (Html(render_page(full_page(w, w))) for w in ("quay", HOSTILE))
    assert [tag for tag, _ in hostile.tags if tag != "wbr"] == [tag for tag, _ in plain.tags]
    data = json.loads(hostile.inside["script"][0])
    assert data["maps"][0]["name"] == HOSTILE
    assert data["maps"][0]["figures"] == {HOSTILE: 1.5, "none": None, "infinite": None}


def test_scripts_never_make_markup_of_data():
    for script in ASSETS.glob("*.js"):
        code = script.read_text()
        for maker in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval("):
            assert maker not in code, (script.name, maker)
        assert "</script" not in code


def test_every_id_is_there_once_and_every_reference_is_met(full_page):
    page = Html(render_page(full_page("A b", "A-b")))
    ids = [a["id"] for _, a in page.tags if "id" in a]
    assert len(ids) == len(set(ids))
    for _, attributes in page.tags:
        for name in ("for", "aria-labelledby", "aria-describedby"):
            if name in attributes:
                assert attributes[name] in ids
        if attributes.get("href", "").startswith("#"):
            assert attributes["href"][1:] in ids
    wanted = {
        i for f in ASSETS.glob("*.js") for i in re.findall(r'byId\("([\w-]+)"\)', f.read_text())
    }
    optional = {"filter-verdict", "filter-category"}
    assert wanted - optional <= set(ids)


def test_the_page_is_told_to_those_who_cannot_see_it(full_page):
    text = render_page(full_page())
    page = Html(text)
    assert page.all("html", lang="en")
    assert page.all("meta", name="viewport")
    assert next(tag for tag, _ in page.tags if re.fullmatch(r"h\d", tag)) == "h1"
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch(r"h\d", tag)]
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
    assert all("alt" in image for image in page.all("img"))
    assert all(int(i["width"]) and int(i["height"]) for i in page.all("img") if "src" in i)
    assert all(head["scope"] in ("row", "col") for head in page.all("th"))
    for svg in page.all("svg"):
        assert svg.get("aria-hidden") == "true" or (svg["role"], bool(svg["aria-label"])) == (
            "img",
            True,
        )


def test_the_blocks_hold_the_maps(full_page, patches):
    page = Html(render_page(full_page()))
    layers = json.loads(page.inside["script"][0])["maps"][0]["layers"]
    scripts = [a for tag, a in page.tags if tag == "script"]
    texts = dict(zip([a.get("id") for a in scripts], page.inside["script"], strict=True))
    data, _, _ = texts[layers[0]["block"]].split()
    back = decode_radiance(data, layers[0]["width"], layers[0]["height"])
    np.testing.assert_allclose(back, patches.radiance, rtol=1 / 256)
    assert layers[1]["photo"] is True
    assert base64.b64decode(texts[layers[1]["block"]].split()[0])[:2] == b"\xff\xd8"


def test_equal_pages_are_equal_texts(full_page, tmp_path):
    path = write_page(full_page(), tmp_path / "deep" / "report.html")
    assert path.read_text(encoding="utf-8") == render_page(full_page())


def test_names_of_one_anchor_are_told_apart(patches):
    entries = tuple(light_map(patches, name) for name in ("a b", "a-b", "A B", "", "é"))
    page = Html(render_page(Page(title="x", sections=(Gallery(entries=entries, title="Maps"),))))
    anchors = [a["id"] for a in page.all("li") if a.get("class") == "card"]
    assert anchors == ["map-a-b", "map-a-b-2", "map-a-b-3", "map-x", "map-x-2"]


def test_what_a_page_cannot_hold_is_refused(patches):
    gallery = Gallery(entries=(light_map(patches, "quay"),))
    with pytest.raises(UsageError, match="one gallery"):
        render_page(Page(title="x", sections=(gallery, Group(title="g", sections=(gallery,)))))
    with pytest.raises(UsageError, match="called 'quay'"):
        render_page(Page(title="x", sections=(Gallery(entries=gallery.entries * 2),)))
    with pytest.raises(UsageError, match="2 cells for 1 columns"):
        Table(columns=(Column(label="a"),), rows=((Cell(), Cell()),))


def test_a_page_without_maps_has_no_viewer():
    page = Html(render_page(Page(title="Figures", sections=(Text(paragraphs=("Hello.",)),))))
    assert not page.all("dialog")
    assert not page.all("canvas")
