"""Starting workers or finding them, with errors that say what to do."""

import logging
import time
from collections.abc import Mapping
from typing import Any, Protocol

import dask
from distributed import Client, LocalCluster
from distributed.security import Security

from panokit.engine.dask.work import Work, kill_worker
from panokit.engine.interrupts import interrupts_held_back
from panokit.engine.protocol import available_cores
from panokit.engine.reach import no_scheduler
from panokit.engine.settings import SLURM_JOBS, ClusterSettings
from panokit.errors import (
    NetworkError,
    PanokitError,
    SettingsError,
    StorageError,
    UsageError,
)

_log = logging.getLogger("panokit.engine")
_COUNT_S = 5.0
_TELL_S = 60.0
# A loss is told at once: who is to blame is decided here. And workers hold receipts alone, so
# there is nothing to spill, and one that pauses would wait for ever.
_CONFIG = {
    "distributed.scheduler.allowed-failures": 0,
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.memory.terminate": 0.95,
    "distributed.comm.retry.count": 3,
}


class Pool(Protocol):
    """Workers that were started."""

    def close(self) -> Any:
        """End them."""
        ...


class Cluster:
    """A connection to workers.

    Args:
        client: The connection.
        address: For messages.
        settings: Of the cluster.
        pool: The workers, if they are ours to end.
        wanted: How many there are to be; all that there are if None.
    """

    def __init__(
        self,
        client: Any,
        address: str,
        settings: ClusterSettings,
        *,
        pool: Pool | None = None,
        wanted: int | None = None,
    ) -> None:
        self.client, self.address = client, address
        self._settings, self._pool, self._wanted = settings, pool, wanted
        self._counted, self._count = -_COUNT_S, 0
        self._told = time.monotonic()
        self._offered: set[str] = set()

    def workers(self) -> int:
        """How many workers there are, or are to come."""
        if self._pool is not None and self._wanted is not None:
            return self._wanted
        now = time.monotonic()
        if now - self._counted > _COUNT_S:
            self._counted = now
            self._count = sum(self._threads().values())
        return max(1, min(self._count, self._wanted or self._count))

    def look(self) -> None:
        """Say so if there has been no worker for long, or no scheduler.

        Raises:
            NetworkError: If the scheduler is gone.
        """
        if self._threads():
            self._told = time.monotonic()
        elif time.monotonic() - self._told > _TELL_S:
            self._told = time.monotonic()
            _log.warning("There is no worker at %s at the moment; waiting.", self.address)

    def check_resources(self, stage: str, needs: Mapping[str, float] | None) -> None:
        """Find out, once, whether any worker can do a stage.

        Raises:
            UsageError: If none offers what it needs.
        """
        if not needs or stage in self._offered:
            return
        known = self.client.sync(self.client.scheduler.identity, n_workers=-1)["workers"].values()
        offers = [worker["resources"] for worker in known]
        if not any(all(o.get(name, 0) >= n for name, n in needs.items()) for o in offers):
            asked = ", ".join(f"{name}={n:g}" for name, n in needs.items())
            raise UsageError(
                f"No worker at {self.address} offers {asked}, which {stage} is to have. Start "
                f'workers with --resources "{asked}", or set worker_resources.'
            )
        self._offered.add(stage)

    def register(self, work: Work, name: str) -> None:
        """Bring a task to all workers.

        Raises:
            PanokitError: If they cannot load it.
        """
        try:
            self.client.register_plugin(work, name=name)
        except PanokitError:
            raise
        except Exception as error:
            raise PanokitError(
                f"The workers at {self.address} cannot load the task ({type(error).__name__}: "
                f"{error}). Install the same packages there as here."
            ) from error

    def unregister(self, name: str) -> None:
        """Let workers forget a task."""
        self.client.unregister_worker_plugin(name)

    def kill(self, worker: str) -> None:
        """Kill a worker that is stuck; another takes its place."""
        try:
            self.client.run(kill_worker, workers=[worker], nanny=True)
        except Exception as error:
            raise PanokitError(
                f"The worker {worker} is stuck and cannot be replaced ({error}). Start workers "
                "with a nanny, as `dask worker` does."
            ) from error

    def close(self) -> None:
        """End the workers that are ours, or leave the others."""
        self.client.close(timeout=5)
        if self._pool is not None:
            self._pool.close()

    def _threads(self) -> dict[str, int]:
        try:
            found: dict[str, int] = self.client.nthreads()
        except (OSError, TimeoutError) as error:
            raise lost_scheduler(self.address) from error
        return found


