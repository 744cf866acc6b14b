import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from panokit.dataset.production.maker import SampleMaker
from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.settings import DatasetSettings
from panokit.dataset.storage.layout import LOCK, DatasetFolder
from panokit.dataset.storage.read import StereoDataset
from panokit.dataset.storage.shards import read_members
from panokit.engine import LocalEngine
from panokit.errors import MissingExtraError, PanokitError, SettingsError, UsageError
from panokit.io.lock import only_process
from tests.dataset.conftest import COUNT, SHARD
from tests.dataset.fake import FakeMaker

ROOT = Path(__file__).parents[3]


def render(out, maker: SampleMaker | None = None, **changes):
    wanted = {"count": COUNT, "shard_samples": SHARD, "workers": 0, **changes}
    return render_dataset(maker or FakeMaker(), out, ProductionSettings(**wanted))


def contents(folder):
    """All that a dataset promises to be the same, whatever happened on the way."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in ("log.jsonl", "failures.jsonl", "README.md")
    }


def failures(folder):
    path = DatasetFolder(folder).failures
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def test_a_dataset_holds_what_the_maker_makes(finished_dataset):
    dataset = StereoDataset(finished_dataset)
    assert sorted(dataset.keys) == [f"{index:09d}" for index in range(COUNT)]
    for index in (0, 7, 39):
        number = dataset.number_of(f"{index:09d}")
        expected = FakeMaker().make(index, 0).members
        assert set(dataset.names(number)) == set(expected)
        for name, data in expected.items():
            assert dataset.read(number, name) == data
    assert not DatasetFolder(finished_dataset).work.exists()


def test_processes_make_the_same_bytes_as_none(finished_dataset, tmp_path):
    result = render(tmp_path / "stereo", workers=2)
    assert contents(tmp_path / "stereo") == contents(finished_dataset)
    assert (result.samples, result.made, result.missing) == (COUNT, COUNT, {})


def test_a_finished_dataset_is_left_alone(own_dataset):
    before = {path: path.stat().st_mtime_ns for path in own_dataset.rglob("*.*")}
    result = render(own_dataset)
    assert (result.samples, result.made) == (COUNT, 0)
    after = {path: path.stat().st_mtime_ns for path in own_dataset.rglob("*.*")}
    assert {path for path in after if after[path] != before.get(path)} == {
        own_dataset / "log.jsonl"
    }


def test_rejected_attempts_are_drawn_anew_and_counted(tmp_path):
    maker = FakeMaker(troubles={3: "blank-twice", 5: "crash-once", 7: "blank"})
    result = render(tmp_path, maker)
    assert result.samples == COUNT - 1
    assert result.missing == {"000000007": "blank-mask"}
    assert result.rejected == {"blank-mask": 22, "ZeroDivisionError": 1}
    dataset = StereoDataset(tmp_path)
    assert dataset.meta(dataset.number_of("000000003"))["attempt"] == 2
    number = dataset.number_of("000000005")
    assert dataset.read(number, "left.png") == maker.make(5, 1).members["left.png"]
    told = failures(tmp_path)
    (crash,) = (line for line in told if line["kind"] == "failed")
    assert crash["seed"] == [0, 5, 0]
    assert "in _misbehave" in crash["traceback"]
    assert [line["index"] for line in told if line["kind"] == "missing"] == [7]


def test_samples_that_could_not_be_made_may_be_tried_again(tmp_path, finished_dataset):
    render(tmp_path, FakeMaker(troubles={7: "blank"}))
    assert render(tmp_path).samples == COUNT - 1
    made = {name: data for name, data in contents(tmp_path).items() if name.endswith(".tar")}
    result = render(tmp_path, retry_missing=True)
    assert (result.samples, result.made, result.missing) == (COUNT, 1, {})
    assert contents(tmp_path) == contents(finished_dataset)
    assert sum(data != contents(tmp_path)[name] for name, data in made.items()) == 1


def test_a_dataset_may_grow(tmp_path, finished_dataset):
    first = render(tmp_path, count=21)
    assert first.samples == 21
    result = render(tmp_path)
    # Of the shards that were not full, too, nothing is rendered twice.
    assert result.made == COUNT - 21
    assert contents(tmp_path) == contents(finished_dataset)


def test_the_count_decides_the_shards_where_nobody_says(tmp_path):
    render(tmp_path, count=20, shard_samples=None)
    assert len(DatasetFolder(tmp_path).complete_shards()) == 3
    # What the folder has then holds, whatever the new count would suggest.
    render(tmp_path, count=24, shard_samples=None)
    with pytest.raises(SettingsError, match="shard_samples was 16 and is 8"):
        render(tmp_path, count=24)


@pytest.mark.parametrize(
    ("changes", "settings", "text"),
    [
        ({}, {"seed": 3}, "seed was 0 and is 3"),
        ({}, {"rig": {"width_px": 64}}, "rig.width_px was 256 and is 64"),
        ({"count": COUNT - 1}, {}, "may grow, but not shrink to 39"),
    ],
)
def test_what_was_made_otherwise_is_not_continued(own_dataset, changes, settings, text):
    before = contents(own_dataset)
    maker = FakeMaker(settings=DatasetSettings(renderer="analytic", **settings))
    with pytest.raises(SettingsError, match=text) as caught:
        render(own_dataset, maker, **changes)
    assert "--out" in str(caught.value)
    assert contents(own_dataset) == before


def test_somebody_elses_shards_are_not_touched(tmp_path):
    (tmp_path / "shards").mkdir()
    (tmp_path / "shards" / "train-00000.tar").write_bytes(b"mine")
    with pytest.raises(SettingsError, match=r"no dataset\.json"):
        render(tmp_path)
    assert (tmp_path / "shards" / "train-00000.tar").read_bytes() == b"mine"


def test_two_drivers_in_one_folder(tmp_path):
    with (
        only_process(tmp_path, LOCK, "rendering into"),
        pytest.raises(UsageError, match=r"Another process \(.*\) is rendering into"),
    ):
        render(tmp_path)


def test_a_run_that_cannot_work_ends_at_once(tmp_path):
    for workers in (0, 2):
        with pytest.raises((MissingExtraError, PanokitError), match=r"panokit\[render\]"):
            render(tmp_path, FakeMaker(troubles={4: "no-extra"}), workers=workers)


def test_if_nothing_comes_of_it_the_run_ends(tmp_path):
    with pytest.raises(PanokitError, match=r"12 times in a row .* blank-mask"):
        render(tmp_path, FakeMaker(troubles=dict.fromkeys(range(COUNT), "blank")))


def test_a_worker_that_dies_does_not_end_the_run(tmp_path, finished_dataset):
    marks = tmp_path / "marks"
    marks.mkdir()
    out = tmp_path / "stereo"
    maker = FakeMaker(troubles={2: "dies-once", 11: "dies-once"}, marks=marks)
    result = render(out, maker, workers=2)
    assert result.samples == COUNT
    assert {line["reason"] for line in failures(out)} == {"worker-died"}
    assert contents(out) == contents(finished_dataset)


def test_a_sample_that_always_kills_its_worker_is_left_out(tmp_path):
    result = render(tmp_path, FakeMaker(troubles={2: "dies"}), count=24, workers=1)
    assert result.missing == {"000000002": "worker-died"}
    assert result.samples == 23
    # Three attempts, three times each.
    assert len([line for line in failures(tmp_path) if line["kind"] == "failed"]) == 9


def test_an_attempt_that_hangs_is_ended_and_the_next_one_taken(tmp_path):
    started = time.monotonic()
    result = render(tmp_path, FakeMaker(troubles={2: "hangs"}), count=16, workers=1, timeout_s=3)
    assert time.monotonic() - started < 200
    assert (result.samples, result.rejected) == (16, {"timeout": 1})
    dataset = StereoDataset(tmp_path)
    assert dataset.meta(dataset.number_of("000000002"))["attempt"] == 1


def test_a_full_disk_is_told_and_nothing_is_lost(tmp_path, finished_dataset, monkeypatch):
    spooled = 0
    write = Path.write_bytes

    def fails_later(path, data):
        nonlocal spooled
        if path.name.endswith(".part") and ".sample" in path.name:
            spooled += 1
            if spooled > 11:
                raise OSError(28, os.strerror(28))
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", fails_later)
    with pytest.raises(PanokitError, match=r"The disk is full: free some space"):
        render(tmp_path)
    monkeypatch.undo()
    assert list(tmp_path.rglob("*.part")) == []
    assert render(tmp_path).made == COUNT - 11
    assert contents(tmp_path) == contents(finished_dataset)


_DRIVER = """
import sys
from pathlib import Path
from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from tests.dataset.fake import FakeMaker
if __name__ == "__main__":
    production = ProductionSettings(count=40, shard_samples=8, workers=int(sys.argv[2]))
    render_dataset(FakeMaker(seconds=float(sys.argv[3])), Path(sys.argv[1]), production)
