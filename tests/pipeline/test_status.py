"""Looks at a run: what it would take, how far it is, what belongs to it; and only one driver."""

import json
import subprocess
import sys
import time

import pytest

from panokit.cli.main import main
from panokit.errors import UsageError
from panokit.expand.settings import ExpandSettings
from panokit.fetch.settings import FetchSettings
from panokit.ledger import Ledger
from panokit.pipeline import run_pipeline
from panokit.pipeline.orphans import find_orphans, remove_orphans
from panokit.pipeline.planning import files_per_panorama, plan_pipeline
from panokit.pipeline.settings import AreaSettings, QuotaSettings
from panokit.pipeline.status import run_status
from panokit.records import RunFolder


@pytest.fixture
def finished(settings, console):
    run_pipeline(settings, console)
    return settings


def by_stage(status):
    return {stage.stage: stage for stage in status.stages}


def test_the_status_counts_what_is_done_rejected_and_waiting(settings, console):
    with pytest.raises(UsageError, match="no run"):
        run_status(settings)
    run_pipeline(settings, console, stop_after="stitch")
    stages = by_stage(run_status(settings))
    assert (stages["fetch"].done, stages["fetch"].waiting) == (3, 0)
    assert stages["fetch"].rejected == {"truncated": 1}
    assert (stages["stitch"].done, stages["stitch"].waiting) == (3, 0)
    assert stages["stitch"].per_hour > 0
    assert (stages["inpaint"].done, stages["inpaint"].waiting) == (0, 3)
    assert run_status(settings).driver == ""


def test_the_index_is_made_anew_from_the_log_and_has_the_same_content(finished, console):
    run = RunFolder(finished.folder())
    before = Ledger(run.ledger).content()
    assert {outcome for *_, outcome in before} == {"done", "truncated"}
    run.ledger.unlink()
    with run.log_file.open("a") as file:
        file.write('{"event": "done", "item": "cut o')
    assert run_pipeline(finished, console).nothing_to_do
    assert Ledger(run.ledger).content() == before


def test_an_index_without_a_log_is_made_anew_from_the_records(finished, console):
    run = RunFolder(finished.folder())
    before = Ledger(run.ledger).content()
    run.ledger.unlink()
    run.log_file.unlink()
    run_pipeline(finished, console)
    assert Ledger(run.ledger).content() == before


def test_a_clock_that_jumps_changes_nothing(settings, console, monkeypatch):
    clock = iter([2e9, 1e3] * 1000)
    monkeypatch.setattr(time, "time", lambda: next(clock))
    run_pipeline(settings, console, stop_after="stitch")
    assert by_stage(run_status(settings))["stitch"].per_hour > 0
    assert run_pipeline(settings, console, stop_after="stitch").nothing_to_do


_DRIVER = """
import sys, time
from pathlib import Path
from panokit.io.lock import only_process
from panokit.pipeline.runner import LOCK
with only_process(Path(sys.argv[1]), LOCK, "running a pipeline in"):
    print("held", flush=True)
    time.sleep(60)
"""


