"""PU21: absolute luminance to values that errors look alike in, and the PSNR of those.

Mantiuk and Azimi 2021, "PU21: A novel perceptually uniform encoding for adapting existing
quality metrics for HDR"; the variant "banding + glare" with its published constants. The clip
level of the LDR picture stands for 100 cd/m2.

The tone-corrected variant follows Hanji et al. 2022, "Comparison of single image HDR
reconstruction methods - the caveats of quality assessment": before the comparison a cubic
polynomial of PQ-encoded luminance and a cubic polynomial of u'v' are fitted to the truth, so
that a wrong camera curve is not counted as missing light.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.metrics.pairs import check_radiance, check_same_shape
from panokit.metrics.similarity import SsimSettings, ssim
from panokit.sphere import row_solid_angles

CLIP_LEVEL_CD_M2 = 100.0

_PU = (
    0.353487901, 0.3734658629, 8.277049286e-05, 0.9062562627,
    0.09150303166, 0.9099517204, 596.3148142,
)  # fmt: skip
_DARKEST_CD_M2, _BRIGHTEST_CD_M2 = 0.005, 10000.0
# PU21 takes 100 cd/m2 to 256, which is why its PSNR counts 256 as the peak.
_PEAK = 256.0
# SMPTE ST 2084.
_PQ_M, _PQ_N, _PQ_C1, _PQ_C2, _PQ_C3 = 78.8438, 0.1593, 0.8359, 18.8516, 18.6875
# ITU-R BT.709 to CIE XYZ.
_XYZ_FROM_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
     [0.0193339, 0.1191920, 0.9503041]]
)  # fmt: skip
_RGB_FROM_XYZ = np.linalg.inv(_XYZ_FROM_RGB)

# The weights that the published PU21 code takes luminance by.
_LUMINANCE = np.array([0.212656, 0.715158, 0.072186])
_SSIM = SsimSettings(
    window_px=11, sigma_px=1.5, sample_covariance=False, data_range=_PEAK, spherical=True
)

Array = NDArray[np.floating[Any]]


def pu21_encode(luminance_cd_m2: Array) -> NDArray[np.float64]:
    """Absolute values to PU21 units, 0 to about 600; clipped to 0.005..10000 cd/m2."""
    y = np.clip(np.asarray(luminance_cd_m2, np.float64), _DARKEST_CD_M2, _BRIGHTEST_CD_M2)
    raised = y ** _PU[3]
    ratio = (_PU[0] + _PU[1] * raised) / (1 + _PU[2] * raised)
    return np.asarray(np.maximum(_PU[6] * (ratio ** _PU[4] - _PU[5]), 0))


def pu21_psnr(estimate: Array, truth: Array) -> float:
    """PU21-PSNR in dB over RGB, weighted by solid angle; both in units of the clip level.

    Infinite for equal maps. Do not read it alone: with a sun in the picture it prefers an
    estimate without one (see `pu21_crf_psnr`).
    """
    _check(estimate, truth)
    return _psnr(estimate * CLIP_LEVEL_CD_M2, truth * CLIP_LEVEL_CD_M2)


def pu21_psnr_y(estimate: Array, truth: Array) -> float:
    """As `pu21_psnr`, of luminance alone: PSNRY of the published code."""
    _check(estimate, truth)
    guess, true = (_luminance_cd_m2(radiance)[..., None] for radiance in (estimate, truth))
    return _psnr(guess, true)


def pu21_ssim(estimate: Array, truth: Array) -> float:
    """SSIM of PU21-encoded luminance, on the sphere, with the published range of 256.

    Gaussian windows of 1.5 px go on across the seam and the poles (the published code takes the
    picture as flat). Hanji et al. advise against it for single-image HDR: it ranks methods
    unlike people do. In units of the clip level, (H, W, 3).
    """
    _check(estimate, truth)
    guess, true = (pu21_encode(_luminance_cd_m2(radiance)) for radiance in (estimate, truth))
    return ssim(guess[..., None], true[..., None], _SSIM)


def pu21_crf_psnr(estimate: Array, truth: Array) -> float:
    """PU21-PSNR in dB after the tone and color correction of Hanji et al. 2022."""
    _check(estimate, truth)
    guess = np.asarray(estimate, np.float64) * CLIP_LEVEL_CD_M2
    true = np.asarray(truth, np.float64) * CLIP_LEVEL_CD_M2
    return _psnr(_tone_corrected(guess, true), true)


def _luminance_cd_m2(radiance: Array) -> NDArray[np.float64]:
    return np.asarray(np.asarray(radiance, np.float64) @ _LUMINANCE * CLIP_LEVEL_CD_M2)


def _check(estimate: Array, truth: Array) -> None:
    check_same_shape(estimate, truth)
    for radiance in (estimate, truth):
        check_radiance(np.asarray(radiance))


def _psnr(estimate: Array, truth: Array) -> float:
    height, width = truth.shape[:2]
    weights = row_solid_angles(height, width) / (4 * np.pi)
    squared = (pu21_encode(estimate) - pu21_encode(truth)) ** 2
    error = float(weights @ squared.mean(axis=2).sum(axis=1))
    return float(10 * np.log10(_PEAK**2 / error)) if error > 0 else float("inf")


def _tone_corrected(estimate: NDArray[np.float64], truth: NDArray[np.float64]) -> Array:
    guess_y, guess_uv = _split(estimate)
    true_y, true_uv = _split(truth)
    tone = _pq_encode(guess_y)
    powers = np.stack([tone**3, tone**2, tone, np.ones_like(tone)], axis=-1)
    fitted, *_ = np.linalg.lstsq(powers, _pq_encode(true_y), rcond=None)
    light = _pq_decode(powers @ fitted)
    terms = _color_terms(guess_uv)
    # Tikhonov toward "no change", as strong as in the published code (lambda 0.01).
    identity = np.zeros((terms.shape[1], 2))
    identity[0, 0] = identity[1, 1] = 1
    strength = 0.01 * len(terms) / terms.shape[1]
    left = terms.T @ terms + strength * np.eye(terms.shape[1])
    change = np.linalg.solve(left, terms.T @ true_uv + strength * identity)
    return _join(light, terms @ change).reshape(truth.shape)


def _split(rgb: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Luminance (N,) and u'v' (N, 2), scaled to the 0..1 range of 8-bit video."""
    xyz = np.maximum(rgb.reshape(-1, 3), 1e-6) @ _XYZ_FROM_RGB.T
    x, y, z = xyz.T
    norm = x + 15 * y + 3 * z
    uv = np.stack([4 * x / norm, 9 * y / norm], axis=1) * (410 / 255)
    return np.clip(y, _DARKEST_CD_M2, _BRIGHTEST_CD_M2), uv


