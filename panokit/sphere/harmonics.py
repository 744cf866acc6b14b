"""Real spherical harmonics with +Y up: light as a few numbers, from broad to fine.

The functions are orthonormal, and the first four are the constant and the three axes:

    index  degree l, m   function of a direction (x, y, z)         where it is largest
      0       0,  0      0.282095                                  everywhere
      1       1, -1      0.488603 x                                right, east
      2       1,  0      0.488603 y                                up
      3       1, +1      0.488603 z                                backward, south
      4       2, -2      1.092548 z x                              between south and east
      5       2, -1      1.092548 x y                              up and east
      6       2,  0      0.315392 (3 y^2 - 1)                      up and down
      7       2, +1      1.092548 y z                              up and south
      8       2, +2      0.546274 (z^2 - x^2)                      south and north

Function (l, m) has index l^2 + l + m. With the polar axis up and phi = atan2(x, z) counted
from south through east, it is K_lm P_l^|m|(y) times sqrt(2) cos(m phi) for m > 0, times
sqrt(2) sin(|m| phi) for m < 0, without the Condon-Shortley sign (Sloan 2008, "Stupid
Spherical Harmonics Tricks", appendix A1, with the axes turned so that +Y is up).

"Order" n means all degrees l <= n, (n + 1)^2 coefficients: order 2 has 9, order 8 has 81.
"""

from functools import lru_cache
from math import isqrt
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, UsageError
from panokit.sphere.irradiance import check_radiance
from panokit.sphere.solid_angle import row_solid_angles

Coefficients = NDArray[np.float64]

# A strip of this many rows is transformed at once, so that big maps need little memory.
_STRIP_ROWS = 512


def harmonics_basis(directions: NDArray[np.floating[Any]], order: int) -> NDArray[np.float64]:
    """Every function up to a degree, at directions.

    Evaluated as polynomials of x, y, z in float64, without angles, so nothing special
    happens at the poles.

    Args:
        directions: (..., 3), of any length but zero.
        order: The highest degree, at least 0.

    Returns:
        (..., (order + 1)^2) float64.
    """
    _check_order(order)
    directions = np.asarray(directions, np.float64)
    if directions.shape[-1:] != (3,):
        raise UsageError(f"Directions have shape (..., 3), not {directions.shape}.")
    x, y, z = np.moveaxis(directions / np.linalg.norm(directions, axis=-1, keepdims=True), -1, 0)
    basis = np.empty((*y.shape, (order + 1) ** 2))
    # sin^m(theta) times cos(m phi) and sin(m phi) are the parts of (z + i x)^m.
    turning = np.ones(y.shape, np.complex128)
    for m in range(order + 1):
        for degree, part in enumerate(_legendre(y, m, order), start=m):
            center = degree * degree + degree
            basis[..., center + m] = part * turning.real
            if m:
                basis[..., center - m] = part * turning.imag
        turning = turning * (z + 1j * x)
    return basis


def project_harmonics(
    radiance: NDArray[np.floating[Any]],
    order: int = 8,
    *,
    pixels: Literal["means", "samples"] = "means",
) -> Coefficients:
    """The coefficients of a map: the integral of radiance times each function over the sphere.

    Args:
        radiance: (H, W, C), equirectangular, with more than 2 `order` columns and rows.
        order: The highest degree.
        pixels: What a pixel's value is. "means": the mean over its area, as in every light
            probe; each counts with its exact solid angle, so coefficient 0 is the energy
            over sqrt(4 pi), and a map made of values at the pixels' middles is off by 5e-5
            at 1024x512. "samples": the value at its middle; then the rows count with the
            weights of Fejer's first quadrature (1933), which are exact for band-limited maps.

    Returns:
        ((order + 1)^2, C) float64.

    Raises:
        ImageError: If the map has no channel axis, is too small for the order or not finite.
    """
    _check_order(order)
    radiance = np.asarray(radiance)
    check_radiance(radiance)
    height, width, channels = radiance.shape
    _check_size(height, width, order)
    spectrum = np.empty((height, order + 1, channels), np.complex128)
    for top in range(0, height, _STRIP_ROWS):
        strip = radiance[top : top + _STRIP_ROWS].astype(np.float64)
        spectrum[top : top + _STRIP_ROWS] = np.fft.rfft(strip, axis=1)[:, : order + 1]
    if not np.isfinite(spectrum).all():
        raise ImageError(
            "The map holds values that are not finite. Replace them before projecting.",
            reason="not-finite",
        )
    weights = row_solid_angles(height, width)
    if pixels == "samples":
        weights = _fejer_weights(height) * (2 * np.pi / width)
    spectrum *= (weights[:, None] * _half_pixel(order, width).conj())[..., None]
    coefficients = np.empty(((order + 1) ** 2, channels))
    for m, rows in enumerate(_row_functions(height, order)):
        degrees = np.arange(m, order + 1)
        sums = rows @ spectrum[:, m]
        coefficients[degrees * degrees + degrees + m] = sums.real
        if m:
            coefficients[degrees * degrees + degrees - m] = sums.imag
    return coefficients


