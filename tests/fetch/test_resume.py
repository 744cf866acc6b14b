"""Runs that end before their time: killed, interrupted, terminated, overtaken."""

import json
import os
import random
import signal
import subprocess
import sys
import time

import pytest

from panokit.cli.main import main
from panokit.errors import UsageError
from panokit.fetch import fetch
from panokit.fetch.run_lock import LOCK, only_run, remove_unfinished
from panokit.io.captures import RECORD
from panokit.ledger import Ledger
from panokit.synthetic import Faults, StreetServer, parse_faults
from tests.fetch.conftest import KEY
from tests.fetch.town import contents, tiles_asked, town, wanted

ENVIRONMENT = os.environ | {"GOOGLE_MAPS_API_KEY": KEY, "OMP_NUM_THREADS": "1"}


@pytest.fixture
def town_server(tmp_path, monkeypatch):
    monkeypatch.setenv("GOOGLE_MAPS_API_KEY", KEY)
    (tmp_path / "served").mkdir()
    with StreetServer(town(tmp_path / "served", 12), key=KEY) as server:
        yield server


def typed(server, out, count, zoom=2, *more):
    """The same run as `wanted`, as it is typed."""
    (place,) = wanted(server.url, count).places
    words = ["fetch", "--source", "google-tiles", "--endpoint", server.url, "--out", out]
    words += ["--point", place.latitude_deg, place.longitude_deg, "--radius-m", place.radius_m]
    words += ["--count", count, "--zoom", zoom, "--requests-per-s", 300, "--min-distance-m", 10]
    return [str(word) for word in (*words, "--accept-terms", "google", *more)]


def started(server, out, count, zoom=2):
    """That run as a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "panokit", *typed(server, out, count, zoom)],
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell starts background jobs deaf to SIGINT, and what they start inherits it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    )


def complete(out):
    return {record.parent.name for record in (out / "captures").glob(f"*/{RECORD}")}


def leftovers(out):
    unfinished = {
        path.name for path in (out / "captures").glob("*") if not (path / RECORD).exists()
    }
    return unfinished | {path.name for path in out.rglob("*.part")}


def killed_again_and_again(server, out, count, zoom, kills, seed):
    """Kill -9 at random moments, then let the last run end; gives how often that worked."""
    chance = random.Random(seed)
    worked = 0
    for _ in range(kills):
        done, before = complete(out) if out.exists() else set(), len(server.requests)
        process = started(server, out, count, zoom)
        moment = before + chance.randint(1, 40)
        while process.poll() is None and len(server.requests) < moment:
            time.sleep(0.002)
        time.sleep(chance.uniform(0, 0.03))
        worked += process.poll() is None
        process.kill()
        process.communicate()
        asked = {f"google-tiles-{name}" for name, _ in tiles_asked(server.requests[before:])}
        assert not asked & done, "a complete panorama was fetched again"
    done, before = complete(out), len(server.requests)
    last = started(server, out, count, zoom)
    _, told = last.communicate(timeout=120)
    assert last.returncode == 0, told
    asked = {f"google-tiles-{name}" for name, _ in tiles_asked(server.requests[before:])}
    assert not asked & done
    return worked


def check_kills(server, tmp_path, *, count, zoom, kills, seed):
    whole = started(server, tmp_path / "whole", count, zoom)
    whole.communicate(timeout=120)
    worked = killed_again_and_again(server, tmp_path / "run", count, zoom, kills, seed)
    assert worked >= kills - 1
    assert contents(tmp_path / "run") == contents(tmp_path / "whole")
    assert len(complete(tmp_path / "run")) == count
    assert leftovers(tmp_path / "run") == set()


def test_killed_three_times(town_server, tmp_path):
    check_kills(town_server, tmp_path, count=12, zoom=2, kills=3, seed=1)


@pytest.mark.slow
def test_killed_twenty_times(tmp_path):
    (tmp_path / "served").mkdir()
    with StreetServer(town(tmp_path / "served", 40), key=KEY) as server:
        check_kills(server, tmp_path, count=40, zoom=3, kills=20, seed=2)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_run_leaves_whole_captures_only(town_server, tmp_path, number, code):
    out = tmp_path / "run"
    town_server.set_faults(parse_faults("slow 100% seconds=0.6 at=/tiles/"))
    process = started(town_server, out, 12, 1)
    while process.poll() is None and len(complete(out)) < 2:
        time.sleep(0.01)
    process.send_signal(number)
    _, told = process.communicate(timeout=60)
    assert process.returncode == code, told
    assert "run the same command" in told.lower()
    assert "Traceback" not in told
    assert 2 <= len(complete(out)) < 12
    assert leftovers(out) == set()
    assert not (out / LOCK).exists()
    town_server.set_faults(Faults())
    assert main(typed(town_server, out, 12, 1)) == 0
    assert len(complete(out)) == 12


@pytest.mark.parametrize(
    ("faults", "code"),
    [("", 0), ("retired=pano-003", 1), ("api-disabled", 8), ("quota-per-day=20", 9)],
)
def test_exit_codes_for_cron(town_server, tmp_path, capsys, faults, code):
    town_server.set_faults(parse_faults(faults))
    assert main(typed(town_server, tmp_path / "run", 12, 1)) == code
    assert "Traceback" not in capsys.readouterr().err
    assert leftovers(tmp_path / "run") == set()


def test_a_verdict_is_remembered_though_the_run_was_stopped(town_server, tmp_path):
    town_server.set_faults(parse_faults("retired=pano-000+pano-001+pano-002, quota-per-day=20"))
    assert main(typed(town_server, tmp_path / "run", 12, 1)) == 9
    verdicts = {one.item: one.reason for one in Ledger(tmp_path / "run/ledger.sqlite").rejections()}
    assert verdicts
    assert set(verdicts.values()) == {"retired"}


def test_two_runs_do_not_work_in_one_folder(town_server, tmp_path):
    with only_run(tmp_path / "run"):
        with pytest.raises(UsageError, match="Another process"):
            fetch(wanted(town_server.url, 1, zoom=1), tmp_path / "run")
        # Looking does no harm.
        fetch(wanted(town_server.url, 1, dry_run=True), tmp_path / "run")
    assert len(fetch(wanted(town_server.url, 1, zoom=1), tmp_path / "run").stored) == 1


def test_only_what_fetch_left_is_removed(tmp_path):
    names = {
        ".fetch.json.x1.part": True,
        "captures/ours/tiles/3_1.jpg": True,
        "captures/ours/tiles/.3_2.jpg.abc.part": True,
        "captures/views/views/0.jpg": True,
        "captures/whole/image.jpg": True,
        "captures/complete/image.jpg": False,
        f"captures/complete/{RECORD}": False,
        f"captures/complete/.{RECORD}.x.part": True,
        "captures/mine/notes.txt": False,
        "captures/mine/image.jpg": False,
        "probes/.other.exr.x.part": False,
    }
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(json.dumps(name))
    assert remove_unfinished(tmp_path) == 3
    assert {name for name in names if not (tmp_path / name).exists()} == {
        name for name, ours in names.items() if ours
    }
    assert remove_unfinished(tmp_path / "nothing") == 0
