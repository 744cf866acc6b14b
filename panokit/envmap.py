"""Linear radiance over the whole sphere: what a light probe is."""

from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.equirectangular import check_equirectangular, read_only
from panokit.errors import ImageError
from panokit.frames import Frame
from panokit.provenance import Provenance


class Anchor(StrEnum):
    """What a radiance of 1.0 stands for.

    RELATIVE is any scale; LDR_WHITE is the level at which the camera's picture clipped;
    LUMINANCE is cd/m2; RADIANCE is W/(sr m2).
    """

    RELATIVE = "relative"
    LDR_WHITE = "ldr-white"
    LUMINANCE = "cd/m2"
    RADIANCE = "W/(sr m2)"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EnvironmentMap:
    """HDR equirectangular radiance with what is known of it.

    Row 0 is the zenith, the center column looks along -Z of `frame`, azimuth grows to the
    right. Never clipped and never silently rescaled.

    Attributes:
        radiance: (H, W, 3) float32, linear Rec.709 with white D65, finite, >= 0, W == 2 H,
            read-only.
        frame: Which way the center column and the rows look.
        anchor: What 1.0 stands for.
        capture: Where the picture behind it is from, or None for a map that never was one.
        provenance: The steps that made it.
    """

    radiance: NDArray[np.float32]
    frame: Frame = Frame.LEVEL
    anchor: Anchor = Anchor.RELATIVE
    capture: Capture | None = None
    provenance: Provenance = field(default_factory=Provenance)

    def __post_init__(self) -> None:
        radiance = read_only(self.radiance)
        if radiance.dtype != np.float32:
            raise ImageError(
                f"Radiance is float32, not {radiance.dtype}. Decode display values with "
                "panokit.color.srgb_decode, or convert half floats with astype.",
                reason="wrong-dtype",
            )
        check_equirectangular(radiance)
        _check_physical(radiance)
        object.__setattr__(self, "radiance", radiance)

    @property
    def width_px(self) -> int:
        """Twice the height."""
        return int(self.radiance.shape[1])

    @property
    def height_px(self) -> int:
        """Half the width."""
        return int(self.radiance.shape[0])

    def with_changes(self, **changes: Any) -> "EnvironmentMap":
        """The same map with some fields replaced."""
        return replace(self, **changes)


def count_unphysical(radiance: NDArray[Any]) -> tuple[dict[str, int], str]:
    """How many values are NaN, infinite and negative, as figures and in words."""
    counts = {
        "nan": int(np.isnan(radiance).sum()),
        "inf": int(np.isinf(radiance).sum()),
        "negative": int((radiance < 0).sum()),
    }
    return counts, ", ".join(f"{count} {name}" for name, count in counts.items() if count)


def _check_physical(radiance: NDArray[np.float32]) -> None:
    # min and max see NaN and infinities too, in two passes without a full-size mask.
    low, high = float(radiance.min()), float(radiance.max())
    if np.isfinite(low) and np.isfinite(high) and low >= 0:
        return
    counts, found = count_unphysical(radiance)
    raise ImageError(
        f"Radiance must be finite and not negative; this map has {found} values. "
        "Repair it where it was made, or read it with repair=True to clean it knowingly.",
        reason="not-physical",
        values=counts,
    )
