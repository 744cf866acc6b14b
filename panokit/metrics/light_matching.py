"""Light by light: which lights were found, how well, and which were missed or made up.

In the spirit of Gardner et al. 2017 and 2019 ("Learning to predict indoor illumination from a
single image"; "Deep parametric indoor lighting estimation"), who compare parametric lights.
Their code is not public, so this protocol is panokit's own, "panokit-lights-1": the lights of
`panokit.metrics.light_blobs` in both maps, matched one to one so that the sum of angles is least
(Kuhn 1955, the Hungarian method), where pairs wider than the gate are no pairs.
"""

from dataclasses import asdict, dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from panokit.errors import UsageError
from panokit.frames import angle_between
from panokit.metrics.light_blobs import LightBlob, find_light_blobs
from panokit.metrics.pairs import Radiance, radiance_pair

MOST_LIGHTS = 5
GATE_DEG = 45.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LightErrors:
    """How the lights of an estimate differ from the true ones; means are over pairs.

    Attributes:
        matched: How many pairs there are.
        missed: True lights without a partner.
        spurious: Lights of the estimate without a partner.
        angle_deg: Mean angle between partners; NaN without pairs, as all means.
        size_stops: Mean absolute log2 of the ratio of their solid angles.
        intensity_stops: Mean absolute log2 of the ratio of their luminance energies.
        color_deg: Mean RGB angle between their colors.
    """

    matched: int
    missed: int
    spurious: int
    angle_deg: float
    size_stops: float
    intensity_stops: float
    color_deg: float

    def to_json(self) -> dict[str, float | None]:
        """A dictionary for `json.dump`; what is not a number becomes None."""
        return {name: value if np.isfinite(value) else None for name, value in asdict(self).items()}


def light_errors(
    estimate: Radiance, truth: Radiance, *, most: int = MOST_LIGHTS, gate_deg: float = GATE_DEG
) -> LightErrors:
    """Match the strongest lights of two maps and compare each pair.

    Args:
        estimate: (H, W, 3), linear, on the truth's scale.
        truth: (H, W, 3), linear, in the same frame.
        most: How many lights of each map take part.
        gate_deg: Lights further apart are not the same light.

    Raises:
        UsageError: If the shapes differ, or a limit is not above zero.
    """
    radiance_pair(estimate, truth)
    if most < 1 or not 0 < gate_deg <= 180:
        raise UsageError(
            f"At least one light and a gate of 0 to 180 degrees are needed, not {most} and "
            f"{gate_deg}."
        )
    guess, true = find_light_blobs(estimate)[:most], find_light_blobs(truth)[:most]
    pairs = match_lights(guess, true, gate_deg=gate_deg)

    def mean(values: list[float]) -> float:
        return float(np.mean(values)) if values else float("nan")

    return LightErrors(
        matched=len(pairs),
        missed=len(true) - len(pairs),
        spurious=len(guess) - len(pairs),
        angle_deg=mean([_angle_deg(a.direction, b.direction) for a, b in pairs]),
        size_stops=mean([abs(np.log2(a.solid_angle_sr / b.solid_angle_sr)) for a, b in pairs]),
        intensity_stops=mean([abs(np.log2(a.strength / b.strength)) for a, b in pairs]),
        color_deg=mean([_angle_deg(a.energy, b.energy) for a, b in pairs]),
    )


def match_lights(
    guess: tuple[LightBlob, ...], true: tuple[LightBlob, ...], *, gate_deg: float = GATE_DEG
) -> list[tuple[LightBlob, LightBlob]]:
    """Pairs of lights that are the same one, each light in at most one pair."""
    if not guess or not true:
        return []
    angles = np.array([[_angle_deg(a.direction, b.direction) for b in true] for a in guess])
    # A pair beyond the gate costs as much as none, so it cannot push good pairs apart.
    rows, columns = linear_sum_assignment(np.minimum(angles, gate_deg))
    return [
        (guess[row], true[column])
        for row, column in zip(rows, columns, strict=True)
        if angles[row, column] < gate_deg
    ]


def _angle_deg(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.degrees(angle_between(a, b)))
