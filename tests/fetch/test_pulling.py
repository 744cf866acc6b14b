"""`panokit probes pull` at the size of a paper's probe set, interrupted, and with a bad service."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from datetime import UTC, date, datetime, timedelta

import pytest

from panokit.cli.main import main
from panokit.console import Console
from panokit.fetch.polyhaven import scene_of, select
from panokit.fetch.settings import PullSettings
from panokit.http import Budget, Client, Policy
from panokit.pipeline.pulling import pull_into
from panokit.probes import Library, ProbeFilter
from panokit.synthetic.faults import Faults, Trouble
from panokit.synthetic.pictures import ServedPicture
from panokit.synthetic.polyhaven import PolyHaven
from panokit.synthetic.server import StreetServer

FIRST_DAY = datetime(2017, 12, 1, tzinfo=UTC)
CATEGORIES = [["outdoor", "night", "urban"], ["indoor", "natural light"], ["studio", "indoor"],
              ["outdoor", "clear", "midday"], ["skies", "clear"]]  # fmt: skip


def asset(number):
    return {
        "type": 0,
        "categories": CATEGORIES[number % len(CATEGORIES)],
        "tags": ["road"],
        "download_count": 1000 - number,
        "date_published": round((FIRST_DAY + timedelta(days=number)).timestamp()),
    }


@pytest.fixture
def many(pictures):
    """A service of 200 maps, one published each day."""
    served = [
        ServedPicture(
            image=pictures[0].image,
            capture=replace(pictures[0].capture, id=f"map-{number:03d}", details=asset(number)),
        )
        for number in range(200)
    ]
    with StreetServer(served) as server:
        yield server


def pull(server, library, *more):
    return main(
        ["probes", "pull", str(library), *more, "--endpoint", server.url, "--resolution", "1k",
         "--requests-per-s", "1000"]
    )  # fmt: skip


def files_asked(server):
    return [request.path for request in server.requests if request.port == "storage"]


def test_the_175_first_published_maps_are_one_query(many, tmp_path, capsys):
    code = pull(many, tmp_path / "lib", "--order", "published", "--count", "175", "--dry-run",
                "--json")  # fmt: skip
    assert code == 0
    told = json.loads(capsys.readouterr().out)
    names = [one["name"] for one in told["added"]]
    assert names == [f"map-{number:03d}_1k" for number in range(175)]
    # One list, and what each one's files are.
    assert told["requests"] == 176
    assert files_asked(many) == []


def test_maps_of_a_time_and_their_order():
    assets = {f"m{number}": asset(number) for number in range(10)}
    assets["undated"] = {"type": 0, "categories": ["outdoor"], "download_count": 5}
    early = select(assets, PullSettings(published_before=date(2017, 12, 4)))
    assert [one.id for one in early] == ["m0", "m1", "m2"]
    first = select(assets, PullSettings(order="published"))
    assert [one.id for one in first] == [f"m{number}" for number in range(10)] + ["undated"]
    most = select(assets, PullSettings(count=2))
    assert [one.id for one in most] == ["m0", "m1"]


@pytest.mark.parametrize(
    ("categories", "scene"),
    [
        (["outdoor", "night", "urban"], "outdoor_night"),
        (["Outdoor", "Sunrise-Sunset", "clear"], "outdoor_sunrise_sunset"),
        (["outdoor", "overcast"], "outdoor_overcast"),
        (["outdoor", "midday", "partly cloudy"], "outdoor_sunny"),
        (["outdoor", "nature"], "outdoor"),
        (["indoor", "studio", "artificial light"], "indoor_studio"),
        (["indoor", "artificial light"], "indoor_artificial"),
        (["indoor", "natural light"], "indoor_windows"),
        (["skies", "outdoor", "night"], "sky_only"),
        (["something new"], ""),
        (None, ""),
    ],
)
def test_the_kind_of_scene(categories, scene):
    assert scene_of({"categories": categories}) == scene


def test_what_is_pulled_is_found_by_what_it_is(many, tmp_path):
    assert pull(many, tmp_path / "lib", "map-000", "map-001") == 0
    with Library.open(tmp_path / "lib") as library:
        assert [e.name for e in library.list(ProbeFilter(category="outdoor_night"))] == [
            "map-000_1k"
        ]
        assert [e.name for e in library.list(ProbeFilter(tags=("natural light",)))] == [
            "map-001_1k"
        ]
        for entry in library.list():
            assert (entry.license, entry.kind, entry.trainable) == ("CC0-1.0", "native", True)
            assert "via Poly Haven" in entry.attribution


def test_categories_are_asked_of_the_service(many, tmp_path, capsys):
    arguments = ["--category", "studio", "--count", "3", "--dry-run", "--json"]
    assert pull(many, tmp_path / "lib", *arguments) == 0
    names = [one["name"] for one in json.loads(capsys.readouterr().out)["added"]]
    assert names == ["map-002_1k", "map-007_1k", "map-012_1k"]
    asked = next(request for request in many.requests if request.path == "/assets")
    assert asked.query["categories"] == "studio"


KILLED = """
import os, sys
import panokit.pipeline.pulling as pulling
from panokit.cli.main import main
from panokit.probes import Library

