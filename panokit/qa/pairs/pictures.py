"""Known scenes under the true light and under the estimate, side by side.

The scenes are lit by precomputed transport, so that both pictures differ by the light alone.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, srgb_encode
from panokit.io.images import encode_jpeg
from panokit.metrics.transport import relight
from panokit.metrics.transport.scenes import PLANE
from panokit.qa.pairs.aligning import AlignedPair

SCENES = ("diffuse", "glossy-0.3", "mirror", PLANE)
COLUMNS = ("truth", "estimate", "difference")
TILE_PX = 128
# The light of a scene's brighter parts in the truth becomes this display-linear value.
_WHITE_AT = 0.8
_WHITE_PERCENTILE = 95.0
# A difference of so many stops has the full color.
FULL_STOPS = 2.0
_DARKEST = 0.02
_BACKGROUND = 0.18
_GAP_PX = 4
_PAPER = 255
_JPEG_QUALITY = 90
# Blue where the estimate is too dark, gray where it is right, red where it is too bright: as
# display values, alike in lightness on both sides so that neither looks worse.
_TOO_DARK, _RIGHT, _TOO_BRIGHT = (33, 102, 172), (232, 232, 232), (178, 24, 43)


def relit_sheet(pair: AlignedPair, scenes: tuple[str, ...] = SCENES) -> NDArray[np.uint8]:
    """A row for each scene: under the truth, under the estimate, and the difference.

    Truth and estimate are exposed alike. The difference is of luminance, in stops, on a scale
    from blue (the estimate is a quarter as bright, or less) over gray to red (four times).

    Returns:
        (H, W, 3) uint8, sRGB, with `len(scenes)` rows and three columns of tiles of 128
        pixels, 4 pixels of white between them.
    """
    rows = [_row(pair, scene) for scene in scenes]
    gap = np.full((_GAP_PX, rows[0].shape[1], 3), _PAPER, np.uint8)
    parts = [part for row in rows for part in (row, gap)]
    return np.concatenate(parts[:-1])


def encode_sheet(sheet: NDArray[np.uint8]) -> bytes:
    """The sheet as a JPEG."""
    return encode_jpeg(sheet, quality=_JPEG_QUALITY)


def difference_scale(width_px: int = 256, height_px: int = 12) -> NDArray[np.uint8]:
    """The colors of the difference from -2 to +2 stops, (height, width, 3) uint8."""
    stops = np.linspace(-FULL_STOPS, FULL_STOPS, width_px)
    row = np.asarray(np.rint(_colors(stops)), np.uint8)
    return np.ascontiguousarray(np.broadcast_to(row, (height_px, width_px, 3)))


def _row(pair: AlignedPair, scene: str) -> NDArray[np.uint8]:
    truth, estimate = (_lit(radiance, scene) for radiance in (pair.truth, pair.estimate))
    covered = truth[..., 3] > 0.5
    light = luminance(truth[..., :3])
    white = float(np.percentile(light[covered], _WHITE_PERCENTILE))
    exposure = _WHITE_AT / white if white > 0 else 1.0
    tiles = [_shown(picture, exposure) for picture in (truth, estimate)]
    tiles.append(_difference(truth, estimate, exposure))
    gap = np.full((TILE_PX, _GAP_PX, 3), _PAPER, np.uint8)
    return np.concatenate([tiles[0], gap, tiles[1], gap, tiles[2]], axis=1)


def _lit(radiance: NDArray[np.float32], scene: str) -> NDArray[np.float32]:
    """A scene of `TILE_PX`, RGBA."""
    # The scene on the plane has one size only.
    size_px = None if scene == PLANE else TILE_PX
    picture = relight(np.ascontiguousarray(radiance, np.float32), scene, size_px)
    if len(picture) == TILE_PX:
        return picture
    picture[..., :3] *= picture[..., 3:]
    larger = cv2.resize(picture, (TILE_PX, TILE_PX), interpolation=cv2.INTER_CUBIC)
    alpha = np.clip(larger[..., 3:], 0, 1)
    color = np.maximum(larger[..., :3], 0) / np.maximum(alpha, 1e-6)
    return np.asarray(np.concatenate([color, alpha], axis=-1), np.float32)


def _shown(picture: NDArray[np.float32], exposure: float) -> NDArray[np.uint8]:
    color = np.clip(picture[..., :3] * np.float32(exposure), 0, 1)
    over = color * picture[..., 3:] + np.float32(_BACKGROUND) * (1 - picture[..., 3:])
    return np.asarray(np.rint(srgb_encode(np.clip(over, 0, 1)) * 255), np.uint8)


def _difference(
    truth: NDArray[np.float32], estimate: NDArray[np.float32], exposure: float
) -> NDArray[np.uint8]:
    """Stops by which the estimate is brighter; what is dark in both is right."""
    floor = _DARKEST
    both = [luminance(picture[..., :3]) * exposure + floor for picture in (estimate, truth)]
    colors = _colors(np.log2(both[0] / both[1]))
    alpha = truth[..., 3:]
    paper = np.float32(_PAPER)
    return np.asarray(np.rint(colors * alpha + paper * (1 - alpha)), np.uint8)


def _colors(stops: NDArray[np.floating]) -> NDArray[np.float64]:
    """Display values of differences, (...,) -> (..., 3), 0 to 255."""
    share = np.clip(np.asarray(stops, np.float64) / FULL_STOPS, -1, 1)[..., None]
    right = np.array(_RIGHT, np.float64)
    dark = right + (np.array(_TOO_DARK) - right) * np.maximum(-share, 0)
    bright = right + (np.array(_TOO_BRIGHT) - right) * np.maximum(share, 0)
    return np.where(share < 0, dark, bright)
