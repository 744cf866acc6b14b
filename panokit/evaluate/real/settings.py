"""Settings of pairs of real photographs; imports nothing heavy."""

from typing import Literal

from pydantic import Field, model_validator

from panokit.settings import Settings

Kind = Literal["stanford-orb", "objects-with-lighting"]


class PairSettings(Settings):
    """Which photographs make a pair, and what becomes of it."""

    width_px: int = Field(default=128, ge=16)
    """Width and height of each picture."""

    rotation_deg: float = Field(default=25.0, gt=0, lt=90)
    """The most that one camera may be turned against the other."""

    off_axis_deg: float = Field(default=30.0, gt=0, lt=90)
    """The most that the line between the cameras may differ from the left camera's right."""

    baseline_over_depth: tuple[float, float] = (0.03, 0.4)
    """Least and most distance between the cameras, over that to the object."""

    wanted_over_depth: float = Field(default=0.1, gt=0)
    """The ratio that is best; each view takes the partner nearest to it."""

    rectify: bool = True
    """Whether both pictures are turned into those of parallel cameras. Without, they are cut out
    as they are, and the cameras look inward."""

    fill: float = Field(default=0.7, gt=0, le=0.95)
    """The share of the picture that the object spans."""

    per_scene: int = Field(default=0, ge=0)
    """At most so many pairs of each object and place, the best ones; all if 0."""

    @model_validator(mode="after")
    def _in_order(self) -> "PairSettings":
        low, high = self.baseline_over_depth
        if not 0 < low < high:
            raise ValueError("baseline_over_depth goes from a small to a larger number over 0")
        return self
