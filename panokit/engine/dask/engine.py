"""The engine: holds a cluster from the first item of its first run until it is closed."""

import logging
from collections.abc import Callable, Iterable, Iterator
from itertools import chain

from panokit.engine.dask.clusters import Cluster, open_cluster
from panokit.engine.dask.flights import Flights
from panokit.engine.losses import OnLoss, Quarantine
from panokit.engine.protocol import Item, Listener, Outcome
from panokit.engine.settings import ClusterSettings, check_engine_name
from panokit.errors import UsageError


class DaskEngine:
    """Workers that Dask connects: local processes, Slurm jobs, or those of a scheduler.

    Each computes with one thread. Outcomes come back through the scheduler, so they are to be
    small; files are shared through the file system.

    Args:
        name: "dask", "slurm" or a scheduler's address.
        workers: How many to start; of a scheduler's address, how many to use at once. If not
            given: one for each core, one job on Slurm, all that a scheduler has.
        settings: Of the cluster.
        silence_s: A worker that neither ends its item nor reports for so long is killed; it may
            take as long as it likes if not given.
        on_report: Gets what tasks report.
        on_loss: Decides on the item of a lost worker, see `OnLoss`; a `Quarantine` for each run
            if not given.
    """

    def __init__(
        self,
        name: str = "dask",
        workers: int | None = None,
        settings: ClusterSettings | None = None,
        *,
        silence_s: float | None = None,
        on_report: Listener | None = None,
        on_loss: OnLoss | None = None,
    ) -> None:
        check_engine_name(name)
        if workers is not None and workers < 1:
            raise UsageError(f"{workers} workers do nothing. Give at least one.")
        # Dask tells of every worker that comes or goes; what matters of that, panokit says.
        for logger in ("distributed", "distributed.client"):
            logging.getLogger(logger).setLevel(logging.CRITICAL)
        self._name, self._workers = name, workers
        self._settings = settings or ClusterSettings()
        self._silence_s = silence_s
        self._on_report, self._on_loss = on_report, on_loss
        self._cluster: Cluster | None = None

    def run(self, task: Callable[[Item], Outcome], items: Iterable[Item]) -> Iterator[Outcome]:
        """The outcome of each item, as they are done.

        Raises:
            PanokitError: If a task raises it, or if workers are lost for no item's fault.
            NetworkError: If there is no scheduler, or it is lost.
        """
        queue = iter(items)
        first = next(queue, None)
        if first is None:
            return
        if self._cluster is None:
            self._cluster = open_cluster(self._name, self._workers, self._settings)
        flights = Flights(
            self._cluster,
            task,
            chain([first], queue),
            on_report=self._on_report,
            on_loss=self._on_loss or Quarantine(),
            silence_s=self._silence_s,
            settings=self._settings,
        )
        yield from flights.land()

    def close(self) -> None:
        """End the workers that were started, or leave the scheduler."""
        if self._cluster is not None:
            self._cluster.close()
            self._cluster = None
