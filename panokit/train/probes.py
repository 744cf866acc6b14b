"""The HDR probes to train on, and whether they may be trained on; the list is evaluate's."""

from collections.abc import Sequence
from pathlib import Path

from panokit.capture import Capture, require_right_to_train
from panokit.errors import RecordError
from panokit.evaluate.probe_set import PROBE_WIDTH_PX as PROBE_WIDTH_PX
from panokit.evaluate.probe_set import ListedProbe as TrainingProbe
from panokit.evaluate.probe_set import assign_folds as assign_folds
from panokit.evaluate.probe_set import read_probes as read_probes
from panokit.io.files import read_json
from panokit.io.pictures import record_path

# Of the cross-validation. Mixed training pictures, too, never join probes of two folds.
FOLDS = 5
# How the manifest begins to speak of maps whose brightest light is clipped or lossy.
CLIPPED = "robustness"


def read_lower_bounds(folder: Path) -> list[TrainingProbe]:
    """The probes whose brightest light is not to be trusted, by name; there may be none.

    Raises:
        StorageError: If there is no manifest.
        RecordError: If a column is missing.
    """
    try:
        return read_probes(folder, CLIPPED)
    except RecordError as error:
        if error.reason != "no-probes":
            raise
        return []


def check_rights(probes: Sequence[TrainingProbe], own_right: str = "") -> None:
    """Check that the probes may be trained with, by the records beside their maps.

    A map without a record is the user's own affair.

    Args:
        probes: What is to be trained with.
        own_right: See `require_right_to_train`.

    Raises:
        LicenseError: If the license of one does not permit it.
        RecordError: If a record is damaged.
    """
    records = (read_json(path) for path in (record_path(p.path) for p in probes) if path.exists())
    known = [Capture.from_json(r["capture"]) for r in records if r.get("capture")]
    require_right_to_train(known, own_right)
