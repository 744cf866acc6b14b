"""LDR pictures from HDR maps: what a camera would have shown of the same light.

Two presets are the project's test cameras. A exposes so that the 90th percentile of
luminance over the sphere becomes 0.8 and stores sRGB without compression. B varies the
exposure, the response curve (the sigmoid of Eilertsen et al. 2017, "HDR image reconstruction
from a single exposure using deep CNNs", section 5) and stores a JPEG. The third, STREET, has
everything that pictures from the street may have: noise, a white balance that is off, curves of
all families, local tone mapping, JPEG of any quality.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.development import Development, develop
from panokit.color.luminance import luminance, weighted_percentile
from panokit.color.response import SRGB, TONED_BANK, Response
from panokit.color.response import sigmoid_encode as sigmoid_encode
from panokit.errors import ImageError, UsageError


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """How a camera exposes and encodes; ranges are drawn from anew for each picture.

    Attributes:
        name: For tables.
        level: The lowest and highest value that the 90th percentile of luminance over the
            sphere is exposed to, in units of the clip level; log-uniform between.
        sigmoid_share: How often the response is the sigmoid and not sRGB, 0 to 1.
        sigmoid_n: Mean and standard deviation of the sigmoid's exponent.
        sigmoid_s: Mean and standard deviation of the sigmoid's shoulder.
        gamma_share: How often the response is a pure gamma instead.
        gamma: Lowest and highest gamma.
        toned_share: How often it is one of `panokit.color.response.TONED_BANK` instead.
        white_balance: Standard deviation of the log of the gains of red and blue.
        shot_noise: Lowest and highest, see `panokit.color.development.Development`.
        read_noise: Lowest and highest.
        local_share: How often there is local tone mapping.
        local: Its lowest and highest strength.
        jpeg_quality: Lowest and highest JPEG quality, or None for no compression.
    """

    name: str
    level: tuple[float, float]
    sigmoid_share: float = 0.0
    sigmoid_n: tuple[float, float] = (0.9, 0.1)
    sigmoid_s: tuple[float, float] = (0.6, 0.1)
    gamma_share: float = 0.0
    gamma: tuple[float, float] = (1.8, 2.6)
    toned_share: float = 0.0
    white_balance: float = 0.0
    shot_noise: tuple[float, float] = (0.0, 0.0)
    read_noise: tuple[float, float] = (0.0, 0.0)
    local_share: float = 0.0
    local: tuple[float, float] = (0.1, 0.4)
    jpeg_quality: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.level[0] <= self.level[1]:
            raise UsageError(f"Camera {self.name!r}: levels are 0 < low <= high, not {self.level}.")
        shares = (self.sigmoid_share, self.gamma_share, self.toned_share, self.local_share)
        if min(shares) < 0 or max(shares) > 1 or sum(shares[:3]) > 1 + 1e-9:
            raise UsageError(
                f"Camera {self.name!r}: shares are from 0 to 1, and those of responses at most 1 "
                f"together; they are {shares}."
            )


CAMERA_A = Camera(name="A", level=(0.8, 0.8))
CAMERA_B = Camera(name="B", level=(0.4, 1.2), sigmoid_share=1.0, jpeg_quality=(90, 90))
CAMERA_STREET = Camera(
    name="street",
    level=(0.4, 1.5),
    sigmoid_share=0.3,
    gamma_share=0.1,
    toned_share=0.3,
    white_balance=0.06,
    shot_noise=(0.002, 0.02),
    read_noise=(0.0005, 0.004),
    local_share=0.4,
    jpeg_quality=(75, 98),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shot:
    """A picture and how it was taken.

    Attributes:
        pixels: (H, W, 3) uint8, display-encoded.
        exposure: Radiance times this is in units of the level at which the picture clips.
        sigmoid: (n, s) of the response curve, or None where it is none.
        jpeg_quality: Of the compression, or None.
        development: All that happened before the compression.
    """

    pixels: NDArray[np.uint8]
    exposure: float
    sigmoid: tuple[float, float] | None = None
    jpeg_quality: int | None = None
    development: Development | None = None


def photograph(radiance: NDArray[np.floating[Any]], camera: Camera, *, seed: int = 0) -> Shot:
    """Take a picture of a map; clipping and compression happen at the map's own size.

    Args:
        radiance: (H, W, 3), linear, >= 0, equirectangular.
        camera: How.
        seed: The same seed draws the same exposure and curve.

    Raises:
        ImageError: If the map is black where the exposure is measured.
    """
    random = np.random.default_rng([seed, 0x63616D])
    low, high = np.log(camera.level)
    level = float(np.exp(random.uniform(low, high)))
    exposure = level / exposed_percentile(radiance)
    sigmoid = None
    pick = random.random()
    if pick < camera.sigmoid_share:
        sigmoid = (
            max(float(random.normal(*camera.sigmoid_n)), 0.3),
            max(float(random.normal(*camera.sigmoid_s)), 0.1),
        )
    development = _draw(camera, exposure, sigmoid, pick, seed)
    pixels = develop(radiance, development)
    quality = None
    if camera.jpeg_quality is not None:
        quality = int(random.integers(camera.jpeg_quality[0], camera.jpeg_quality[1] + 1))
        pixels = through_jpeg(pixels, quality)
    return Shot(
        pixels=pixels,
        exposure=exposure,
        sigmoid=sigmoid,
        jpeg_quality=quality,
        development=development,
    )


def exposed_percentile(radiance: NDArray[np.floating[Any]], percent: float = 90) -> float:
    """The percentile of luminance over the sphere that the exposure is measured by.

    Raises:
        ImageError: If it is black.
    """
    height, width = radiance.shape[:2]
    edges = np.cos(np.linspace(0, np.pi, height + 1))
    weights = np.broadcast_to((edges[:-1] - edges[1:])[:, None], (height, width))
    bright = weighted_percentile(luminance(radiance), weights, percent)
    if not bright > 0:
        raise ImageError(
            f"{percent:g} percent of this map are black, so no exposure can be found for it.",
            reason="black-map",
        )
    return bright


def through_jpeg(pixels: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """The picture as a JPEG of this quality, 1 to 100, shows it."""
    stored, data = cv2.imencode(
        ".jpg", np.ascontiguousarray(pixels[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, quality]
    )
    if not stored:
        raise ImageError("The picture could not be stored as a JPEG.", reason="not-encodable")
    decoded = cv2.imdecode(data, cv2.IMREAD_COLOR)
    if decoded is None:
        raise ImageError("The picture could not be read back.", reason="not-decodable")
    return np.ascontiguousarray(decoded[..., ::-1], np.uint8)


def _draw(
    camera: Camera,
    exposure: float,
    sigmoid: tuple[float, float] | None,
    pick: float,
    seed: int,
) -> Development:
    """The choices that the presets A and B do not make, drawn apart so as not to change theirs."""
    random = np.random.default_rng([seed, 0x6D6F7265])
    red, blue = np.exp(random.normal(0, 1, 2) * camera.white_balance)
    shot, read = (
        low + (high - low) * float(random.random())
        for low, high in (camera.shot_noise, camera.read_noise)
    )
    gamma = float(random.uniform(*camera.gamma))
    toned = TONED_BANK[int(random.integers(len(TONED_BANK)))]
    has_local = random.random() < camera.local_share
    local = float(random.uniform(*camera.local))
    if sigmoid is not None:
        response = Response(family="sigmoid", numbers=sigmoid)
    elif pick < camera.sigmoid_share + camera.gamma_share:
        response = Response(family="gamma", numbers=(gamma,))
    elif pick < camera.sigmoid_share + camera.gamma_share + camera.toned_share:
        response = toned
    else:
        response = SRGB
    return Development(
        exposure=exposure,
        white_balance=(float(red), float(blue)),
        shot_noise=shot,
        read_noise=read,
        noise_seed=seed,
        local=local if has_local else 0.0,
        response=response,
    )