def _join(y: NDArray[np.float64], uv: NDArray[np.float64]) -> NDArray[np.float64]:
    u, v = np.maximum(uv / (410 / 255), 1e-3).T
    x = y * 9 * u / (4 * v)
    z = y * (12 - 3 * u - 20 * v) / (4 * v)
    rgb = np.stack([x, y, z], axis=1) @ _RGB_FROM_XYZ.T
    return np.asarray(np.maximum(rgb, _DARKEST_CD_M2))


def _color_terms(uv: NDArray[np.float64]) -> NDArray[np.float64]:
    u, v = uv.T
    return np.stack([u, v, u**2, v**2, u * v, u**3, v**3, np.ones_like(u)], axis=1)


def _pq_encode(y: NDArray[np.float64]) -> NDArray[np.float64]:
    raised = (y / _BRIGHTEST_CD_M2) ** _PQ_N
    return np.asarray(((_PQ_C1 + _PQ_C2 * raised) / (1 + _PQ_C3 * raised)) ** _PQ_M)


def _pq_decode(value: NDArray[np.float64]) -> NDArray[np.float64]:
    root = np.clip(value, 0, 1) ** (1 / _PQ_M)
    ratio = np.maximum(root - _PQ_C1, 0) / (_PQ_C2 - _PQ_C3 * root)
    return np.asarray(np.maximum(ratio ** (1 / _PQ_N) * _BRIGHTEST_CD_M2, _DARKEST_CD_M2))
