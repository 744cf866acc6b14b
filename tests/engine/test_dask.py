"""What the engine on Dask does beyond the laws of engines."""

import os
import shutil
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from pydantic import ValidationError

from panokit.engine import ClusterSettings, Quarantine, make_engine
from panokit.engine import turns as shared_turns
from panokit.engine.dask import clusters
from panokit.engine.dask.clusters import Cluster
from panokit.engine.settings import check_engine_name
from panokit.errors import (
    NetworkError,
    PanokitError,
    SettingsError,
    StorageError,
    UsageError,
)
from panokit.http.limiter import RateLimiter
from panokit.records import Receipt

pytestmark = pytest.mark.slow


def receipt(item: str, value: object = "") -> Receipt:
    return Receipt(item=item, stage="test", path=Path(item), key=str(value))


def work(item: str) -> Receipt:
    return receipt(item, os.getpid())


@pytest.fixture(scope="module")
def address():
    """Of a scheduler with two workers, started and kept by an engine."""
    engine = make_engine("dask", 2, ClusterSettings(worker_resources={"GPU": 1}))
    assert [outcome.item for outcome in engine.run(work, ["a"])] == ["a"]
    yield engine._cluster.client.scheduler.address
    engine.close()


def test_a_scheduler_is_used_by_its_address_and_left_as_it_was(address):
    for _ in range(2):
        engine = make_engine(address)
        outcomes = list(engine.run(work, [f"i{n}" for n in range(9)]))
        engine.close()
        assert len(outcomes) == 9
        assert str(os.getpid()) not in {outcome.key for outcome in outcomes}


def take_turns(item: str) -> Receipt:
    limiter = RateLimiter(rate_per_s=1000, burst=1000)
    stopped = threading.Event()
    moments = []
    for _ in range(5):
        # As `RateLimiter.wait` does, whose own rate must not be what is measured here.
        shared_turns.wait_for_turn("host", 10.0, 2, stopped)
        limiter.wait("another host")
        moments.append(time.monotonic())
    return receipt(item, moments)


def test_workers_share_the_rate_of_a_host(address):
    engine = make_engine(address)
    outcomes = list(engine.run(take_turns, ["a", "b"]))
    engine.close()
    moments = sorted(moment for outcome in outcomes for moment in eval(outcome.key))
    assert len(moments) == 10
    # Two leases, each kept for 0.2 s: any third turn comes so long after the first.
    assert min(late - early for early, late in zip(moments, moments[2:], strict=False)) > 0.15


def test_a_limiter_waits_for_the_shared_turn_too(monkeypatch):
    asked = []
    monkeypatch.setattr(shared_turns, "_taker", lambda *asking: asked.append(asking[:3]))
    RateLimiter(rate_per_s=50, burst=10).wait("example.org")
    assert asked == [("example.org", 50, 10)]


def hang(item: str) -> Receipt:
    if item == "hangs":
        time.sleep(600)
    return receipt(item)


def test_a_silent_worker_is_killed_and_its_item_left_out(address):
    engine = make_engine(address, silence_s=2, on_loss=Quarantine(most_losses=1))
    outcomes = list(engine.run(hang, ["hangs", "b", "c", "d"]))
    engine.close()
    reasons = {outcome.item: getattr(outcome, "reason", "") for outcome in outcomes}
    assert reasons == {"hangs": "hangs-worker", "b": "", "c": "", "d": ""}


def test_stages_get_the_workers_that_offer_what_they_need(address):
    settings = ClusterSettings(resources={"expand": {"GPU": 1}, "stitch": {"TPU": 4}})
    engine = make_engine(address, cluster=settings)
    expand = SimpleNamespace(item="a", stage="expand")
    assert [outcome.item for outcome in engine.run(work_on, [expand])] == ["a"]
    with pytest.raises(UsageError, match="offers TPU=4, which stitch is to have"):
        list(engine.run(work_on, [SimpleNamespace(item="a", stage="stitch")]))
    engine.close()


def work_on(item: SimpleNamespace) -> Receipt:
    return receipt(item.item)


