"""Response curves of cameras: how light, up to the clip level, becomes display-encoded values.

All curves rise from 0 at 0 to 1 at 1. Four families, each with its numbers:

srgb     ()                           the standard's curve
gamma    (g,)                         x^(1 / g)
sigmoid  (n, s)                       (1 + s) x^n / (x^n + s), Eilertsen et al. 2017, section 5
toned    (g, contrast, shoulder)      a gamma, an S about the middle, and highlights pressed
                                      together, as cameras that please draw their pictures

`TONED_BANK` holds curves of the last family of the variety that measured responses show
(Grossberg and Nayar 2003, "What is the Space of Camera Response Functions?"). They were made
for panokit; no measured table is copied.
"""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from panokit.color.transfer import srgb_encode
from panokit.errors import UsageError

Family = Literal["srgb", "gamma", "sigmoid", "toned"]

_COUNTS: dict[str, int] = {"srgb": 0, "gamma": 1, "sigmoid": 2, "toned": 3}
_TABLE = 4096
# A weaker one is none, and its logarithms are too small to divide.
LEAST_SHOULDER = 1e-6


def _rises(family: str, numbers: tuple[float, ...]) -> bool:
    if not np.isfinite(numbers).all():
        return False
    if family == "toned":
        # The S has slopes from 1 - contrast, or 1 + contrast / 2, up.
        return numbers[0] > 0 and -1.9 <= numbers[1] <= 0.9 and numbers[2] >= 0
    return all(number > 0 for number in numbers)


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """One curve.

    Attributes:
        family: See the module.
        numbers: Of the family.

    Raises:
        UsageError: If the numbers are not those of a curve that rises.
    """

    family: Family = "srgb"
    numbers: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if len(self.numbers) != _COUNTS.get(self.family, -1) or not _rises(
            self.family, self.numbers
        ):
            raise UsageError(
                f"There is no response {self.family!r} with the numbers {self.numbers}: the "
                "families are srgb (), gamma (g > 0), sigmoid (n > 0, s > 0) and toned "
                "(g > 0, contrast from -1.9 to 0.9, shoulder >= 0)."
            )


SRGB = Response()

# Gamma, contrast, shoulder: plain, lively, soft, film, flat for grading, night, phone, old.
TONED_BANK: tuple[Response, ...] = tuple(
    Response(family="toned", numbers=numbers)
    for numbers in (
        (2.2, 0.0, 0.0),
        (2.1, 0.5, 0.4),
        (2.3, -0.3, 0.3),
        (1.9, 0.35, 1.5),
        (2.8, -0.6, 0.2),
        (2.6, 0.2, 0.8),
        (2.0, 0.25, 2.5),
        (1.8, 0.1, 0.1),
    )
)


def encode(linear: NDArray[np.floating[Any]], response: Response) -> NDArray[np.float32]:
    """Light in [0, 1] of the clip level to encoded values in [0, 1]; any shape, float32."""
    x = np.asarray(linear, np.float32)
    if response.family == "srgb":
        return srgb_encode(x)
    if response.family == "sigmoid":
        return sigmoid_encode(x, *response.numbers)
    value = np.power(x, np.float32(1 / response.numbers[0]))
    if response.family == "gamma":
        return np.asarray(value, np.float32)
    _, contrast, shoulder = response.numbers
    value = value + np.float32(contrast) * value * (1 - value) * (2 * value - 1)
    if shoulder > LEAST_SHOULDER:
        value = np.log1p(np.float32(shoulder) * value) / np.float32(np.log1p(shoulder))
    return np.asarray(value, np.float32)


def decode(encoded: NDArray[np.floating[Any]], response: Response) -> NDArray[np.float32]:
    """The light behind encoded values in [0, 1], by a fine table; float32, any shape."""
    light = np.linspace(0, 1, _TABLE, dtype=np.float32) ** 3
    return np.asarray(np.interp(encoded, encode(light, response), light), np.float32)


def sigmoid_encode(linear: NDArray[np.float32], n: float, s: float) -> NDArray[np.float32]:
    """The response (1 + s) x^n / (x^n + s): 0 to 0 and 1 to 1 (Eilertsen et al. 2017)."""
    raised = np.power(linear, np.float32(n))
    return np.asarray((1 + s) * raised / (raised + s), np.float32)
