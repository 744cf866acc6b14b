"""Blur a map on the sphere: the von Mises-Fisher kernel, a Gaussian's sibling without edges."""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, irfft, rfft

from panokit.equirectangular import check_equirectangular
from panokit.errors import ImageError, UsageError
from panokit.sphere.harmonics import harmonics_degrees, harmonics_map, project_harmonics
from panokit.sphere.harmonics_filters import vmf_factors
from panokit.sphere.irradiance import check_radiance, energy
from panokit.sphere.solid_angle import row_solid_angles

# Where the kernel has fallen below exp(-_REACH) of its peak it is left out: a sun of 10^5 times
# the sky's radiance does not show a step there.
_REACH = 24.0
# Harmonics are the faster way up to this degree.
_MOST_DEGREES = 64


def blur_radiance(radiance: NDArray[np.floating], kappa: float) -> NDArray[np.float32]:
    """Convolve a map with the von Mises-Fisher kernel, energy kept.

    The kernel kappa / (4 pi sinh kappa) exp(kappa cos angle) (Mardia and Jupp 2000,
    "Directional Statistics", section 9.3.2) is near to a Gaussian of 1 / sqrt(kappa) radians:
    100 blurs by 5.7 degrees. It is evaluated as exp(kappa (cos - 1)), which never overflows,
    so any kappa will do; as it grows the result becomes the map itself.

    A broad kernel is applied to harmonics, degree by degree. A narrow one is a convolution
    along the azimuth for each pair of rows, done by Fourier transform over those rows and
    frequencies only that the kernel reaches. The rows' weights are balanced so that the map's
    energy is kept and a uniform map stays uniform.

    Args:
        radiance: (H, W, 3), equirectangular.
        kappa: The concentration, at least 0; 0 is the mean over the sphere, inf no blur.

    Returns:
        (H, W, 3) float32, at least 0 if the map is.

    Raises:
        UsageError: If kappa is negative or no number.
        ImageError: If the map is not (H, 2 H, 3), or holds a value that is not finite.
    """
    radiance = np.asarray(radiance)
    check_equirectangular(radiance)
    check_radiance(radiance)
    if not kappa >= 0:
        raise UsageError(f"kappa is at least 0, not {kappa}.")
    if not np.isfinite(radiance).all():
        raise ImageError(
            "The map holds values that are not finite. Replace them before blurring.",
            reason="not-finite",
        )
    height, width = radiance.shape[:2]
    # Kernels that no neighboring pixel feels, those next to the poles excepted.
    if kappa * (2 * np.pi / width * np.pi / (2 * height)) ** 2 / 2 > _REACH:
        return radiance.astype(np.float32)
    order = _order_needed(kappa)
    if 2 * order < height and order <= _MOST_DEGREES:
        blurred = _by_harmonics(radiance, kappa, order)
    else:
        blurred = _by_rows(radiance, kappa)
    if radiance.min() >= 0:
        blurred = np.maximum(blurred, 0.0)
    before, after = energy(radiance), energy(blurred)
    gain = np.divide(before, after, out=np.ones(3), where=after != 0)
    return np.asarray(blurred * gain, np.float32)


def _order_needed(kappa: float) -> int:
    """The degree beyond which the kernel keeps less than exp(-_REACH)."""
    order = 4
    while order <= _MOST_DEGREES and vmf_factors(kappa, order)[-1] > np.exp(-_REACH):
        order += 4
    return order


def _by_harmonics(radiance: NDArray[np.floating], kappa: float, order: int) -> NDArray[np.float64]:
    # Without the mean, a uniform map stays exactly uniform, poles included.
    mean = energy(radiance) / (4 * np.pi)
    coefficients = project_harmonics(radiance - mean, order)
    coefficients *= vmf_factors(kappa, order)[harmonics_degrees(order), None]
    return harmonics_map(coefficients, radiance.shape[1]) + mean


def _by_rows(radiance: NDArray[np.floating], kappa: float) -> NDArray[np.float64]:
    height, width, channels = radiance.shape
    # Beyond this frequency the kernel's transform, about exp(-m^2 / (2 kappa)), is nothing.
    frequencies = min(int(np.sqrt(2 * _REACH * kappa)) + 2, width // 2)
    band = _band_rows(kappa, height)
    spectrum = rfft(radiance.astype(np.float64), axis=1)[:, : frequencies + 1]
    weights = row_solid_angles(height, width)
    kernels = [_row_kernels(row, kappa, height, frequencies, band) for row in range(height)]
    balance = _balance(kernels, weights * width, band)
    blurred = np.zeros((height, width // 2 + 1, channels), np.complex128)
    for row, kernel in enumerate(kernels):
        rows = _reach(row, band, height)
        scaled = kernel * (balance[rows] * weights[rows] * width * balance[row])[:, None]
        blurred[row, : frequencies + 1] = np.einsum(
            "rm,rmc->mc", scaled, spectrum[rows], optimize=False
        )
    return np.asarray(irfft(blurred, width, axis=1))


def _row_kernels(
    row: int, kappa: float, height: int, frequencies: int, band: int
) -> NDArray[np.float64]:
    """The transform along the azimuth of the kernel between one row and those it reaches.

    With a and b the polar angles of the rows and t the difference of azimuths, cos angle - 1 is
    -2 sin^2((a - b) / 2) - 2 sin a sin b sin^2(t / 2), without the cancellation that the cosine
    itself has for small angles.

    Returns:
        (rows, frequencies + 1) float64; entry 0 is the mean along the row.
    """
    polar = (np.arange(height) + 0.5) * (np.pi / height)
    near = polar[_reach(row, band, height)]
    apart = np.sin((near - polar[row]) / 2) ** 2
    level = np.sin(near) * np.sin(polar[row])
    turned = np.sin(np.arange(frequencies + 1) * (np.pi / (2 * frequencies))) ** 2
    values = np.exp(-2 * kappa * (apart[:, None] + level[:, None] * turned))
    # The kernel is even, so its discrete transform is a cosine transform of one half.
    return np.asarray(dct(values, type=1, axis=1) / (2 * frequencies))


def _balance(
    kernels: list[NDArray[np.float64]], weights: NDArray[np.float64], band: int
) -> NDArray[np.float64]:
    """Factors d so that sum_s d_r K_rs w_s d_s is 1 for every row r.

    K is symmetric, so the same factors keep uniform maps uniform and the energy what it was
    (Sinkhorn's scaling of a symmetric matrix; damped, it converges in some ten rounds).
    """
    height = len(kernels)
    means = [kernel[:, 0] for kernel in kernels]
    reach = [_reach(row, band, height) for row in range(height)]
    balance = np.ones(height)
    for _ in range(100):
        sums = np.array(
            [
                mean @ (weights[rows] * balance[rows])
                for mean, rows in zip(means, reach, strict=True)
            ]
        )
        updated = np.sqrt(balance / sums)
        if np.abs(updated / balance - 1).max() < 1e-9:
            break
        balance = updated
    return balance


def _band_rows(kappa: float, height: int) -> int:
    half = np.sqrt(min(_REACH / (2 * kappa), 1.0))
    return int(2 * np.arcsin(half) / np.pi * height) + 1


def _reach(row: int, band: int, height: int) -> slice:
    return slice(max(row - band, 0), min(row + band + 1, height))
