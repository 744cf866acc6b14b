"""Which engine runs, and what it needs to know of a cluster."""

from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

from pydantic import AfterValidator, Field, model_validator

from panokit.errors import UsageError
from panokit.settings import Settings

NAMES = ("serial", "local", "dask", "slurm")
# How many workers there are where nobody says: jobs of a queue cost others, so one.
SLURM_JOBS = 1
SCHEMES = ("tcp", "tls")


def check_engine_name(name: str) -> str:
    """The name, if there is such an engine.

    Raises:
        UsageError: If there is none.
    """
    if name in NAMES:
        return name
    try:
        parts = urlsplit(name)
        is_address = parts.scheme in SCHEMES and parts.hostname and parts.port
    except ValueError:  # a port that is none
        is_address = False
    if not is_address:
        raise UsageError(
            f"There is no engine {name!r}; choose {', '.join(NAMES)}, or the address of a Dask "
            "scheduler such as tcp://HOST:8786 or tls://HOST:8786."
        )
    return name


EngineName = Annotated[str, AfterValidator(check_engine_name)]


class SlurmSettings(Settings):
    """What the jobs of the engine `slurm` ask for; one worker each."""

    partition: str | None = None
    """Where jobs are queued; the cluster's default if not given."""

    account: str | None = None
    """Who pays."""

    walltime_h: float = Field(default=4.0, gt=0.1)
    """Hours a job may take; workers leave ten minutes before, and others take their place."""

    interface: str | None = None
    """The network that workers find the driver on, such as ib0; the host's name decides if not
    given."""

    directives: tuple[str, ...] = ()
    """More options of sbatch: ("--gres=gpu:1", "--constraint=avx2")."""

    prologue: tuple[str, ...] = ()
    """Lines of shell before the worker starts: ("module load cuda",)."""

    scratch: Path | None = None
    """A folder on each node for what workers need for a while."""

    logs: Path = Path("slurm-logs")
    """What jobs print."""

    secure: bool = True
    """Encrypt, and let nobody else on the cluster give work to the workers."""


class ClusterSettings(Settings):
    """What the engines `dask`, `slurm`, tcp:// and tls:// need to know."""

    memory_gb: float | None = Field(default=None, gt=0)
    """Memory of a worker; one that needs more is replaced. An even share of the machine if not
    given, 4 for Slurm."""

    in_flight: int = Field(default=2, ge=1, le=64)
    """Items that are sent for each worker; with 2, the next is there when one is done."""

    connect_timeout_s: float = Field(default=30.0, gt=0)
    """How long to wait for a scheduler and its first worker."""

    resources: dict[str, dict[str, float]] = Field(default_factory=dict)
    """Stage -> what a worker must offer for it: {"expand": {"GPU": 1}}."""

    worker_resources: dict[str, float] = Field(default_factory=dict)
    """What each worker offers that panokit starts: {"GPU": 1}."""

    tls_ca: Path | None = None
    """The certificate that signed all others, PEM; for tls://."""

    tls_certificate: Path | None = None
    """Our certificate, PEM."""

    tls_key: Path | None = None
    """Our private key, PEM."""

    slurm: SlurmSettings = SlurmSettings()
    """What Slurm jobs ask for."""

    @model_validator(mode="after")
    def _check_tls(self) -> "ClusterSettings":
        files = (self.tls_ca, self.tls_certificate, self.tls_key)
        if any(files) and not all(files):
            raise ValueError("tls_ca, tls_certificate and tls_key belong together: give all three")
        return self
