"""What `panokit train` is told beside the recipe; no torch is needed to read it."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from pydantic import Field

from panokit.settings import Settings


class ExpansionTraining(Settings):
    """What recipes of expansion are trained with."""

    probes: Path | None = None
    """Of expansion: a folder of HDR probes with its manifest.csv."""

    folds: Annotated[bool, Parameter(negative=())] = False
    """Of expansion: instead of releasing a model, train one for each fold of the probes that has
    not seen it, in WORK/ID/fold-N, to be judged by: panokit evaluate expansion --model
    'WORK/ID/fold-{fold}'"""

    fold_members: int | None = Field(default=None, ge=1)
    """Of expansion: networks of either kind in each fold, if fewer than the recipe's will do."""

    own_right: str = ""
    """Of expansion: what gives you the right to train with probes whose license does not, in
    words."""


class LightingTraining(Settings):
    """What recipes of lighting are trained with."""

    data: Path | None = None
    """Of lighting: a stereo dataset."""

    size: str = ""
    """Of lighting: pocket, two-core or full, or a TOML file; the recipe as it is if not given."""

    seed: int | None = Field(default=None, ge=0)
    """Of lighting: train the recipe once, with this seed, and not with all of the size's."""

    out: Path | None = None
    """Of lighting: gets a folder for each model; WORK/models if not given."""
