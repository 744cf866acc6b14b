"""One map alone, for a frame in another page."""

import json
import re

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import UsageError
from panokit.report import MapEntry, light_map, render_viewer


@pytest.fixture(scope="module")
def entry():
    radiance = np.full((32, 64, 3), 0.2, np.float32)
    photo = np.full((32, 64, 3), 120, np.uint8)
    return light_map(EnvironmentMap(radiance=radiance), "a <b> map", photos={"Photo": photo})


def test_it_holds_the_map_and_what_it_is_compared_with(entry):
    page = render_viewer(entry)
    data = json.loads(re.search(r'id="report-data">(.*?)</script>', page)[1])
    (shown,) = data["maps"]
    assert shown["name"] == "a <b> map"
    assert [layer["label"] for layer in shown["layers"]] == ["Light map", "Photo"]
    for layer in shown["layers"]:
        assert f'id="{layer["block"]}"' in page
    assert f'id="{shown["anchor"]}" hidden' in page


def test_it_may_run_its_own_script_and_ask_nothing_of_anybody(entry):
    page = render_viewer(entry)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    assert policy.startswith("default-src &#39;none&#39;")
    assert "https:" not in policy
    assert "<b>" not in page
    assert 'id="gallery-tools"' not in page


def test_equal_maps_are_equal_pages(entry):
    assert render_viewer(entry) == render_viewer(entry)


def test_a_map_without_layers_is_refused(entry):
    bare = MapEntry(name="bare", thumbnail=entry.thumbnail, layers=())
    with pytest.raises(UsageError, match="no layers"):
        render_viewer(bare)