add, left = Library.add, [2]

def dying_add(self, *args, **kwargs):
    if not left[0]:
        os.kill(os.getpid(), 9)
    left[0] -= 1
    return add(self, *args, **kwargs)

Library.add = dying_add
main(sys.argv[1:])
"""


def test_a_killed_pull_goes_on_where_it_was(many, tmp_path):
    library = tmp_path / "lib"
    arguments = ["probes", "pull", str(library), "--count", "4", "--endpoint", many.url,
                 "--resolution", "1k", "--requests-per-s", "1000"]  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-c", KILLED, *arguments],
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == -9
    assert len(files_asked(many)) == 3
    assert (library / ".incoming").exists()
    assert pull(many, library, "--count", "4") == 0
    # The two that were in are not fetched again; the one under way is.
    assert len(files_asked(many)) == 5
    with Library.open(library) as shelves:
        assert len(shelves) == 4
        assert shelves.verify().problems == ()
    assert not (library / ".incoming").exists()


@pytest.mark.parametrize("kind", ["429", "503", "html", "empty", "wrong-type", "reset"])
def test_passing_faults_are_waited_out(many, tmp_path, kind):
    many.set_faults(Faults(troubles=[Trouble(kind=kind, times=2)]))
    assert pull(many, tmp_path / "lib", "map-000") == 0
    assert sum(many.faults_met.values()) == 2


def test_a_file_that_is_never_what_was_promised_is_rejected_and_the_next_goes_on(
    many, tmp_path, monkeypatch
):
    entry = PolyHaven._entry

    def promised_otherwise(self, picture, resolution, suffix):
        known = entry(self, picture, resolution, suffix)
        wrong = {"md5": "0" * 32} if picture.capture.id == "map-000" else {}
        return {**known, **wrong}

    monkeypatch.setattr(PolyHaven, "_entry", promised_otherwise)
    settings = PullSettings(names=("map-000", "map-001"), endpoint=many.url, resolution="1k")
    policy = Policy(attempts=2, first_delay_s=0.01, rate_per_s=1000)
    with Client(policy, budget=Budget(None)) as client:
        result = pull_into(settings, tmp_path / "lib", Console(quiet=True), client=client)
    assert [one.name for one in result.added] == ["map-001_1k"]
    assert [(one.item, one.reason) for one in result.rejections] == [("map-000_1k", "wrong-digest")]
    with Library.open(tmp_path / "lib") as shelves:
        assert [one.name for one in shelves.list()] == ["map-001_1k"]


def test_a_budget_of_requests_stops_and_keeps_what_is_there(many, tmp_path, capsys):
    assert pull(many, tmp_path / "lib", "--count", "4", "--max-requests", "5") == 9
    assert "panokit: " in capsys.readouterr().err
    with Library.open(tmp_path / "lib") as shelves:
        assert len(shelves) == 2


def test_a_library_that_cannot_be_written_is_told_before_anything_is_fetched(
    many, tmp_path, capsys
):
    (tmp_path / "lib").write_text("a file where the folder should be")
    assert pull(many, tmp_path / "lib", "map-000") == 4
    assert "Cannot make" in capsys.readouterr().err
    assert files_asked(many) == []
