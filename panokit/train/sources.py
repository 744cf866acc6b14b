"""Where training pictures come from: probes, probes with a ceiling, light that was computed."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from panokit.io import read_environment_map
from panokit.sphere import resize_radiance
from panokit.train.probes import (
    PROBE_WIDTH_PX,
    TrainingProbe,
    check_rights,
    read_lower_bounds,
)
from panokit.train.recipe import DataRecipe
from panokit.train.synthetic_light import synthetic_sources

Kind = Literal["probe", "bound", "synthetic"]
# Of a source that shows no probe's place: every fold may learn from it.
NOWHERE = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """One map to take pictures of.

    Attributes:
        map: The map.
        kind: What it is; of a "bound" the brightest light is a lower bound.
        place: The index of the probe whose place it shows, or `NOWHERE`.
    """

    map: TrainingProbe
    kind: Kind
    place: int

    def radiance(self) -> NDArray[np.float32]:
        """The map, (512, 1024, 3) float32; one with a ceiling may need repair and gets it."""
        if self.kind != "bound":
            return self.map.radiance()
        repaired = read_environment_map(self.map.path, repair=True).radiance
        return np.ascontiguousarray(resize_radiance(repaired, PROBE_WIDTH_PX))


def probe_sources(probes: Sequence[TrainingProbe]) -> list[Source]:
    """The probes themselves, each at its own place."""
    return [Source(map=probe, kind="probe", place=i) for i, probe in enumerate(probes)]


def other_sources(
    probes: Sequence[TrainingProbe],
    recipe: DataRecipe,
    folder: Path,
    work: Path,
    *,
    own_right: str = "",
) -> list[Source]:
    """What a recipe asks for beside the probes.

    Args:
        probes: To judge on; another map of one of their places is bound to it.
        recipe: What to add.
        folder: Of the probes, with a manifest.csv.
        work: Where computed maps are kept.
        own_right: See `check_rights`.

    Raises:
        LicenseError: If the license of a map does not permit training.
        MissingExtraError: If Mitsuba is needed and not installed.
    """
    place_of = {probe.group: index for index, probe in reversed(list(enumerate(probes)))}
    bounds = read_lower_bounds(folder) if recipe.lower_bounds else []
    check_rights(bounds, own_right)
    found = [
        Source(map=probe, kind="bound", place=place_of.get(probe.group, NOWHERE))
        for probe in bounds
    ]
    if recipe.synthetic is not None:
        found += [
            Source(map=each, kind="synthetic", place=NOWHERE if place is None else place)
            for each, place in synthetic_sources(recipe.synthetic, probes, work)
        ]
    return found
