"""LDR pictures from HDR maps: what a camera would have shown of the same light.

Two presets are the project's test cameras. A exposes so that the 90th percentile of
luminance over the sphere becomes 0.8 and stores sRGB without compression. B varies the
exposure, the response curve (the sigmoid of Eilertsen et al. 2017, "HDR image reconstruction
from a single exposure using deep CNNs", section 5) and stores a JPEG.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance, weighted_percentile
from panokit.color.transfer import srgb_encode
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
        jpeg_quality: Lowest and highest JPEG quality, or None for no compression.
    """

    name: str
    level: tuple[float, float]
    sigmoid_share: float = 0.0
    sigmoid_n: tuple[float, float] = (0.9, 0.1)
    sigmoid_s: tuple[float, float] = (0.6, 0.1)
    jpeg_quality: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.level[0] <= self.level[1]:
            raise UsageError(f"Camera {self.name!r}: levels are 0 < low <= high, not {self.level}.")


CAMERA_A = Camera(name="A", level=(0.8, 0.8))
CAMERA_B = Camera(name="B", level=(0.4, 1.2), sigmoid_share=1.0, jpeg_quality=(90, 90))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shot:
    """A picture and how it was taken.

    Attributes:
        pixels: (H, W, 3) uint8, display-encoded.
        exposure: Radiance times this is in units of the level at which the picture clips.
        sigmoid: (n, s) of the response curve, or None where it is sRGB.
        jpeg_quality: Of the compression, or None.
    """

    pixels: NDArray[np.uint8]
    exposure: float
    sigmoid: tuple[float, float] | None = None
    jpeg_quality: int | None = None


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
    exposure = level / _percentile_90(radiance)
    exposed = np.minimum(np.asarray(radiance, np.float32) * np.float32(exposure), 1)
    sigmoid = None
    if random.random() < camera.sigmoid_share:
        sigmoid = (
            max(float(random.normal(*camera.sigmoid_n)), 0.3),
            max(float(random.normal(*camera.sigmoid_s)), 0.1),
        )
    encoded = srgb_encode(exposed) if sigmoid is None else sigmoid_encode(exposed, *sigmoid)
    pixels = np.rint(encoded * 255).astype(np.uint8)
    quality = None
    if camera.jpeg_quality is not None:
        quality = int(random.integers(camera.jpeg_quality[0], camera.jpeg_quality[1] + 1))
        pixels = _through_jpeg(pixels, quality)
    return Shot(pixels=pixels, exposure=exposure, sigmoid=sigmoid, jpeg_quality=quality)


def sigmoid_encode(linear: NDArray[np.float32], n: float, s: float) -> NDArray[np.float32]:
    """The response (1 + s) x^n / (x^n + s): 0 to 0 and 1 to 1 (Eilertsen et al. 2017)."""
    raised = np.power(linear, np.float32(n))
    return np.asarray((1 + s) * raised / (raised + s), np.float32)


def _percentile_90(radiance: NDArray[np.floating[Any]]) -> float:
    height, width = radiance.shape[:2]
    edges = np.cos(np.linspace(0, np.pi, height + 1))
    weights = np.broadcast_to((edges[:-1] - edges[1:])[:, None], (height, width))
    bright = weighted_percentile(luminance(radiance), weights, 90)
    if not bright > 0:
        raise ImageError(
            "Nine tenths of this map are black, so no exposure can be found for it.",
            reason="black-map",
        )
    return bright


def _through_jpeg(pixels: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    stored, data = cv2.imencode(
        ".jpg", np.ascontiguousarray(pixels[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, quality]
    )
    if not stored:
        raise ImageError("The picture could not be stored as a JPEG.", reason="not-encodable")
    decoded = cv2.imdecode(data, cv2.IMREAD_COLOR)
    if decoded is None:
        raise ImageError("The picture could not be read back.", reason="not-decodable")
    return np.ascontiguousarray(decoded[..., ::-1], np.uint8)