def test_a_worker_without_the_drivers_files_says_so(address, tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    engine = make_engine(address)
    outcomes = engine.run(work, remove_first(gone))
    with pytest.raises(StorageError, match=r"has no folder .*gone\. Workers and driver share"):
        list(outcomes)
    engine.close()


def remove_first(folder: Path):
    yield "a"
    folder.rmdir()
    yield "b"


def test_another_version_of_panokit_is_refused(address, monkeypatch):
    monkeypatch.setattr("panokit.engine.dask.work.__version__", "99.0")
    engine = make_engine(address)
    with pytest.raises(UsageError, match=r"has panokit 0.*, this is 99\.0\. Install the same"):
        list(engine.run(work, ["a"]))
    engine.close()


def test_nothing_starts_without_an_item():
    engine = make_engine("dask", 2)
    assert list(engine.run(work, [])) == []
    assert engine._cluster is None
    engine.close()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def test_a_scheduler_that_is_not_there():
    engine = make_engine(
        f"tcp://127.0.0.1:{free_port()}", cluster=ClusterSettings(connect_timeout_s=0.5)
    )
    with pytest.raises(NetworkError, match=r"no Dask scheduler at .* \(waited 0.5 s\)"):
        list(engine.run(work, ["a"]))
    engine.close()


@pytest.fixture
def scheduler():
    port = free_port()
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard"]
    with subprocess.Popen(
        [*command, "--host", "127.0.0.1", "--port", str(port)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as process:
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline:
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                time.sleep(0.2)
        yield SimpleNamespace(address=f"tcp://127.0.0.1:{port}", process=process)
        process.kill()


def test_a_scheduler_without_workers(scheduler):
    engine = make_engine(scheduler.address, cluster=ClusterSettings(connect_timeout_s=5))
    with pytest.raises(NetworkError, match="has no workers"):
        list(engine.run(work, ["a"]))


def test_a_scheduler_that_dies_ends_the_run_with_a_reason(scheduler):
    command = [sys.executable, "-m", "distributed.cli.dask_worker", scheduler.address]
    with subprocess.Popen(
        [*command, "--nthreads", "1", "--no-dashboard", "--no-nanny"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as worker:
        settings = ClusterSettings(connect_timeout_s=120)
        engine = make_engine(scheduler.address, cluster=settings)
        outcomes = engine.run(work, range_of_names(500))
        next(outcomes)
        engine._cluster.client._timeout = 1  # how long it hopes for the scheduler's return
        scheduler.process.kill()
        with pytest.raises(NetworkError, match=r"scheduler at .* is gone\. What was done is kept"):
            list(outcomes)
        engine.close()
        worker.kill()


def range_of_names(count: int):
    for n in range(count):
        yield f"i{n}"


def versions(python: str = "3.11.2", distributed: str = "2026.8.0"):
    return {"host": {"python": python}, "packages": {"distributed": distributed}}


@pytest.mark.parametrize(
    ("found", "text"),
    [
        (
            {"scheduler": versions(distributed="2024.9.0")},
            "The scheduler at s has distributed 2024",
        ),
        ({"workers": {"w": versions("3.12.1")}}, "The worker w has Python 3.12, this is 3.11"),
    ],
)
def test_other_versions_are_refused(found, text):
    good = {"client": versions(), "scheduler": versions("3.11.9"), "workers": {}}
    clusters._check_versions(SimpleNamespace(get_versions=lambda check: good), "s")
    with pytest.raises(UsageError, match=text):
        clusters._check_versions(SimpleNamespace(get_versions=lambda check: good | found), "s")


def test_a_scheduler_that_goes_away_is_told():
    def nothing():
        raise OSError("timed out")

    cluster = Cluster(SimpleNamespace(nthreads=nothing), "tcp://there:1", ClusterSettings())
    with pytest.raises(NetworkError, match=r"scheduler at tcp://there:1 is gone\. What was done"):
        cluster.look()


@pytest.mark.parametrize("name", ["serial", "local", "dask", "slurm", "tcp://a:1", "tls://[::1]:2"])
def test_names_of_engines(name):
    assert check_engine_name(name) == name


@pytest.mark.parametrize("name", ["", "ray", "tcp://", "tcp://host", "tcp://host:x", "http://a:1"])
def test_names_that_are_none(name):
    with pytest.raises(UsageError, match="choose serial, local, dask, slurm"):
        make_engine(name)


def test_certificates_come_together_and_tls_needs_them(tmp_path):
    with pytest.raises(ValidationError, match="belong together"):
        ClusterSettings(tls_ca=tmp_path / "ca.pem")
    with pytest.raises(SettingsError, match=r"needs certificates: set cluster\.tls_ca"):
        list(make_engine("tls://127.0.0.1:1").run(work, ["a"]))
    files = {name: tmp_path / name for name in ("tls_ca", "tls_certificate", "tls_key")}
    with pytest.raises(StorageError, match=r"no certificate or key .*tls_ca"):
        list(make_engine("tls://127.0.0.1:1", cluster=ClusterSettings(**files)).run(work, ["a"]))


@pytest.fixture
def certificate(tmp_path):
    if shutil.which("openssl") is None:
        pytest.skip("openssl makes the certificate")
    paths = {"tls_certificate": tmp_path / "cert.pem", "tls_key": tmp_path / "key.pem"}
    request = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1"]
    subprocess.run(
        [*request, "-subj", "/CN=panokit", "-out", paths["tls_certificate"], "-keyout",
         paths["tls_key"]],
        check=True, capture_output=True,
    )  # fmt: skip
    return ClusterSettings(tls_ca=paths["tls_certificate"], connect_timeout_s=20, **paths)


def test_what_is_encrypted_is_open_to_who_has_the_certificate_alone(certificate):
    engine = make_engine("dask", 1, certificate)
    assert len(list(engine.run(work, ["a"]))) == 1
    address = engine._cluster.client.scheduler.address
    assert address.startswith("tls://")
    guest = make_engine(address, cluster=certificate)
    assert len(list(guest.run(work, ["b"]))) == 1
    guest.close()
    stranger = make_engine(
        address.replace("tls", "tcp"), cluster=ClusterSettings(connect_timeout_s=1)
    )
    with pytest.raises(NetworkError, match="no Dask scheduler"):
        list(stranger.run(work, ["c"]))
    engine.close()


def unknown_to_workers(item: str) -> Receipt:
    return receipt(item)


def test_a_task_that_workers_cannot_load(address, monkeypatch):
    # As where a package is installed here, but not there.
    monkeypatch.setattr(unknown_to_workers, "__module__", "only_here")
    here = ModuleType("only_here")
    here.unknown_to_workers = unknown_to_workers
    monkeypatch.setitem(sys.modules, "only_here", here)
    engine = make_engine(address)
    with pytest.raises(PanokitError, match="Install the same packages there as here"):
        list(engine.run(unknown_to_workers, ["a"]))
    engine.close()
