"""Settings of `panokit evaluate expansion`."""

from pydantic import Field, model_validator

from panokit.settings import Settings

# Changes when the same pictures and method give other figures.
VERSION = "1"


class ExpansionEvaluation(Settings):
    """How expansion methods are judged."""

    folds: int = Field(default=5, ge=2)
    """How many parts the probes are split into, whole places at a time."""

    fold: int | None = None
    """Judge on the probes of this fold only; all if not given."""

    cameras: tuple[str, ...] = ("A", "B")
    """The test cameras: A is sRGB at a fixed exposure, B an unknown curve, exposure and JPEG."""

    roll_probes: int = Field(default=5, ge=0)
    """How many probes are also judged with the picture rolled, camera A only; it costs six
    more answers of each method for each."""

    limit: int | None = Field(default=None, ge=1)
    """Only the first so many probes, for trying out."""

    timeout_s: float = Field(default=600.0, gt=0)
    """How long a command may take for one picture."""

    @model_validator(mode="after")
    def _check(self) -> "ExpansionEvaluation":
        if self.fold is not None and not 0 <= self.fold < self.folds:
            raise ValueError(f"fold must be from 0 to {self.folds - 1}")
        if not self.cameras or not set(self.cameras) <= {"A", "B"}:
            raise ValueError("cameras must be A, B or both")
        return self
