"""Workers as Slurm jobs: each job holds one, and a job that ends is replaced."""

import shutil
import subprocess
import sys
import tempfile
from datetime import timedelta
from pathlib import Path
from typing import Any

from distributed.security import Security

from panokit.engine.settings import ClusterSettings
from panokit.errors import MissingExtraError, UsageError
from panokit.io.files import storage_error

_MEMORY_GB = 4.0
# Workers leave so long before their job's time is over, and not all at once.
_LEAVE_S, _STAGGER_S = 600, 120
# Jobs read no settings of the driver's; see `clusters`.
_ENVIRONMENT = (
    "export DASK_DISTRIBUTED__WORKER__MEMORY__TARGET=False",
    "export DASK_DISTRIBUTED__WORKER__MEMORY__SPILL=False",
    "export DASK_DISTRIBUTED__WORKER__MEMORY__PAUSE=False",
    "export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1",
)


def require_slurm() -> Any:
    """The class of dask-jobqueue for Slurm, if jobs can be submitted from here.

    Raises:
        MissingExtraError: If dask-jobqueue is not installed.
        UsageError: If there is no Slurm.
    """
    try:
        from dask_jobqueue import SLURMCluster
    except ImportError as error:
        raise MissingExtraError("dask-jobqueue", "slurm", "The engine slurm") from error
    if shutil.which("sbatch") is None:
        raise UsageError(
            "There is no Slurm here: no sbatch on the PATH. Run this on a login node of the "
            "cluster, or with --engine local."
        )
    return SLURMCluster


def start_slurm(workers: int, settings: ClusterSettings, security: Any) -> Any:
    """Submit jobs that become workers, and keep as many of them in the queue.

    Args:
        workers: How many jobs.
        settings: Of the cluster.
        security: Certificates, or None to make some for this run.

    Raises:
        MissingExtraError: If dask-jobqueue is not installed.
        UsageError: If there is no Slurm, or it refuses such jobs.
        StorageError: If the folder of logs cannot be written.
    """
    kind = require_slurm()
    slurm = settings.slurm
    logs = slurm.logs.absolute()
    try:
        logs.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise storage_error("make the folder", logs, error) from error
    if security is None and slurm.secure:
        security = _own_security()
    memory_gb = settings.memory_gb or _MEMORY_GB
    cluster = kind(
        cores=1,
        processes=1,
        memory=f"{int(memory_gb * 1e9)} B",
        queue=slurm.partition,
        account=slurm.account,
        walltime=_walltime(slurm.walltime_h),
        interface=slurm.interface,
        local_directory=str(slurm.scratch) if slurm.scratch else None,
        log_directory=str(logs),
        shared_temp_directory=str(logs),
        job_name="panokit",
        python=sys.executable,
        job_extra_directives=list(slurm.directives),
        job_script_prologue=[*_ENVIRONMENT, *slurm.prologue],
        worker_extra_args=_worker_arguments(settings),
        scheduler_options={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
        security=security,
        protocol="tls://" if security else "tcp://",
        silence_logs="critical",
    )
    try:
        _check_job(cluster.job_script())
        # Not `scale`, which does not replace a job that was cancelled or failed.
        cluster.adapt(minimum_jobs=workers, maximum_jobs=workers)
    except BaseException:
        cluster.close()
        raise
    return cluster


def _worker_arguments(settings: ClusterSettings) -> list[str]:
    leave_s = max(settings.slurm.walltime_h * 3600 - _LEAVE_S, 60)
    arguments = ["--no-dashboard", "--lifetime", f"{leave_s:.0f}s"]
    arguments += ["--lifetime-stagger", f"{_STAGGER_S}s"]
    if settings.worker_resources:
        offers = " ".join(f"{name}={n:g}" for name, n in settings.worker_resources.items())
        arguments += ["--resources", f'"{offers}"']
    return arguments


def _walltime(hours: float) -> str:
    minutes = round(timedelta(hours=hours).total_seconds() / 60)
    return f"{minutes // 60:02d}:{minutes % 60:02d}:00"


def _own_security() -> Any:
    """Certificates for this run alone: without, any user of the cluster could use the workers."""
    try:
        return Security.temporary()
    except ImportError as error:
        raise MissingExtraError(
            "cryptography", "slurm", "Encrypting what goes between jobs (cluster.slurm.secure)"
        ) from error


def _check_job(script: str) -> None:
    """Ask Slurm whether it would take such a job.

    Raises:
        UsageError: If not.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "job.sh")
        path.write_text(script)
        answer = subprocess.run(
            ["sbatch", "--test-only", str(path)], capture_output=True, text=True, check=False
        )
    if answer.returncode:
        said = " ".join(answer.stderr.split()) or f"exit code {answer.returncode}"
        raise UsageError(
            f"Slurm refuses such jobs: {said}. Change cluster.slurm (partition, account, "
            "walltime_h, directives) or memory_gb."
        )
