"""What a disagreement is worth: curves from how far two readings differ to how wrong one is.

`panokit.evaluate.calibration` measures them on data that a model has not learned from; they are
kept in the table [lighting.confidence] of its model.toml.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ModelError

SIGNAL = "mirror"


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """A line through points that never falls.

    Attributes:
        signal: Rising, at least two.
        error: Never falling, as many.
    """

    signal: tuple[float, ...]
    error: tuple[float, ...]

    def __post_init__(self) -> None:
        rising = np.all(np.diff(self.signal) > 0) and np.all(np.diff(self.error) >= 0)
        if len(self.signal) < 2 or len(self.signal) != len(self.error) or not rising:
            raise ModelError(
                "A calibration curve is two or more points of rising signal whose error never "
                "falls. Measure it anew."
            )

    def __call__(self, signal: NDArray[np.floating]) -> NDArray[np.float64]:
        """The error to expect at a signal; that of the ends beyond them."""
        return np.asarray(np.interp(signal, self.signal, self.error))


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """How wrong a model is, by how much it differs from its mirrored self.

    Attributes:
        count: Samples that it was measured on.
        radiance: From the difference of logs to the error of logs, in one direction.
        direction_deg: From the angle between light vectors to the error of the light vector.
    """

    count: int
    radiance: Curve
    direction_deg: Curve

    def to_toml(self) -> str:
        """The table [lighting.confidence]."""
        lines = ["[lighting.confidence]", f'signal = "{SIGNAL}"', f"count = {self.count}"]
        for name in ("radiance", "direction_deg"):
            curve = getattr(self, name)
            for part in ("signal", "error"):
                values = ", ".join(f"{value:.5g}" for value in getattr(curve, part))
                lines.append(f"{name}_{part} = [{values}]")
        return "\n".join(lines) + "\n"


def calibration_of(spec: Mapping[str, Any]) -> Calibration | None:
    """What the table [lighting] of a model.toml says, or None if it was never measured.

    Raises:
        ModelError: If it is damaged, or of another signal.
    """
    table = spec.get("confidence")
    if table is None:
        return None
    try:
        if table["signal"] != SIGNAL:
            raise ValueError(f"the signal {table['signal']!r} is not known")
        curves = {
            name: Curve(
                signal=_numbers(table[f"{name}_signal"]), error=_numbers(table[f"{name}_error"])
            )
            for name in ("radiance", "direction_deg")
        }
        return Calibration(count=int(table["count"]), **curves)
    except (KeyError, TypeError, ValueError) as error:
        raise ModelError(
            f"The table [lighting.confidence] of a model.toml is damaged ({error!r}). Measure it "
            "anew, or take it out."
        ) from error


def _numbers(values: Sequence[Any]) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