"""


def start_driver(tmp_path, out, workers, seconds, **options):
    script = tmp_path / "driver.py"
    script.write_text(_DRIVER)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, str(script), str(out), str(workers), str(seconds)]
    return subprocess.Popen(command, env=environment, cwd=ROOT, text=True, **options)


def test_a_file_that_may_not_grow_ends_the_run_with_a_reason(tmp_path, finished_dataset):
    """The kernel's own refusal, at the place where a shard is written."""
    limit = 200_000  # more than a sample, less than a shard

    def set_limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    out = tmp_path / "stereo"
    driver = start_driver(tmp_path, out, 0, 0, stderr=subprocess.PIPE, preexec_fn=set_limit)
    _, told = driver.communicate(timeout=240)
    assert driver.returncode != 0
    assert "StorageError: Cannot write" in told
    assert list(out.rglob("*.tar*")) == []
    assert render(out).made == COUNT - SHARD
    assert contents(out) == contents(finished_dataset)


def descendants(pid):
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            yield int(child)


def test_drivers_and_workers_are_killed_at_random(tmp_path, finished_dataset):
    """However often the driver or a worker is killed, the shards are the same in the end."""
    out = tmp_path / "stereo"
    chance = random.Random(4)
    for kill_driver in (True, True, False):
        driver = start_driver(tmp_path, out, 2, 0.15, stderr=subprocess.DEVNULL)
        before = len(list(out.rglob("*.sample")))
        deadline = time.monotonic() + 240
        while len(list(out.rglob("*.sample"))) <= before and time.monotonic() < deadline:
            time.sleep(0.02)
        time.sleep(chance.uniform(0, 0.6))
        workers = [
            pid
            for pid in descendants(driver.pid)
            if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()
        ]
        assert len(workers) == 2
        os.kill(driver.pid if kill_driver else chance.choice(workers), signal.SIGKILL)
        assert driver.wait(timeout=240) == (-signal.SIGKILL if kill_driver else 0)
    assert contents(out) == contents(finished_dataset)


