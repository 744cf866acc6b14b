"""Jobs as Slurm is asked for them; the real Slurm is in tests/slurm."""

import os
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest

from panokit.engine import ClusterSettings, SlurmSettings, make_engine
from panokit.engine.dask import slurm
from panokit.errors import MissingExtraError, UsageError
from panokit.records import Receipt


def work(item: str) -> Receipt:
    return Receipt(item=item, stage="test", path=Path(item), key="")


def test_slurm_without_its_package_or_its_commands(monkeypatch):
    monkeypatch.setitem(sys.modules, "dask_jobqueue", None)
    with pytest.raises(MissingExtraError, match=r"panokit\[slurm\]"):
        list(make_engine("slurm", 2).run(work, ["a"]))
    fake = ModuleType("dask_jobqueue")
    fake.SLURMCluster = None
    monkeypatch.setitem(sys.modules, "dask_jobqueue", fake)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(UsageError, match="no sbatch on the PATH"):
        list(make_engine("slurm", 2).run(work, ["a"]))


class FakeSlurm:
    """Notes what it is asked for."""

    def __init__(self, **options):
        self.options, self.asked, self.closed = options, Counter(), False
        FakeSlurm.last = self

    def job_script(self):
        return "#!/bin/sh"

    def adapt(self, **options):
        self.asked.update(options)

    def close(self):
        self.closed = True


@pytest.fixture
def fake_slurm(monkeypatch, tmp_path):
    fake = ModuleType("dask_jobqueue")
    fake.SLURMCluster = FakeSlurm
    monkeypatch.setitem(sys.modules, "dask_jobqueue", fake)
    sbatch = tmp_path / "bin" / "sbatch"
    sbatch.parent.mkdir()
    sbatch.write_text('#!/bin/sh\ntest -z "$REFUSE" || { echo "$REFUSE" >&2; exit 1; }\n')
    sbatch.chmod(0o755)
    monkeypatch.setenv("PATH", f"{sbatch.parent}:{os.environ['PATH']}")
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("fake_slurm")
def test_slurm_jobs_ask_for_what_the_settings_say():
    settings = ClusterSettings(
        memory_gb=8,
        worker_resources={"GPU": 1},
        slurm=SlurmSettings(
            partition="gpu", walltime_h=2.5, directives=("--gres=gpu:1",), secure=False
        ),
    )
    slurm.start_slurm(3, settings, None)
    asked = FakeSlurm.last.options
    assert FakeSlurm.last.asked == {"minimum_jobs": 3, "maximum_jobs": 3}
    assert (asked["queue"], asked["walltime"], asked["cores"]) == ("gpu", "02:30:00", 1)
    assert asked["memory"] == "8000000000 B"
    assert asked["job_extra_directives"] == ["--gres=gpu:1"]
    arguments = " ".join(asked["worker_extra_args"])
    assert '--resources "GPU=1"' in arguments
    assert "--lifetime 8400s" in arguments


@pytest.mark.usefixtures("fake_slurm")
def test_what_slurm_refuses_is_told_before_anything_waits(monkeypatch):
    monkeypatch.setenv("REFUSE", "sbatch: error: invalid partition specified: gpus")
    settings = ClusterSettings(slurm=SlurmSettings(secure=False))
    with pytest.raises(UsageError, match=r"invalid partition specified: gpus\. Change"):
        slurm.start_slurm(1, settings, None)
    assert FakeSlurm.last.closed


@pytest.mark.usefixtures("fake_slurm")
def test_slurm_is_encrypted_unless_told_otherwise(monkeypatch):
    made = object()
    monkeypatch.setattr(slurm.Security, "temporary", staticmethod(lambda: made))
    slurm.start_slurm(1, ClusterSettings(), None)
    assert FakeSlurm.last.options["security"] is made
    assert FakeSlurm.last.options["protocol"] == "tls://"

    def absent():
        raise ImportError("cryptography")

    monkeypatch.setattr(slurm.Security, "temporary", staticmethod(absent))
    with pytest.raises(MissingExtraError, match="cryptography"):
        slurm.start_slurm(1, ClusterSettings(), None)
