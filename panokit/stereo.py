"""Two views of an object: all that a method which reads light may look at."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError
from panokit.frames import Rotation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Views:
    """What a predictor may look at: two parallel cameras side by side, equal but for their place.

    Attributes:
        left: (H, W, 3) uint8, display-encoded: the object on its background.
        right: The other view.
        left_object: (H, W, 3) uint8, the object on black.
        right_object: The other view.
        mask: (H, W) bool, the object in the left view.
        background: (H, W, 3) uint8, what is behind the object in the left view.
        normals: (H, W, 3) float32 in the left camera's frame, 0 where they are not known. True
            normals: only methods that are said to know them may use them.
        parts: (H, W) uint8, the number of the material from 1 on the object, 0 beside it; 1 all
            over the object where materials are not known.
        fov_deg: From the left to the right edge.
        baseline_m: Between the cameras.
        left_level: Turns directions of the left camera's frame into a level frame that looks the
            same way; what a phone's sense of gravity tells.

    Raises:
        ImageError: If the pictures are not of one size, or not what they should be.
    """

    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    left_object: NDArray[np.uint8]
    right_object: NDArray[np.uint8]
    mask: NDArray[np.bool_]
    background: NDArray[np.uint8]
    normals: NDArray[np.float32]
    parts: NDArray[np.uint8]
    fov_deg: float
    baseline_m: float
    left_level: Rotation

    def __post_init__(self) -> None:
        size = self.mask.shape
        if len(size) != 2 or 0 in size:
            raise ImageError(f"A mask is (H, W) with pixels, not {size}.", reason="wrong-shape")
        for name in ("left", "right", "left_object", "right_object", "background", "normals"):
            picture = getattr(self, name)
            kind = np.float32 if name == "normals" else np.uint8
            if picture.shape != (*size, 3) or picture.dtype != kind:
                raise ImageError(
                    f"Views of {size[1]}x{size[0]} have a {name} of {(*size, 3)} "
                    f"{np.dtype(kind).name}, not {picture.shape} {picture.dtype}. Make all "
                    "pictures of one size, display-encoded RGB.",
                    reason="wrong-shape",
                )

        if self.parts.shape != size or self.parts.dtype != np.uint8:
            raise ImageError(
                f"The parts of an object are {size} uint8, not {self.parts.shape} "
                f"{self.parts.dtype}. Without any, give the mask as numbers.",
                reason="wrong-shape",
            )

    @property
    def focal_px(self) -> float:
        """The focal length in pixels."""
        return float(self.mask.shape[1] / 2 / np.tan(np.deg2rad(self.fov_deg) / 2))
