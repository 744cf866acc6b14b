"""What was read, in words."""

import numpy as np

from panokit.frames import azimuth_elevation_from_direction
from panokit.lighting.session import SessionResult
from panokit.sphere import find_lights


def estimate_facts(result: SessionResult) -> list[tuple[str, str]]:
    """Labels and texts: how sure an estimate is, and what its main light is."""
    estimate = result.estimate
    rows = []
    confidence = estimate.confidence
    if confidence is not None:
        rows.append(("Radiance", f"off by a factor of {1 / confidence.value:.1f}"))
        rows.append(("Direction of the light", f"off by about {confidence.direction_deg:.0f}°"))
        measured = "measured on data" if confidence.calibrated else "the model's own doubt"
        rows.append(("These figures are", measured))
    primary = find_lights(np.asarray(estimate.envmap.radiance)).primary
    if primary is None:
        rows.append(("Main light", "none that casts shadows"))
    else:
        azimuth, elevation = azimuth_elevation_from_direction(primary.direction)
        rows.append(("Main light", f"{side_of(float(np.degrees(azimuth)))}, "
                     f"{np.degrees(elevation):.0f}° up"))  # fmt: skip
    rows.append(("Objects read", str(len(result.found))))
    rows.append(("Model", estimate.model))
    return rows


def side_of(azimuth_deg: float) -> str:
    """Where an azimuth is, seen from the camera, 0 ahead and 90 to the right."""
    away = abs(azimuth_deg)
    hand = "right" if azimuth_deg > 0 else "left"
    if away < 10:
        return "ahead"
    if away > 170:
        return "behind the camera"
    if away <= 100:
        return f"{away:.0f}° to the {hand}"
    return f"behind, {180 - away:.0f}° from straight behind, on the {hand}"
