"""Whether the sun of an estimate is as strong as the true one, in stops."""

import numpy as np

from panokit.color import luminance
from panokit.errors import UsageError
from panokit.metrics.lighting import peak_direction
from panokit.metrics.pairs import Radiance, radiance_pair
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.solid_angle import row_solid_angles


def sun_energy_stops(estimate: Radiance, truth: Radiance, *, radius_deg: float = 5.0) -> float:
    """log2 of the energy near the true peak over the true energy there: an exposure error.

    0 is right, -1 is half the light. The estimate's light counts only where the true sun is:
    a sun in the wrong place is missing here, and shows as an angle in `peak_error_deg`.

    Args:
        estimate: (H, W, 3), linear, on the truth's scale (`panokit.metrics.alignment`).
        truth: (H, W, 3), linear.
        radius_deg: How far from the true peak pixels count, by their centers; 5 degrees hold
            the glare that a camera draws round a sun.

    Returns:
        Stops; -inf if the estimate is black there, NaN if the truth is black.

    Raises:
        UsageError: If the radius is not within 0 to 90 degrees.
    """
    guess, true = radiance_pair(estimate, truth)
    if not 0 < radius_deg <= 90:
        raise UsageError(f"The radius is more than 0 and at most 90 degrees, not {radius_deg}.")
    height, width = true.shape[:2]
    toward = peak_direction(true)
    near = equirect_directions(width, height) @ toward >= np.cos(np.deg2rad(radius_deg))
    weights = near * row_solid_angles(height, width)[:, None]
    true_energy = float((luminance(true) * weights).sum())
    energy = float((luminance(guess) * weights).sum())
    if true_energy <= 0:
        return float("nan")
    return float(np.log2(energy / true_energy)) if energy > 0 else float("-inf")