def test_a_second_driver_is_refused_and_told_who_the_first_is(finished, console):
    folder = finished.folder()
    command = [sys.executable, "-c", _DRIVER, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as first:
        assert first.stdout.readline() == b"held\n"
        with pytest.raises(UsageError, match=rf"{first.pid} on .*running a pipeline in"):
            run_pipeline(finished, console)
        with pytest.raises(UsageError, match=str(first.pid)):
            remove_orphans(finished)
        status = run_status(finished)
        assert str(first.pid) in status.driver
        first.kill()
    assert run_status(finished).driver == ""
    assert run_pipeline(finished, console).nothing_to_do


def test_orphans_are_listed_then_deleted_and_nothing_else(finished, console, pictures):
    assert find_orphans(finished) == []
    (pictures / "street1.jpg").unlink()
    fewer = finished.model_copy(update={"fetch": finished.fetch.model_copy(update={"seed": 1})})
    run_pipeline(fewer, console)
    root = finished.folder()
    (root / "probes" / ".x.exr.abc.part").write_bytes(b"half")
    (root / "probes" / "folder-street0.notes.txt").write_text("mine")
    listed = find_orphans(fewer)
    names = {str(orphan.path.relative_to(root)) for orphan in listed}
    gone = "folder-street1"
    assert {f"captures/{gone}", f"probes/{gone}.exr", f"probes/{gone}.json",
            f"panoramas/{gone}.jpg", "probes/.x.exr.abc.part"} <= names  # fmt: skip
    assert not any("street0" in name or "street2" in name for name in names)
    assert remove_orphans(fewer) == listed
    assert not (root / f"probes/{gone}.exr").exists()
    assert (root / "probes" / "folder-street0.notes.txt").exists()
    assert run_pipeline(fewer, console).nothing_to_do


def test_orphans_of_a_run_that_has_not_fetched_are_not_known(settings):
    settings.folder().mkdir(parents=True)
    with pytest.raises(UsageError, match="has not finished"):
        find_orphans(settings)


def test_a_plan_starts_nothing_and_counts_requests_money_and_days(settings):
    fetch = FetchSettings(source="google-tiles", width_px=4096, count=600,
                          accept_terms=("google",))  # fmt: skip
    areas = (
        AreaSettings(cities=("Lyon, FR",)),
        AreaSettings(cities=("Paris, FR",), count=400),
    )
    asked = settings.model_copy(
        update={"fetch": fetch, "areas": areas, "quota": QuotaSettings(max_requests=20_000)}
    )
    plan = plan_pipeline(asked)
    stages = {stage.stage: stage for stage in plan.stages}
    assert stages["fetch"].items == 1000
    assert stages["fetch"].requests > 32_000
    assert stages["fetch"].cost_usd == pytest.approx(64.0)
    assert plan.quota_days == 3
    assert not plan.within_quota
    assert stages["inpaint"].cpu_s > stages["stitch"].cpu_s > 0
    assert plan.total("bytes") > 1e9
    assert not asked.folder().exists()


@pytest.mark.parametrize(
    ("asked", "workers"),
    [
        ({"engine": "serial", "workers": 5}, 1),
        ({"engine": "local", "workers": 5}, 5),
        ({"engine": "slurm"}, 1),  # as many jobs as then are submitted
        ({"engine": "tcp://far:8786"}, 1),  # not as many as this machine has cores
    ],
)
def test_a_plan_is_for_the_workers_that_there_will_be(settings, asked, workers):
    assert plan_pipeline(settings.model_copy(update=asked)).workers == workers


def test_what_is_done_is_not_planned_again(finished):
    stages = {s.stage: s for s in plan_pipeline(finished).stages}
    # Nobody knows before how many pictures a folder has.
    assert stages["fetch"].items is None
    assert stages["expand"].done == 3
    assert stages["expand"].cpu_s == 0


@pytest.mark.parametrize(
    ("settings_", "files"),
    [
        ({}, 1),
        ({"source": "google-tiles", "width_px": 4096}, 32),
        ({"source": "google-tiles", "zoom": 5}, 512),
        ({"source": "google-static"}, 22),
    ],
)
def test_files_of_a_panorama(settings_, files):
    assert files_per_panorama(FetchSettings(**settings_)) == files


def test_the_command_looks_without_touching(finished, pictures, tmp_path, capsys):
    path = tmp_path / "p.toml"
    path.write_text(
        f'name = "tiny"\noutput = "{finished.folder()}"\n[fetch]\nsource = "folder"\n'
        f'folder = "{pictures}"\nlicense = "CC0-1.0"\n[inpaint]\n[expand]\nmodel = "reinhard"\n'
        "width_px = 128\n"
    )
    assert main(["run", str(path), "--plan"]) == 0
    assert "Nothing was started" in capsys.readouterr().out
    assert main(["run", str(path), "--status", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["stages"][0]["rejected"] == {"truncated": 1}
    assert main(["run", str(path), "--orphans"]) == 0
    assert "0 orphans" in capsys.readouterr().out
    assert main(["run", str(path), "--plan", "--status"]) == 2
    assert main(["run", str(path), "--stop-after", "train"]) == 2


def test_another_expansion_runs_expand_and_what_follows(finished, console):
    changed = finished.model_copy(update={"expand": ExpandSettings(model="srgb", width_px=128)})
    result = run_pipeline(changed, console)
    fresh = {batch.stage: batch.fresh for batch in result.batches}
    assert (fresh["stitch"], fresh["inpaint"], fresh["expand"]) == (0, 0, 3)
    stages = json.loads((finished.folder() / "timings.json").read_text())["stages"]
    assert stages["expand"]["fresh"] == 3
    page = (finished.folder() / "report.html").read_text()
    assert "truncated" in page
    assert "Energy ledger" in page
