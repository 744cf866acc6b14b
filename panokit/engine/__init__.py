"""Run one task over many items: in this process, in several, or on a cluster.

An engine takes a picklable task and items, keeps a bounded number of them in flight, and
hands back each outcome as it comes. Tasks write files and return receipts, never arrays, and
must be safe to run twice. What a task raises ends the run; a bad item is an outcome, and so is
one that ends its worker every time.

settings  the names of engines, and what a cluster is asked for
protocol  `Engine`, `SerialEngine`, `attempt`, `report`
local     `LocalEngine`: processes on this machine that are replaced when they die or hang
worker    what runs in such a process
losses    `Loss`, `Quarantine`: what becomes of an item whose worker was lost
reach     whether a scheduler can be reached
turns     waiting for one's turn among all workers, as to ask a host
dask      `DaskEngine`: Dask processes here, Slurm jobs, or the workers of a scheduler
make      `make_engine`: an engine by its name
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    # Named twice, because type checkers cannot see into `lazy_names`.
    from panokit.engine.local import LocalEngine as LocalEngine
    from panokit.engine.losses import Loss as Loss
    from panokit.engine.losses import OnLoss as OnLoss
    from panokit.engine.losses import Quarantine as Quarantine
    from panokit.engine.make import make_engine as make_engine
    from panokit.engine.protocol import Engine as Engine
    from panokit.engine.protocol import Listener as Listener
    from panokit.engine.protocol import Outcome as Outcome
    from panokit.engine.protocol import SerialEngine as SerialEngine
    from panokit.engine.protocol import attempt as attempt
    from panokit.engine.protocol import available_cores as available_cores
    from panokit.engine.protocol import report as report
    from panokit.engine.protocol import reports_to as reports_to
    from panokit.engine.settings import ClusterSettings as ClusterSettings
    from panokit.engine.settings import EngineName as EngineName
    from panokit.engine.settings import SlurmSettings as SlurmSettings
    from panokit.engine.turns import wait_for_turn as wait_for_turn

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "ClusterSettings": "panokit.engine.settings",
        "Engine": "panokit.engine.protocol",
        "EngineName": "panokit.engine.settings",
        "Listener": "panokit.engine.protocol",
        "LocalEngine": "panokit.engine.local",
        "Loss": "panokit.engine.losses",
        "OnLoss": "panokit.engine.losses",
        "Outcome": "panokit.engine.protocol",
        "Quarantine": "panokit.engine.losses",
        "SerialEngine": "panokit.engine.protocol",
        "SlurmSettings": "panokit.engine.settings",
        "attempt": "panokit.engine.protocol",
        "available_cores": "panokit.engine.protocol",
        "make_engine": "panokit.engine.make",
        "report": "panokit.engine.protocol",
        "reports_to": "panokit.engine.protocol",
        "wait_for_turn": "panokit.engine.turns",
    },
)