def open_cluster(name: str, workers: int | None, settings: ClusterSettings) -> Cluster:
    """Start the workers of an engine, or connect to its scheduler.

    Args:
        name: "dask", "slurm" or a scheduler's address.
        workers: How many; see `DaskEngine`.
        settings: Of the cluster.

    Raises:
        NetworkError: If there is no scheduler, or no worker comes.
        UsageError: If versions differ, or there is no Slurm.
        MissingExtraError: If dask-jobqueue is not installed.
    """
    # Not as a context: nannies look here whenever they start a worker anew.
    dask.config.set(_CONFIG)
    if name == "dask":
        return _open_local(workers or available_cores(), settings)
    if name == "slurm":
        return _open_slurm(workers or SLURM_JOBS, settings)
    return _open_address(name, workers, settings)


def lost_scheduler(address: str) -> NetworkError:
    """The error for a scheduler that is gone."""
    return NetworkError(
        f"The scheduler at {address} is gone. What was done is kept: start it again, and run the "
        "same command."
    )


def _open_local(workers: int, settings: ClusterSettings) -> Cluster:
    memory = settings.memory_gb
    try:
        with interrupts_held_back():  # for good in what it starts, and in what that starts
            pool = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                dashboard_address="127.0.0.1:0",  # else a web server for all the network
                memory_limit="auto" if memory is None else int(memory * 1e9),
                silence_logs=logging.CRITICAL,
                security=_security(settings),
                resources=settings.worker_resources or None,
            )
    except (OSError, TimeoutError, RuntimeError) as error:
        raise NetworkError(
            f"The workers did not start ({error}). In a script of your own, run this below "
            '`if __name__ == "__main__":`; else try --engine local.'
        ) from error
    client = Client(pool, timeout=settings.connect_timeout_s)
    return Cluster(client, "this machine", settings, pool=pool, wanted=workers)


def _open_address(address: str, workers: int | None, settings: ClusterSettings) -> Cluster:
    security = _security(settings)
    if address.startswith("tls://") and security is None:
        raise SettingsError(
            f"{address} needs certificates: set cluster.tls_ca, tls_certificate and tls_key."
        )
    try:
        client = Client(
            address, security=security, timeout=settings.connect_timeout_s, set_as_default=False
        )
    except (OSError, TimeoutError, ValueError, RuntimeError) as error:
        raise no_scheduler(address, settings.connect_timeout_s) from error
    cluster = Cluster(client, address, settings, wanted=workers)
    try:
        _check_versions(client, address)
        client.wait_for_workers(1, timeout=settings.connect_timeout_s)
        _check_versions(client, address)
    except TimeoutError as error:
        cluster.close()
        raise NetworkError(
            f"The scheduler at {address} has no workers (waited {settings.connect_timeout_s:g} "
            f"s). Start some with `dask worker {address} --nthreads 1`."
        ) from error
    except PanokitError:
        cluster.close()
        raise
    return cluster


def _check_versions(client: Any, address: str) -> None:
    """Find out whether scheduler and workers speak our language.

    Raises:
        UsageError: If not.
    """
    found = client.get_versions(check=False)
    ours = _essential(found["client"])
    theirs = {f"The scheduler at {address}": found["scheduler"]}
    theirs |= {f"The worker {name}": one for name, one in found["workers"].items()}
    for who, one in theirs.items():
        for package, version in _essential(one).items():
            if version != ours[package]:
                raise UsageError(
                    f"{who} has {package} {version}, this is {ours[package]}. Install the same "
                    "version there as here."
                )


def _essential(versions: Mapping[str, Any]) -> dict[str, str]:
    """Python up to its minor version, and distributed."""
    python = versions["host"]["python"].split(".")[:2]
    return {"Python": ".".join(python), "distributed": versions["packages"]["distributed"]}


def _security(settings: ClusterSettings) -> Any:
    if settings.tls_ca is None:
        return None
    files = [settings.tls_ca, settings.tls_certificate, settings.tls_key]
    for path in files:
        if path is not None and not path.is_file():
            raise StorageError(f"There is no certificate or key {path}. Check the path.")
    ca, certificate, key = (str(path.absolute()) for path in files if path is not None)
    roles = {
        f"tls_{role}_{what}": value
        for role in ("client", "scheduler", "worker")
        for what, value in (("cert", certificate), ("key", key))
    }
    return Security(tls_ca_file=ca, require_encryption=True, **roles)


def _open_slurm(workers: int, settings: ClusterSettings) -> Cluster:
    from panokit.engine.dask.slurm import start_slurm  # its package is an extra

    pool = start_slurm(workers, settings, _security(settings))
    client = Client(pool, timeout=settings.connect_timeout_s)
    where = f"Slurm (look at squeue, and at {settings.slurm.logs} for what jobs print)"
    return Cluster(client, where, settings, pool=pool, wanted=workers)
