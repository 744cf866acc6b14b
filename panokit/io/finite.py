"""Values that no light has: counted and refused, or cleaned where the caller says so."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import count_unphysical
from panokit.errors import ImageError


def check_finite(radiance: NDArray[np.floating[Any]], what: str, why: str = "") -> None:
    """Check that an array holds no NaN and no infinity.

    Args:
        radiance: Of any shape.
        what: The file, for the message.
        why: Where such values come from in a file of this kind, as a sentence.

    Raises:
        ImageError: If it does, with the counts (reason "not-physical").
    """
    if radiance.size == 0:
        return
    low, high = float(radiance.min()), float(radiance.max())  # both see NaN
    if np.isfinite(low) and np.isfinite(high):
        return
    counts, found = count_unphysical(radiance)
    raise ImageError(
        f"{what} has {found} values; radiance is finite. {why}{' ' if why else ''}"
        "Make it again from its source, or read it with repair=True to clean it knowingly.",
        reason="not-physical",
        values=counts,
    )


def repaired(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    """The same picture with NaN as 0 and infinities as the largest and smallest finite value."""
    finite = radiance[np.isfinite(radiance)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    return np.nan_to_num(radiance, nan=0.0, posinf=high, neginf=low)
