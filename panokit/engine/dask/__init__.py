"""The engine on Dask: processes on this machine, Slurm jobs, or the workers of a scheduler.

The only part of panokit that imports distributed and dask-jobqueue; nothing else imports it but
`panokit.engine.make`, when it is asked for.

engine    `DaskEngine`
flights   one run: what is under way, and what becomes of what is lost
clusters  starting workers or finding them, with errors that say what to do
work      what runs in a worker
turns     turns shared by all workers
"""

from panokit.engine.dask.engine import DaskEngine

__all__ = ["DaskEngine"]
