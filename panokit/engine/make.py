"""An engine by its name."""

from panokit.engine.local import LocalEngine
from panokit.engine.losses import OnLoss
from panokit.engine.protocol import Engine, Listener, SerialEngine
from panokit.engine.settings import ClusterSettings, check_engine_name


def make_engine(
    name: str,
    workers: int | None = None,
    cluster: ClusterSettings | None = None,
    *,
    items_per_worker: int | None = None,
    silence_s: float | None = None,
    on_report: Listener | None = None,
    on_loss: OnLoss | None = None,
) -> Engine:
    """The engine with this name. Nothing is started before there is an item to run.

    Args:
        name: "serial", "local", "dask", "slurm", or a scheduler's address (tcp://, tls://).
        workers: How many. If not given: one for each core, one job on Slurm, all that a
            scheduler has.
        cluster: For all but "serial" and "local".
        items_per_worker: "local" replaces a worker by a fresh one after so many items; the
            others go by their limit of memory.
        silence_s: A worker that neither ends its item nor reports for so long is replaced.
        on_report: Gets what tasks report.
        on_loss: Decides on the item of a lost worker; a `Quarantine` if not given.

    Raises:
        UsageError: If there is no such engine.
        MissingExtraError: If it needs a package that is not installed.
    """
    check_engine_name(name)
    if name == "serial":
        return SerialEngine(on_report=on_report)
    if name == "local":
        return LocalEngine(
            workers,
            items_per_worker=items_per_worker,
            silence_s=silence_s,
            on_report=on_report,
            on_loss=on_loss,
        )
    from panokit.engine.dask import DaskEngine  # half a second of imports

    return DaskEngine(
        name,
        workers,
        cluster or ClusterSettings(),
        silence_s=silence_s,
        on_report=on_report,
        on_loss=on_loss,
    )
