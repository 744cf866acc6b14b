"""Settings of `panokit evaluate`."""

from typing import Literal

from pydantic import Field

from panokit.settings import Settings

# Changes when the same prediction gets other figures.
VERSION = "1"

Published = Literal["spheres", "array", "light-direction"]


class LightingEvaluation(Settings):
    """How models that read light are judged."""

    count: int = Field(default=0, ge=0)
    """Judge on the first so many samples of the split; all if 0."""

    controls: int = Field(default=100, ge=0)
    """On how many samples the controls run: the second view spoiled, or the normals."""

    protocol: tuple[Published, ...] = ("spheres", "array", "light-direction")
    """Published protocols to score as well, as published and put right."""

    protocol_count: int = Field(default=50, ge=0)
    """On how many samples; they cost more than all other figures."""

    keep: int = Field(default=24, ge=0)
    """Of how many samples pictures and predictions are kept for the figures."""

    training_maps: int = Field(default=4000, ge=1)
    """How many maps of the training split baselines and the memory test know."""
