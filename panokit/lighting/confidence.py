"""How far off an estimate is likely to be, direction by direction and as a whole.

The signal is how much a network disagrees with its mirrored self, see
`panokit.reflectance.mirroring`. What it is worth is measured on data that the network has not
learned from and kept with the model; for a model without that the disagreement itself is taken
for the error, which is too little: both answers may be wrong alike.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.equirectangular import read_only
from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.reflectance.calibration import Calibration
from panokit.reflectance.mirroring import Map, direction_difference_deg, log_difference
from panokit.sphere import rotate_pixels
from panokit.sphere.solid_angle import row_solid_angles


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Confidence:
    """How sure an estimate is.

    Attributes:
        error: (64, 64) float32, in each direction the |log| of the factor by which radiance is
            likely to be off, at least 0; read-only. 0.7 is a factor of two.
        direction_deg: By how much the direction of the light as a whole is likely to be off.
        calibrated: Whether that was measured on data, or is the bare disagreement.
    """

    error: NDArray[np.float32]
    direction_deg: float
    calibrated: bool

    def __post_init__(self) -> None:
        error = read_only(np.asarray(self.error, np.float32))
        if error.ndim != 2 or not np.isfinite(error).all() or error.min() < 0:
            raise UsageError("The errors of a confidence are (H, W), finite and at least 0.")
        object.__setattr__(self, "error", error)

    @property
    def map(self) -> NDArray[np.float32]:
        """(64, 64) float32 in (0, 1]: 1 is sure, 0.5 a factor of two off, 0.1 a factor of ten."""
        return np.asarray(np.exp(-self.error), np.float32)

    @property
    def value(self) -> float:
        """The same for the estimate as a whole: from the mean error over the sphere."""
        height, width = self.error.shape
        mean = self.error.mean(axis=1) @ row_solid_angles(height, width) * width / (4 * np.pi)
        return float(np.exp(-mean))

    def turned_error(self, turn: Rotation) -> NDArray[np.float32]:
        """The errors as a lat-long map (64, 128) in another frame, which `turn` leads to."""
        wide = np.repeat(self.error, 2, axis=1)
        return np.asarray(rotate_pixels(wide, turn), np.float32).reshape(wide.shape)

    def to_json(self) -> dict[str, Any]:
        """The figures without the map, for `json.dump`."""
        return {
            "value": round(self.value, 4),
            "off_by_factor": round(1 / self.value, 3),
            "direction_deg": round(self.direction_deg, 2),
            "calibrated": self.calibrated,
        }


def confidence_of(plain: Map, mirrored: Map, calibration: Calibration | None) -> Confidence:
    """The confidence of a reading.

    Args:
        plain: (64, 64, 3), what was read.
        mirrored: (64, 64, 3), what was read of the mirror image, mirrored back.
        calibration: Of the model, or None.
    """
    signal = log_difference(plain, mirrored)
    angle = direction_difference_deg(plain, mirrored)
    if calibration is None:
        return Confidence(error=signal, direction_deg=angle, calibrated=False)
    return Confidence(
        error=calibration.radiance(signal).astype(np.float32),
        direction_deg=float(calibration.direction_deg(np.array(angle))),
        calibrated=True,
    )
