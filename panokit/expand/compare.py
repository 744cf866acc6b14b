"""All methods on one panorama, side by side: what a network adds, for eyes and for tools."""

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance, srgb_encode_u8
from panokit.envmap import Anchor, EnvironmentMap
from panokit.expand.reduce import reduce_panorama
from panokit.expand.settings import ExpandSettings
from panokit.expand.stage import ANALYTIC, expand
from panokit.metrics import diffuse_ball
from panokit.panorama import Panorama
from panokit.sphere import resize_radiance

STOPS = (0.0, -3.0, -6.0)
_TILE_PX = 320
_BALL_PX = 128
_BAND_PX = 26
_GAP_PX = 4
_PAPER, _INK = 245, 30


def compare_methods(
    panorama: Panorama, settings: ExpandSettings, envmap: EnvironmentMap
) -> dict[str, EnvironmentMap]:
    """The maps of the analytic methods, and the one that the settings' model made.

    Args:
        panorama: What was expanded.
        settings: Of the stage.
        envmap: What `expand` returned for them.

    Returns:
        Name -> map, from what is there without panokit to the model.
    """
    width = envmap.width_px
    encoded = resize_radiance(reduce_panorama(panorama.pixels, width).encoded, width)
    # The code values take part in no anchor: they are nobody's radiance.
    plain = settings.model_copy(
        update={"compare": False, "anchor_sky_cd_m2": None, "anchor_sun_lx": None,
                "anchor_sun_w_m2": None, "anchor_white_cd_m2": None}
    )  # fmt: skip
    maps = {
        "ldr": envmap.with_changes(
            radiance=encoded, anchor=Anchor.RELATIVE, provenance=panorama.provenance
        )
    }
    for name in ANALYTIC:
        if name != settings.model:
            maps[name] = expand(panorama, plain.model_copy(update={"model": name}))
    return {**maps, settings.model: envmap}


def comparison_picture(maps: Mapping[str, EnvironmentMap]) -> NDArray[np.uint8]:
    """One picture of several maps: a column each, darker from row to row, then a white ball.

    The columns are brought to one scale by their medians, which no lamp moves; the balls share
    an exposure, so that the one under more light is brighter.

    Args:
        maps: Name -> map of any size.

    Returns:
        (h, w, 3) uint8, sRGB.
    """
    small = {name: _tile(envmap) for name, envmap in maps.items()}
    balls = {name: diffuse_ball(tile, _BALL_PX) for name, tile in small.items()}
    brightest = max(float(luminance(ball[..., :3]).max()) for ball in balls.values())
    columns = []
    for name, tile in small.items():
        parts = [_band(name, _TILE_PX)]
        for stops in STOPS:
            parts += [srgb_encode_u8(tile * np.float32(2.0**stops)), _paper(_GAP_PX, _TILE_PX)]
        parts.append(_ball_tile(balls[name], brightest))
        columns.append(np.concatenate(parts))
    rows = columns[0].shape[0]
    margin = _margin(rows)
    pieces = [margin]
    for column in columns:
        pieces += [column, _paper(rows, _GAP_PX)]
    return np.ascontiguousarray(np.concatenate(pieces, axis=1))


def _tile(envmap: EnvironmentMap) -> NDArray[np.float32]:
    """The map at the tile's size, with a median luminance of 0.18, as in a picture."""
    radiance = envmap.radiance
    small = resize_radiance(radiance, _TILE_PX)
    middle = float(np.median(luminance(small)))
    return np.asarray(small * np.float32(0.18 / max(middle, 1e-12)), np.float32)


def _ball_tile(ball: NDArray[np.float32], brightest: float) -> NDArray[np.uint8]:
    shown = srgb_encode_u8(ball[..., :3] / np.float32(max(brightest, 1e-12)))
    alpha = ball[..., 3:]
    mixed = (shown * alpha + _PAPER * (1 - alpha)).astype(np.uint8)
    tile = _paper(_BALL_PX + 2 * _GAP_PX, _TILE_PX)
    left = (_TILE_PX - _BALL_PX) // 2
    tile[_GAP_PX : _GAP_PX + _BALL_PX, left : left + _BALL_PX] = mixed
    return tile


def _margin(rows: int) -> NDArray[np.uint8]:
    """What each row shows."""
    strip = _paper(rows, 72)
    step = _TILE_PX // 2 + _GAP_PX
    labels = ["as is" if not stops else f"{stops:+.0f} EV" for stops in STOPS]
    for i, text in enumerate([*labels, "ball"]):
        place = _BAND_PX + i * step + (_TILE_PX // 4 if i < len(labels) else _BALL_PX // 2)
        _write(strip, text, 6, place)
    return strip


def _band(text: str, width: int) -> NDArray[np.uint8]:
    band = _paper(_BAND_PX, width)
    _write(band, text, 6, _BAND_PX - 8)
    return band


def _write(picture: NDArray[np.uint8], text: str, x: int, y: int) -> None:
    font, ink = cv2.FONT_HERSHEY_SIMPLEX, (_INK, _INK, _INK)
    cv2.putText(picture, text, (x, y), font, 0.5, ink, 1, cv2.LINE_AA)


def _paper(height: int, width: int) -> NDArray[np.uint8]:
    return np.full((height, width, 3), _PAPER, np.uint8)
