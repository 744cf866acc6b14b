"""How a dataset is produced: the settings that decide no sample."""

from pydantic import Field

from panokit.engine.settings import ClusterSettings, EngineName
from panokit.settings import Settings


class ProductionSettings(Settings):
    """How many samples there are, how many a shard holds, and how they are made."""

    count: int | None = Field(default=None, ge=1)
    """How many samples; may grow from run to run."""

    shard_samples: int | None = Field(default=None, ge=1)
    """How many of them a shard holds; 16 to 250 by the count if not given."""

    workers: int | None = Field(default=None, ge=0)
    """Processes; one for each core if not given, none but this one if 0."""

    engine: EngineName = "local"
    """Where they run: local, serial, dask, slurm, or the tcp:// or tls:// address of a Dask
    scheduler."""

    cluster: ClusterSettings = ClusterSettings()
    """What Dask and Slurm need to know."""

    timeout_s: float = Field(default=300.0, gt=0)
    """A worker that takes longer over one attempt is replaced."""

    retry_missing: bool = False
    """Try samples again that could not be made in an earlier run."""
