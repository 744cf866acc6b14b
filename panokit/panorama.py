"""A display-encoded picture of the whole sphere."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture
from panokit.equirectangular import check_equirectangular, read_only
from panokit.errors import ImageError
from panokit.frames import Frame
from panokit.provenance import Provenance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Panorama:
    """LDR equirectangular pixels with what is known of them.

    Row 0 is the zenith, the center column looks along -Z of `frame`, azimuth grows to the
    right, and the picture wraps from its right edge to its left.

    Attributes:
        pixels: (H, W, 3) uint8 RGB, sRGB-encoded, W == 2 H, read-only.
        capture: Where it is from; its license goes wherever the pixels go.
        frame: Which way the center column and the rows look.
        valid: (H, W) bool, False where there is nothing behind the pixel; None if all is valid.
        provenance: The steps that made it.
    """

    pixels: NDArray[np.uint8]
    capture: Capture
    frame: Frame = Frame.CAMERA
    valid: NDArray[np.bool_] | None = None
    provenance: Provenance = field(default_factory=Provenance)

    def __post_init__(self) -> None:
        pixels = read_only(self.pixels)
        if pixels.dtype != np.uint8:
            raise ImageError(
                f"A panorama holds uint8 pixels, not {pixels.dtype}. "
                "Linear or HDR data belongs in an EnvironmentMap.",
                reason="wrong-dtype",
            )
        check_equirectangular(pixels)
        object.__setattr__(self, "pixels", pixels)
        if self.valid is not None:
            valid = read_only(self.valid)
            if valid.shape != pixels.shape[:2] or valid.dtype != np.bool_:
                raise ImageError(
                    f"The valid mask is {valid.dtype} {valid.shape}; it must be bool "
                    f"{pixels.shape[:2]}, like the pixels.",
                    reason="wrong-mask",
                )
            object.__setattr__(self, "valid", None if valid.all() else valid)

    @property
    def width_px(self) -> int:
        """Twice the height."""
        return int(self.pixels.shape[1])

    @property
    def height_px(self) -> int:
        """Half the width."""
        return int(self.pixels.shape[0])

    def with_changes(self, **changes: Any) -> "Panorama":
        """The same panorama with some fields replaced."""
        return replace(self, **changes)