def test_an_index_that_is_behind_is_made_again(own_dataset, finished_dataset):
    index = own_dataset / "index.parquet"
    (own_dataset / "README.md").unlink()
    index.write_bytes(b"not parquet")
    assert render(own_dataset).made == 0
    assert contents(own_dataset) == contents(finished_dataset)
    assert (own_dataset / "README.md").exists()


def test_a_damaged_shard_is_made_again(own_dataset, finished_dataset):
    shard = own_dataset / "shards" / "train-00001.tar"
    keys = {member.key for member in read_members(shard)}
    shard.write_bytes(shard.read_bytes()[:-5000])
    assert render(own_dataset).made == len(keys) == SHARD
    assert contents(own_dataset) == contents(finished_dataset)


def test_workers_are_replaced_before_they_grow(tmp_path, monkeypatch):
    asked = []
    plain = LocalEngine.__init__

    def noting(self, *args, **options):
        asked.append(options["items_per_worker"])
        plain(self, *args, **options)

    monkeypatch.setattr(LocalEngine, "__init__", noting)
    render(tmp_path, count=4, workers=1, shard_samples=250)
    assert asked == [2]


def test_a_script_that_starts_itself_again_is_told_so(tmp_path):
    script = tmp_path / "unguarded.py"
    body = _DRIVER.replace('if __name__ == "__main__":\n', "if True:\n")
    script.write_text(body)
    command = [sys.executable, str(script), str(tmp_path / "s"), "1", "0"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        command, env=environment, cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    assert 'below `if __name__ == "__main__":`' in done.stderr


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_command_leaves_order(library, tmp_path, number, code):
    out = tmp_path / "stereo"
    base = [
        *(sys.executable, "-m", "panokit", "dataset", "render", "--probes", str(library)),
        *("--out", str(out), "--count", "40", "--renderer", "analytic"),
        *("--rig.width-px", "32", "--objects.per-kind", "3", "--objects.kinds", "vase"),
    ]
    command = [*base, "--workers", "2"]
    driver = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, start_new_session=True,
        # A shell starts background jobs deaf to SIGINT, and what they start inherits it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    )  # fmt: skip
    deadline = time.monotonic() + 240
    while len(list(out.rglob("*.sample"))) < 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    # As a terminal does it: the whole group is told.
    os.killpg(driver.pid, number)
    _, told = driver.communicate(timeout=120)
    assert driver.returncode == code
    assert told.splitlines()[-1] == (
        "panokit: Interrupted; what was done is kept. Run the same command to go on."
    )
    assert "Traceback" not in told
    assert not (out / LOCK).exists()
    kept = len(list(out.rglob("*.sample")))
    assert kept >= 2
    if number == signal.SIGINT:
        command = [*base, "--workers", "0", "--json"]
        again = subprocess.run(command, capture_output=True, text=True, check=True)
        assert json.loads(again.stdout)["samples"] == 40
        assert json.loads(again.stdout)["made"] <= 40 - kept
