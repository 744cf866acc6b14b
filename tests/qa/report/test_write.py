"""The report of a run: one file that asks nothing of anybody, and says what there is to say."""

import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from panokit.errors import Rejection
from panokit.io import write_environment_map, write_panorama
from panokit.panorama import Panorama
from panokit.qa import QaItem, QaResult, find_items, qa, write_report

REJECTIONS = [
    Rejection(item="p-1", stage="stitch", reason="missing-tiles", message="9 of 32 are missing."),
    Rejection(item="p-2", stage="stitch", reason="missing-tiles", message="8 of 32 are missing."),
    Rejection(item="p-3", stage="fetch", reason="not-360", message="It covers <120> degrees."),
]


class Page(HTMLParser):
    """What a browser would load, what it would show, and what a screen reader would say."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.links, self.ids, self.images, self.words = [], [], [], [], []
        self.stack, self.labels, self.maps = [], [], {}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.ids += [values["id"]] if "id" in values else []
        if tag == "a":
            self.links.append(values["href"])
        else:
            self.loads += [values[name] for name in ("src", "href", "srcset") if name in values]
        if "aria-label" in values:
            self.labels.append(values["aria-label"])
        if tag == "img" and "src" in values:
            self.images.append(values)
        if tag not in ("img", "input", "meta", "wbr"):
            self.stack.append(tag)

    def handle_endtag(self, tag):
        while tag in self.stack and self.stack.pop() != tag:
            pass

    def handle_data(self, data):
        if self.stack[-1:] == ["script"] and data.startswith("{"):
            self.maps = {one["name"]: one for one in json.loads(data)["maps"]}
        if not {"style", "script", "dialog", "noscript", "select"} & set(self.stack):
            self.words.append(data)

    @property
    def text(self):
        return re.sub(r"\s+", " ", " ".join(self.words))


@pytest.fixture
def make_run(tmp_path, make_map):
    def make(folder="run", names=("quay", "mill"), *, synthetic=True):
        run = tmp_path / folder
        run.mkdir()
        (run / "run.json").write_text("{}")
        for number, name in enumerate(names):
            envmap = make_map(128, sun=3e4 / 10**number, key=name, synthetic=synthetic)
            write_environment_map(envmap, run / "probes" / f"{name}.exr")
            pixels = np.full((64, 128, 3), 90 + number, np.uint8)
            panorama = Panorama(pixels=pixels, capture=envmap.capture)
            write_panorama(panorama, run / "panoramas" / f"{name}.jpg")
            write_panorama(panorama, run / "filled" / f"{name}.jpg")
        return run

    return make


def report_of(run, out, **options):
    path = write_report(qa(find_items([run])), out, **options)
    return path, Page(path.read_text())


def test_the_page_loads_nothing_from_anywhere(make_run, tmp_path):
    path, page = report_of(make_run(), tmp_path / "qa")
    assert page.loads
    assert all(value.startswith("data:") for value in page.loads)
    assert all(link.startswith("#") for link in page.links)
    text = re.sub(
        r'base64,[A-Za-z0-9+/=]+|<script type="text/plain".*?</script>', "", path.read_text()
    )
    assert "http:" not in text
    assert "https:" not in text
    assert "url(" not in text
    assert "@import" not in text


def test_it_names_every_map_and_every_link_has_its_place(make_run, tmp_path):
    _, page = report_of(make_run(), tmp_path / "qa", title="Harbor probes")
    for name in ("quay", "mill"):
        assert page.text.count(name) >= 2
    assert "Harbor probes" in page.text
    assert {"#map-quay", "#map-mill"} <= set(page.links)
    assert {link[1:] for link in page.links} <= set(page.ids)
    assert len(page.ids) == len(set(page.ids))


def test_each_map_can_be_compared_with_the_pictures_it_was_made_of(make_run, tmp_path):
    _, page = report_of(make_run(), tmp_path / "qa")
    assert [image["alt"] for image in page.images] == ["mill, tone mapped", "quay, tone mapped"]
    assert all(int(image["width"]) and int(image["height"]) for image in page.images)
    for entry in page.maps.values():
        assert [(one["label"], one["photo"]) for one in entry["layers"]] == [
            ("Light map", False),
            ("Panorama, holes filled", True),
            ("Panorama, as stitched", True),
        ]
        assert all(one["block"] in page.ids for one in entry["layers"])
    assert page.maps["quay"]["displayGain"] == 1.0
    assert page.maps["quay"]["verdict"] == "No defect"
    assert page.maps["quay"]["category"] == "Sample City"
    assert page.maps["quay"]["figures"]["Dynamic range"] > 3


def test_a_photograph_that_has_gone_does_not_cost_the_report(make_run, tmp_path):
    run = make_run()
    result = qa(find_items([run]))
    (run / "panoramas/quay.jpg").unlink()
    (run / "filled/quay.jpg").write_bytes(b"no picture")
    page = Page(write_report(result, tmp_path / "qa").read_text())
    assert [len(page.maps[name]["layers"]) for name in ("quay", "mill")] == [1, 3]


def test_it_tells_license_attribution_and_steps(make_run, tmp_path):
    _, page = report_of(make_run(), tmp_path / "qa")
    assert page.text.count("© A. Mapper") == 2
    assert "CC-BY-SA-4.0" in page.text
    assert "How it was made: expand" in page.text


def test_it_counts_and_groups_rejections_and_escapes_what_they_say(make_run, tmp_path):
    run = make_run()
    (run / "probes/broken.exr").write_bytes(b"no map")
    path, page = report_of(run, tmp_path / "qa", rejections=REJECTIONS)
    numbers = re.findall(r"<dt>([^<]+)</dt><dd>(\d+)\s*</dd>", path.read_text())
    assert dict(numbers) == {
        "light maps": "2", "no defect found": "2", "with a defect": "0", "rejected": "4",
    }  # fmt: skip
    assert re.search(r"missing-tiles in stitch 2 p-1: 9 of 32", page.text)
    assert "It covers <120> degrees." in page.text
    assert "not-an-image" in page.text


def test_it_says_that_synthetic_captures_are_no_photographs(make_run, tmp_path):
    _, synthetic = report_of(make_run("a"), tmp_path / "qa-a")
    _, real = report_of(make_run("b", synthetic=False), tmp_path / "qa-b")
    said = "These panoramas are rendered by panokit's synthetic city, not photographs."
    assert said in synthetic.text
    assert "synthetic" not in real.text


def test_a_failed_check_is_told_with_its_limit(make_run, make_map, tmp_path):
    run = make_run(names=("quay",))
    envmap = make_map(128, key="flat")
    clipped = envmap.with_changes(radiance=np.minimum(envmap.radiance, np.float32(0.9)))
    write_environment_map(clipped, run / "probes/flat.exr")
    _, page = report_of(run, tmp_path / "qa")
    assert re.search(r"Defect: .*dynamic range is [\d.]+ stops, allowed is 3 to 30", page.text)


def test_beside_a_truth_both_can_be_looked_at_on_one_scale(make_run, tmp_path):
    run = make_run()
    result = qa(find_items([run]), reference=run / "probes")
    page = Page(write_report(result, tmp_path / "qa").read_text())
    truth = page.maps["quay"]["layers"][1]
    assert (truth["label"], truth["photo"]) == ("Reference", False)
    assert truth["gain"] == pytest.approx(1 / result.maps[1].comparison.gain)
    assert "Irradiance error" in page.text
    assert "Light direction" in page.text


def test_a_map_without_a_defect_is_not_taken_for_an_accurate_one(make_run, make_map, tmp_path):
    run = make_run()
    for name in ("quay", "mill"):
        # The sun stands on the other side of the reference's sky.
        truth = make_map(128, azimuth_deg=220.0, key=name)
        write_environment_map(truth, tmp_path / "truth" / f"{name}.exr")
    result = qa(find_items([run]), reference=tmp_path / "truth")
    page = Page(write_report(result, tmp_path / "qa").read_text())
    assert re.search(r"with a defect 0 ", page.text)
    assert re.search(r"median irradiance error [\d.]+ % poor", page.text)
    assert re.search(r"median light direction error [\d.]+° poor", page.text)
    assert "irradiance error up to 20 % is good, up to 50 % fair, above poor" in page.text
    assert "pass" not in page.text.lower().split()


def test_without_references_no_accuracy_is_claimed(make_run, tmp_path):
    _, page = report_of(make_run(), tmp_path / "qa")
    assert "which only a reference could tell" in page.text
    assert "median irradiance" not in page.text
    assert not re.search(r"\b(good|fair|poor)\b", page.text)


def test_the_same_maps_give_the_same_bytes_wherever_they_lie(make_run, tmp_path):
    outputs = []
    for folder in ("one", "two"):
        path, _ = report_of(make_run(folder), tmp_path / f"qa-{folder}", rejections=REJECTIONS)
        outputs.append((path.read_bytes(), (path.parent / "qa.json").read_bytes()))
    assert outputs[0] == outputs[1]


def test_qa_json_holds_the_figures(make_run, tmp_path):
    report_of(make_run(), tmp_path / "qa", rejections=REJECTIONS)
    record = json.loads((tmp_path / "qa/qa.json").read_text())
    assert record["counts"] == {"maps": 2, "passed": 2, "failed": 0, "unreadable": 0}
    assert [r["item"] for r in record["rejections"]] == ["p-1", "p-2", "p-3"]
    checks = {c["name"]: c for c in record["maps"][0]["report"]["checks"]}
    assert checks["dynamic-range"]["value"] > 3
    assert checks["dynamic-range"]["low"] == 3.0


def test_a_dozen_maps_with_texture_can_be_sent_by_mail(make_map, tmp_path):
    rng = np.random.default_rng(0)
    envmap = make_map(1024)
    grain = rng.uniform(0.8, 1.25, envmap.radiance.shape).astype(np.float32)
    write_environment_map(envmap.with_changes(radiance=envmap.radiance * grain), tmp_path / "a.exr")
    pixels = rng.normal(120, 25, (512, 1024, 3)).clip(0, 255).astype(np.uint8)
    for folder in (tmp_path, tmp_path / "filled"):
        write_panorama(Panorama(pixels=pixels, capture=envmap.capture), folder / "b.jpg")
    item = QaItem(
        name="a",
        map_path=tmp_path / "a.exr",
        panorama_path=tmp_path / "b.jpg",
        filled_path=tmp_path / "filled/b.jpg",
    )
    path = write_report(qa([item]), tmp_path / "qa")
    assert 12 * path.stat().st_size < 24e6


def test_a_run_without_any_map_left_has_a_page_of_its_rejections(make_run, tmp_path):
    run = make_run(names=())
    (run / "probes").mkdir()
    (run / "probes/broken.exr").write_bytes(b"no map")
    _, page = report_of(run, tmp_path / "qa")
    assert "not-an-image" in page.text
    assert not page.images
    assert not page.maps


def test_figures_of_many_maps_are_drawn_with_their_limits(make_run, tmp_path):
    names = [f"place-{i:02}" for i in range(13)]
    run = make_run(names=names)
    result = qa(find_items([run]), reference=run / "probes")
    page = Page(write_report(result, tmp_path / "qa").read_text())
    assert "Distributions" in page.text
    said = [label for label in page.labels if label.startswith("Histogram of Dynamic range.")]
    assert re.search(r"13 values from .* at least: 3 stops\. at most: 30 stops", said[0])


def test_what_qa_tells_beyond_what_the_page_knows_is_shown_as_it_is(
    make_run, tmp_path, monkeypatch
):
    result = qa(find_items([make_run()]))
    told = QaResult.to_json

    def more(self):
        return told(self) | {"weather": {"coverage": {"share": 0.123}}, "nothing": None}

    monkeypatch.setattr(QaResult, "to_json", more)
    page = Page(write_report(result, tmp_path / "qa").read_text())
    assert "Weather" in page.text
    assert re.search(r"Share\s+0\.123", page.text)
    assert "Nothing" not in page.text
