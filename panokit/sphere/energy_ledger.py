"""The energy ledger: what a step did to the light of a map, as figures to record and to judge."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.sphere.irradiance import energy

# What every resample and rotation keeps; a step that means to change the light says so.
TOLERANCE = 1e-4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EnergyLedger:
    """The sum of radiance x solid angle before and after a step.

    Attributes:
        before: (C,) float64, radiance times steradian.
        after: (C,) float64.
    """

    before: NDArray[np.float64]
    after: NDArray[np.float64]

    @property
    def change(self) -> NDArray[np.float64]:
        """(C,) relative change: 0 is kept, 0.5 is half as much again, inf is light from nothing."""
        dark = self.before <= 0
        ratio = np.divide(self.after, self.before, out=np.ones_like(self.after), where=~dark)
        ratio[dark & (self.after > 0)] = np.inf
        return np.asarray(ratio - 1)

    def kept(self, tolerance: float = TOLERANCE) -> bool:
        """Whether no channel's energy changed by more than `tolerance`, relative."""
        return bool((np.abs(self.change) <= tolerance).all())


def energy_ledger(
    before: NDArray[np.floating[Any]], after: NDArray[np.floating[Any]]
) -> EnergyLedger:
    """The ledger of one step from radiance (H, W, C) to radiance (h, w, C), equirectangular.

    Raises:
        UsageError: If the channels differ.
    """
    if before.shape[2:] != after.shape[2:]:
        raise UsageError(f"Channels differ: {before.shape} before, {after.shape} after.")
    return EnergyLedger(before=energy(before), after=energy(after))