def evaluate_harmonics(
    coefficients: NDArray[np.floating[Any]], directions: NDArray[np.floating[Any]]
) -> NDArray[np.float64]:
    """What coefficients ((order + 1)^2, C) say of directions (..., 3); (..., C) float64."""
    coefficients = np.asarray(coefficients, np.float64)
    return np.asarray(harmonics_basis(directions, harmonics_order(coefficients)) @ coefficients)


def harmonics_map(
    coefficients: NDArray[np.floating[Any]], width_px: int = 256
) -> NDArray[np.float64]:
    """The map that coefficients describe, at the pixels' middles; it may be negative.

    Returns:
        (width_px // 2, width_px, C) float64, not float32, so that projecting it as
        "samples" returns the coefficients to rounding.
    """
    coefficients = np.asarray(coefficients, np.float64)
    order = harmonics_order(coefficients)
    height = width_px // 2
    _check_size(height, width_px, order)
    spectrum = np.zeros((height, width_px // 2 + 1, coefficients.shape[1]), np.complex128)
    for m, rows in enumerate(_row_functions(height, order)):
        degrees = np.arange(m, order + 1)
        part = coefficients[degrees * degrees + degrees + m].astype(np.complex128)
        if m:
            part += 1j * coefficients[degrees * degrees + degrees - m]
            part *= 0.5
        spectrum[:, m] = rows.T @ part
    spectrum[:, : order + 1] *= (_half_pixel(order, width_px) * width_px)[:, None]
    return np.fft.irfft(spectrum, width_px, axis=1)


def harmonics_order(coefficients: NDArray[np.floating[Any]]) -> int:
    """The order n of coefficients (n + 1)^2 x C.

    Raises:
        UsageError: If their number is no square.
    """
    count = len(coefficients)
    order = isqrt(count) - 1
    if coefficients.ndim != 2 or count < 1 or (order + 1) ** 2 != count:
        raise UsageError(
            "Coefficients have shape ((order + 1)^2, C), so 1, 4, 9, 16, ... rows, "
            f"not {coefficients.shape}."
        )
    return order


def harmonics_degrees(order: int) -> NDArray[np.int64]:
    """The degree l of each coefficient, ((order + 1)^2,)."""
    return np.repeat(np.arange(order + 1), 2 * np.arange(order + 1) + 1)


def _legendre(y: NDArray[np.float64], m: int, order: int) -> list[NDArray[np.float64]]:
    """Normalized P_l^m(y) / (1 - y^2)^(m / 2) for l = m .. order, sqrt(2) included for m > 0.

    The recursion on fully normalized functions is stable to degrees of thousands (Holmes and
    Featherstone 2002, equations 11 and 12).
    """
    steps = np.arange(1, m + 1)
    first = np.sqrt(np.prod((2 * steps + 1) / (2 * steps)) * (2 if m else 1) / (4 * np.pi))
    found = [np.full_like(y, first)]
    before = np.zeros_like(y)
    for degree in range(m + 1, order + 1):
        span = degree * degree - m * m
        a = np.sqrt((4 * degree * degree - 1) / span)
        b = np.sqrt(((degree - 1) ** 2 - m * m) / (4 * (degree - 1) ** 2 - 1))
        found.append(a * (y * found[-1] - b * before))
        before = found[-2]
    return found


@lru_cache(maxsize=4)
def _row_functions(height: int, order: int) -> list[NDArray[np.float64]]:
    """For each m, the functions' dependence on the row, (order + 1 - m, H)."""
    elevation = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    up, horizontal = np.sin(elevation), np.cos(elevation)
    return [np.stack(_legendre(up, m, order)) * horizontal**m for m in range(order + 1)]


def _half_pixel(order: int, width: int) -> NDArray[np.complex128]:
    """The turn between a column's edge, where the Fourier transform counts from, and middle."""
    return np.asarray(np.exp(1j * np.pi / width * np.arange(order + 1)), np.complex128)


def _fejer_weights(height: int) -> NDArray[np.float64]:
    theta = (np.arange(height) + 0.5) * (np.pi / height)
    k = np.arange(1, (height - 1) // 2 + 1)
    sums = (np.cos(2 * np.outer(theta, k)) / (4 * k * k - 1)).sum(axis=1)
    return np.asarray((1 - 2 * sums) * (2 / height), np.float64)


def _check_order(order: int) -> None:
    if order < 0:
        raise UsageError(f"The order of harmonics is at least 0, not {order}.")


def _check_size(height: int, width: int, order: int) -> None:
    if min(height, width) <= 2 * order:
        raise ImageError(
            f"Harmonics of order {order} need a map of more than {4 * order}x{2 * order}; this "
            f"one is {width}x{height}. Take a lower order or a larger map.",
            reason="too-small",
            values={"width_px": width, "height_px": height, "order": order},
        )
