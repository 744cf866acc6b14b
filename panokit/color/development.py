"""What happens to light between a camera's lens and its file, but for the compression.

exposure -> white balance -> noise -> clipping of each channel -> local tone mapping ->
response -> 8 bits. Its torch twin is `panokit.networks.camera`.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.color.response import SRGB, Response, encode
from panokit.errors import ImageError, UsageError

# The neighborhood of local tone mapping: a standard deviation of this part of the width.
LOCAL_SIGMA = 1 / 32
# Neighborhoods as bright as this, of the clip level, are left alone; darker ones are lifted,
# by this factor at most.
LOCAL_PIVOT = 0.5
LOCAL_MOST = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Development:
    """One set of choices, all of them.

    Attributes:
        exposure: Radiance times this is in units of the clip level.
        white_balance: Gains of red and blue before clipping; (1, 1) is none.
        shot_noise: Standard deviation at the clip level of noise that grows with the root
            of the light.
        read_noise: Standard deviation of noise that is there in the dark too.
        noise_seed: Of the noise.
        local: Strength of local tone mapping, 0 to 1: dark neighborhoods are multiplied by
            (their mean / 0.5)^-local. White stays white.
        response: The curve.
    """

    exposure: float
    white_balance: tuple[float, float] = (1.0, 1.0)
    shot_noise: float = 0.0
    read_noise: float = 0.0
    noise_seed: int = 0
    local: float = 0.0
    response: Response = SRGB

    def __post_init__(self) -> None:
        positive = (self.exposure, *self.white_balance)
        if not (np.isfinite(positive).all() and min(positive) > 0):
            raise UsageError(f"Exposure and white balance are positive, not {positive}.")
        if not (min(self.shot_noise, self.read_noise) >= 0 and 0 <= self.local <= 1):
            raise UsageError(
                "Noise is at least 0 and local tone mapping from 0 to 1, not "
                f"{(self.shot_noise, self.read_noise, self.local)}."
            )

    @property
    def has_noise(self) -> bool:
        """Whether there is any noise."""
        return self.shot_noise > 0 or self.read_noise > 0


def develop(radiance: NDArray[np.floating[Any]], development: Development) -> NDArray[np.uint8]:
    """The picture (H, W, 3) uint8, display-encoded, of a map (H, W, 3), linear, >= 0.

    Raises:
        ImageError: If the map is not (H, W, 3).
    """
    radiance = np.asarray(radiance)
    if radiance.ndim != 3 or radiance.shape[2] != 3 or 0 in radiance.shape:
        raise ImageError(
            f"A map to photograph is (H, W, 3), not {radiance.shape}.", reason="wrong-shape"
        )
    light = np.asarray(radiance, np.float32) * np.float32(development.exposure)
    if development.white_balance != (1.0, 1.0):
        red, blue = development.white_balance
        light = light * np.array([red, 1, blue], np.float32)
    if development.has_noise:
        light = add_noise(light, development, noise_field(light.shape, development.noise_seed))
    light = np.minimum(light, 1)
    if development.local > 0:
        light = tone_locally(light, development.local)
    return np.rint(encode(light, development.response) * 255).astype(np.uint8)


def noise_field(shape: tuple[int, ...], seed: int) -> NDArray[np.float32]:
    """Normal noise of standard deviation 1; the same seed gives the same field."""
    return np.random.default_rng([seed, 0x6E6F69]).standard_normal(shape, np.float32)


def add_noise(
    light: NDArray[np.float32], development: Development, field: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Shot and read noise: variance shot^2 light + read^2; never below 0 (Poisson-Gaussian,
    Foi et al. 2008, "Practical Poissonian-Gaussian noise modeling").
    """  # noqa: D205
    # What is far beyond clipping is clipped whatever its noise.
    counted = np.minimum(light, np.float32(4))
    variance = np.float32(development.shot_noise**2) * counted
    deviation = np.sqrt(variance + np.float32(development.read_noise**2))
    return np.asarray(np.maximum(light + deviation * field, 0), np.float32)


def tone_locally(light: NDArray[np.float32], strength: float) -> NDArray[np.float32]:
    """Lift dark neighborhoods; (H, W, 3) in [0, 1], 0 and 1 stay, nothing is newly clipped.

    With g the gain of a neighborhood, x becomes g x / (1 + (g - 1) x).
    """
    mean = neighborhood(np.asarray(luminance(light), np.float32))
    gain = local_gain_curve(mean, strength)[..., None]
    return np.asarray(gain * light / (1 + (gain - 1) * light), np.float32)


def local_gain_curve(mean: NDArray[np.float32], strength: float) -> NDArray[np.float32]:
    """The gain of neighborhoods of this mean luminance, from 1 to `LOCAL_MOST`."""
    raised = np.power(np.maximum(mean, 1e-4) / np.float32(LOCAL_PIVOT), np.float32(-strength))
    return np.asarray(np.clip(raised, 1, LOCAL_MOST), np.float32)


def neighborhood(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """The Gaussian mean round each pixel of (H, W); columns wrap, rows repeat."""
    kernel = gaussian_kernel(values.shape[1])
    pad = len(kernel) // 2
    wide = np.pad(values, ((0, 0), (pad, pad)), mode="wrap")
    tall = np.pad(wide, ((pad, pad), (0, 0)), mode="edge")
    blurred = cv2.sepFilter2D(tall, -1, kernel, kernel)
    return np.asarray(blurred[pad:-pad, pad:-pad], np.float32)


def gaussian_kernel(width_px: int) -> NDArray[np.float32]:
    """Weights over +-2 standard deviations, of odd length, with sum 1."""
    sigma = max(width_px * LOCAL_SIGMA, 0.5)
    radius = max(int(2 * sigma), 1)
    weights = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    return np.asarray(weights / weights.sum(), np.float32)
