"""Factors per degree: irradiance, blur, and windows against ringing.

Cutting a map off at some degree makes it ring: rings of too much and too little light, even
negative light, round a sun. A window lets the high degrees fade instead of ending.
"""

from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, ive

from panokit.errors import UsageError
from panokit.sphere.equirect import equirect_directions
from panokit.sphere.harmonics import (
    Coefficients,
    harmonics_basis,
    harmonics_degrees,
    harmonics_order,
)

Window = Literal["hann", "lanczos", "gauss"]

# Where the search for negative values looks first: every 1.4 degrees.
_SEARCH_WIDTH_PX = 256


def cosine_factors(order: int) -> NDArray[np.float64]:
    """What each degree of radiance keeps in irradiance, (order + 1,): pi, 2 pi / 3, pi / 4, ...

    The coefficients of the clamped cosine, A_l = 2 pi (-1)^(l/2 - 1) / ((l + 2) (l - 1))
    l! / (2^l (l/2)!^2) for even l and 0 for odd l > 1 (Ramamoorthi and Hanrahan 2001, "An
    Efficient Representation for Irradiance Environment Maps", equation 8).
    """
    degree = np.arange(order + 1)
    half = degree / 2
    central = np.exp(gammaln(degree + 1) - 2 * gammaln(half + 1) - degree * np.log(2))
    sign = np.where(degree % 4 == 2, 1.0, -1.0)
    below = np.where(degree == 1, 1, (degree + 2) * (degree - 1))
    factors = np.where(degree % 2 == 0, 2 * np.pi * sign * central / below, 0.0)
    factors[degree == 1] = 2 * np.pi / 3
    return factors


def vmf_factors(kappa: float, order: int) -> NDArray[np.float64]:
    """What each degree keeps under a von Mises-Fisher blur, (order + 1,), the first 1.

    I_(l + 1/2)(kappa) / I_(1/2)(kappa) (Mardia and Jupp 2000, "Directional Statistics",
    section 9.3.2), with exponentially scaled Bessel functions, which do not overflow.
    """
    if not kappa >= 0:
        raise UsageError(f"kappa is at least 0, not {kappa}.")
    degree = np.arange(order + 1)
    if kappa < 1e-6:
        return np.where(degree == 0, 1.0, np.where(degree == 1, kappa / 3, 0.0))
    if kappa > 1e8:
        # The Bessel functions' first asymptotic term; the next is smaller by 1 / kappa.
        return np.exp(-degree * (degree + 1) / (2 * kappa))
    return np.asarray(ive(degree + 0.5, kappa) / ive(0.5, kappa))


def irradiance_harmonics(coefficients: NDArray[np.floating[Any]]) -> Coefficients:
    """The coefficients of irradiance as a function of the normal, from those of radiance."""
    coefficients = np.asarray(coefficients, np.float64)
    order = harmonics_order(coefficients)
    return coefficients * cosine_factors(order)[harmonics_degrees(order), None]


def window_harmonics(
    coefficients: NDArray[np.floating[Any]], window: Window, *, width: float | None = None
) -> Coefficients:
    """Let the high degrees fade.

    Args:
        coefficients: ((order + 1)^2, C).
        window: "hann": (1 + cos(pi l / w)) / 2, and "lanczos": sin(pi l / w) / (pi l / w), both
            0 from l = w on (Sloan 2008, "Stupid Spherical Harmonics Tricks", "Ringing");
            "gauss": exp(-l (l + 1) / (2 w^2)), which is a blur by 1 / w radians and rings at
            no width (the heat kernel of the sphere).
        width: w. If not given, order + 1, the widest that still ends at 0; for "gauss" half
            of that.

    Returns:
        ((order + 1)^2, C) float64. Coefficient 0, the energy, is unchanged.
    """
    coefficients = np.asarray(coefficients, np.float64)
    order = harmonics_order(coefficients)
    if width is None:
        width = (order + 1) / 2 if window == "gauss" else order + 1.0
    if not width > 0:
        raise UsageError(f"The width of a window is positive, not {width}.")
    degree = np.arange(order + 1)
    if window == "gauss":
        factors = np.exp(-degree * (degree + 1) / (2 * width**2))
    elif window == "hann":
        factors = np.where(degree < width, (1 + np.cos(np.pi * degree / width)) / 2, 0.0)
    elif window == "lanczos":
        factors = np.where(degree < width, np.sinc(degree / width), 0.0)
    else:
        raise UsageError(f"Unknown window {window!r}: choose hann, lanczos or gauss.")
    return np.asarray(coefficients * factors[harmonics_degrees(order), None], np.float64)


def nonnegative_harmonics(coefficients: NDArray[np.floating[Any]]) -> tuple[Coefficients, float]:
    """The least Gauss window under which no channel is negative anywhere.

    A Gauss window is the flow of heat on the sphere, under which the least value of a
    function only rises (the maximum principle), so bisection finds the window. All channels
    get the same one, or hues would change.

    Args:
        coefficients: ((order + 1)^2, C), each channel's mean at least 0.

    Returns:
        The coefficients, and the window's width for `window_harmonics`, inf if none was needed.
        What is left below zero between the places searched is under 1e-3 of the largest value.

    Raises:
        UsageError: If a channel's mean is negative: no window mends that.
    """
    ringing = np.asarray(coefficients, np.float64)
    order = harmonics_order(ringing)
    if (ringing[0] < 0).any():
        raise UsageError("The mean of a channel is negative; no window makes it positive.")
    if _least(ringing) >= 0:
        return ringing.copy(), float("inf")
    narrow, wide = 0.0, 1.0
    while _least(_blurred(ringing, wide)) < 0:
        narrow, wide = wide, wide * 2
        if wide > 64:
            # A channel without a mean is black, and so is all that may be kept of it.
            break
    for _ in range(20):
        middle = (narrow + wide) / 2
        if _least(_blurred(ringing, middle)) < 0:
            narrow = middle
        else:
            wide = middle
    width = order / wide if order else float("inf")
    return window_harmonics(ringing, "gauss", width=width), width


def _blurred(coefficients: Coefficients, strength: float) -> Coefficients:
    order = harmonics_order(coefficients)
    return window_harmonics(coefficients, "gauss", width=order / strength)


def _least(coefficients: Coefficients) -> float:
    """The least value of any channel: on a grid, then on a finer one round its lowest place."""
    order = harmonics_order(coefficients)
    directions, basis = _search_grid(order)
    values = basis @ coefficients
    lowest = np.argmin(values, axis=0)
    least = float(values.min())
    for channel, index in enumerate(lowest):
        near = _patch(directions[index], 2 * np.pi / _SEARCH_WIDTH_PX)
        least = min(least, float((harmonics_basis(near, order) @ coefficients[:, channel]).min()))
    return least


@lru_cache(maxsize=1)
def _search_grid(order: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    grid = equirect_directions(_SEARCH_WIDTH_PX, _SEARCH_WIDTH_PX // 2)
    directions = grid.reshape(-1, 3).astype(np.float64)
    return directions, harmonics_basis(directions, order)


def _patch(center: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """A 9x9 grid of directions round one, `radius` to either side."""
    side = np.cross(center, np.eye(3)[np.argmin(np.abs(center))])
    side /= np.linalg.norm(side)
    steps = np.linspace(-radius, radius, 9)
    across = steps[:, None, None] * side + steps[None, :, None] * np.cross(center, side)
    return (center + across).reshape(-1, 3)
