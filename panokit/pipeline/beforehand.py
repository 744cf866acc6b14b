"""What can be found out before a run begins, rather than after a night of work."""

import errno
import os
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path

from panokit.engine.reach import knock
from panokit.errors import MissingExtraError, StorageError, UsageError
from panokit.io.files import storage_error
from panokit.pipeline.fetching import recorded_captures
from panokit.pipeline.references import references_folder
from panokit.pipeline.settings import MODEL_STAGES, PipelineSettings
from panokit.records import RunFolder

# stage -> package, extra, what for
_NEEDS: Mapping[str, tuple[str, str, str]] = {
    "train": ("torch", "train", "The stage train of this pipeline"),
    "references": ("mitsuba", "render", "Rendering maps of true range"),
    "dataset": ("mitsuba", "render", "The stage dataset of this pipeline"),
}


def check_beforehand(settings: PipelineSettings, stages: Sequence[str]) -> None:
    """Find out whether the later stages of a run can work here.

    Args:
        settings: Of the pipeline.
        stages: Those that are to run.

    Raises:
        MissingExtraError: If a package is not installed.
        UsageError: If there is no folder of references that the pipeline names, or no Slurm.
        NetworkError: If there is no scheduler.
        StorageError: If the library's folder cannot be written.
    """
    if set(stages) & set(MODEL_STAGES):
        _check_extras(settings, stages)
    if "qa" in stages and settings.reference is not None and not settings.reference.is_dir():
        raise UsageError(
            f"There is no folder {settings.reference} of maps to compare with. Check `reference`, "
            "or leave it out."
        )
    named = settings.references.folder
    if "references" in stages and named is not None and not named.is_dir():
        raise UsageError(f"There is no folder {named} of reference maps. Check references.folder.")
    if recorded_captures(RunFolder(settings.folder())) is None:
        # Once all is fetched, the engine itself tells it at once.
        _check_engine(settings)
    if "probes" in stages:
        _check_writable(settings.folder() / settings.library)
    if settings.publish and tuple(stages) == settings.stages():
        from panokit.io.remote import open_remote  # fsspec

        open_remote(settings.publish)


def _check_engine(settings: PipelineSettings) -> None:
    if settings.engine == "slurm":
        from panokit.engine.dask.slurm import require_slurm  # half a second of imports

        require_slurm()
    elif settings.engine.startswith(("tcp://", "tls://")):
        knock(settings.engine, settings.cluster.connect_timeout_s)


def nearest_there(path: Path) -> Path:
    """A path itself, or the nearest folder above it that is there."""
    there = path.absolute()
    while not there.exists():
        there = there.parent
    return there


def _check_extras(settings: PipelineSettings, stages: Sequence[str]) -> None:
    own = references_folder(settings.references) is None and settings.references.rendered > 0
    renders = settings.dataset is not None and settings.dataset.settings.renderer == "mitsuba"
    for stage, is_needed in (("train", True), ("references", own), ("dataset", renders)):
        package, extra, purpose = _NEEDS[stage]
        if stage in stages and is_needed and find_spec(package) is None:
            raise MissingExtraError(package, extra, purpose)


def _check_writable(library: Path) -> None:
    there = nearest_there(library)
    if not there.is_dir():
        raise StorageError(
            f"The library {library} cannot be made: {there} is a file. Give another `library`."
        )
    if not os.access(there, os.W_OK | os.X_OK):
        refused = PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        raise storage_error("write the library into", there, refused)
