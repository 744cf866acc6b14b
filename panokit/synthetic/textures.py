"""Pictures on surfaces, painted from a recipe: walls, paving, leaves, shop windows.

All patterns are functions of the recipe alone, so a city is the same wherever it is rendered.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_encode_u8
from panokit.synthetic.materials import Texture

Picture = NDArray[np.floating[Any]]


def paint(recipe: Texture) -> NDArray[np.uint8]:
    """The picture of a recipe, (height_px, width_px, 3) uint8 sRGB; row 0 is the upper edge."""
    linear = _PATTERNS[recipe.pattern](recipe)
    return srgb_encode_u8(np.clip(linear, 0.004, 0.95))


@lru_cache(maxsize=64)
def _cloudy(size_px: int, seed: int, slope: float = 1.6) -> Picture:
    """Noise that repeats at its edges, mean 0 and deviation 1, with power falling as f^-2 slope."""
    rng = np.random.default_rng(seed)
    frequency = np.fft.fftfreq(size_px) * size_px
    distance = np.hypot(frequency[:, None], frequency[None, :])
    distance[0, 0] = 1
    spectrum = np.fft.fft2(rng.standard_normal((size_px, size_px))) / distance**slope
    spectrum[0, 0] = 0
    noise = np.fft.ifft2(spectrum).real
    return (noise / noise.std()).astype(np.float32)


def _noise(recipe: Texture, seed: int, slope: float = 1.6, stretch: float = 1.0) -> Picture:
    """Cloudy noise of the recipe's size; `stretch` > 1 draws it out downward."""
    square = _cloudy(512, recipe.seed * 31 + seed, slope)
    rows = np.linspace(0, 511 / stretch, recipe.height_px, dtype=np.float32)
    columns = np.linspace(0, 511, recipe.width_px, dtype=np.float32)
    across, down = np.meshgrid(columns, rows)
    drawn = cv2.remap(square, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
    return np.asarray(drawn, np.float32)


def _grain(recipe: Texture, seed: int) -> Picture:
    rng = np.random.default_rng([recipe.seed, seed])
    return rng.standard_normal((recipe.height_px, recipe.width_px), np.float32)


def _meters(recipe: Texture) -> tuple[Picture, Picture]:
    """How far each pixel is from the left and from the bottom, in meters."""
    x = (np.arange(recipe.width_px, dtype=np.float32) + 0.5) / recipe.width_px * recipe.width_m
    y = (np.arange(recipe.height_px, dtype=np.float32) + 0.5) / recipe.height_px * recipe.height_m
    across, up = np.meshgrid(x, y[::-1])
    return across, up


def _tinted(recipe: Texture, shade: Picture) -> Picture:
    return np.asarray(recipe.color, np.float32) * shade[..., None]


def _courses(
    recipe: Texture, length_m: float, height_m: float, joint_m: float, offset: float = 0.5
) -> tuple[Picture, Picture]:
    """Blocks laid in courses: a random number for each block, and 1 in the joints."""
    across, up = _meters(recipe)
    course = np.floor(up / height_m)
    shifted = across / length_m + offset * (course % 2)
    block = np.floor(shifted)
    # A cheap hash: the same block has the same number wherever it is seen.
    number = np.sin(block * 12.9898 + course * 78.233 + recipe.seed * 3.7) * 43758.5453
    along, above = (shifted - block) * length_m, up - course * height_m
    edge = np.minimum(np.minimum(along, length_m - along), np.minimum(above, height_m - above))
    joints = np.clip(1.5 - edge / joint_m, 0, 1)
    return (number - np.floor(number)).astype(np.float32), joints.astype(np.float32)


def _weather(recipe: Texture) -> Picture:
    """How much darker rain, soot and splashes have made each place of a facade."""
    across, up = _meters(recipe)
    shade = 1 + 0.05 * _noise(recipe, 1, 1.4) + 0.035 * _noise(recipe, 2, 1.1, stretch=8)
    shade -= 0.22 * np.exp(-up / 0.6) + 0.10 * np.exp(-(recipe.height_m - up) / 0.8)
    streaks = np.clip(_noise(recipe, 3, 1.0, stretch=14), 0, 2)
    for left, bottom, right, _ in recipe.marks:
        under = (across > left - 0.1) & (across < right + 0.1) & (up < bottom)
        shade -= np.where(under, 0.10 * streaks * np.exp(-(bottom - up) / 0.9), 0)
    return np.clip(shade, 0.35, 1.25).astype(np.float32)


def _plaster(recipe: Texture) -> Picture:
    fine = 1 + 0.025 * _grain(recipe, 1) + 0.03 * _noise(recipe, 5, 0.8)
    patches = (_noise(recipe, 6, 1.9) > 1.9).astype(np.float32)
    bare = cv2.GaussianBlur(patches, (0, 0), 1.2)[..., None]
    wall = _tinted(recipe, _weather(recipe) * fine)
    return wall * (1 - 0.5 * bare) + np.array([0.32, 0.29, 0.25], np.float32) * 0.5 * bare


def _brick(recipe: Texture) -> Picture:
    number, joints = _courses(recipe, 0.25, 0.077, 0.008)
    shade = 0.72 + 0.5 * number + 0.04 * _grain(recipe, 1)
    bricks = _tinted(recipe, shade)
    bricks[..., 0] *= 1 + 0.12 * (number - 0.5)
    mortar = np.array([0.4, 0.38, 0.34], np.float32) * (1 + 0.05 * _grain(recipe, 2))[..., None]
    mixed = bricks + (mortar - bricks) * joints[..., None]
    return mixed * _weather(recipe)[..., None]


def _stone(recipe: Texture) -> Picture:
    number, joints = _courses(recipe, 0.9, 0.42, 0.011)
    shade = (0.9 + 0.18 * number) * (1 + 0.05 * _noise(recipe, 7, 0.9) + 0.02 * _grain(recipe, 1))
    return _tinted(recipe, shade * (1 - 0.45 * joints) * _weather(recipe))


def _concrete(recipe: Texture) -> Picture:
    _, joints = _courses(recipe, 2.7, 3.0, 0.012, offset=0.0)
    shade = 1 + 0.06 * _noise(recipe, 8, 1.2) + 0.02 * _grain(recipe, 1)
    return _tinted(recipe, shade * (1 - 0.5 * joints) * _weather(recipe))


def _asphalt(recipe: Texture) -> Picture:
    stones = 1 + 0.16 * _grain(recipe, 1) + 0.10 * _noise(recipe, 2, 0.6)
    wear = 1 + 0.07 * _noise(recipe, 3, 1.6)
    cracks = np.abs(_noise(recipe, 4, 1.7)) < 0.012
    return _tinted(recipe, stones * wear * (1 - 0.45 * cracks))


def _paving(recipe: Texture) -> Picture:
    number, joints = _courses(recipe, 0.5, 0.5, 0.006)
    shade = (0.86 + 0.26 * number) * (1 + 0.05 * _grain(recipe, 1) + 0.05 * _noise(recipe, 2, 1.2))
    return _tinted(recipe, shade * (1 - 0.55 * joints))


def _cobbles(recipe: Texture) -> Picture:
    number, joints = _courses(recipe, 0.125, 0.1, 0.011)
    shade = (0.7 + 0.6 * number) * (1 + 0.06 * _grain(recipe, 1) + 0.08 * _noise(recipe, 2, 1.5))
    return _tinted(recipe, shade * (1 - 0.7 * joints))


def _grass(recipe: Texture) -> Picture:
    shade = 1 + 0.3 * _grain(recipe, 1) + 0.15 * _noise(recipe, 2, 0.9)
    dry = np.clip(_noise(recipe, 3, 1.6), 0, 2)[..., None] * np.array(
        [0.05, 0.035, 0.0], np.float32
    )
    return _tinted(recipe, np.clip(shade, 0.2, 2)) + dry


def _tiles(recipe: Texture) -> Picture:
    across, up = _meters(recipe)
    wave = 0.75 + 0.35 * np.abs(np.sin(across * np.pi / 0.22))
    lap = 1 - 0.45 * np.clip(1 - np.mod(up, 0.33) / 0.05, 0, 1)
    number, _ = _courses(recipe, 0.22, 0.33, 0.01, offset=0.0)
    shade = (0.8 + 0.35 * number) * wave * lap * (1 + 0.1 * _noise(recipe, 2, 1.3))
    return _tinted(recipe, shade)


def _wood(recipe: Texture) -> Picture:
    across, _ = _meters(recipe)
    seam = np.clip(1 - np.mod(across, 0.14) / 0.012, 0, 1)
    shade = 1 + 0.12 * _noise(recipe, 1, 1.0, stretch=20) - 0.6 * seam
    return _tinted(recipe, shade)


def _stripes(recipe: Texture) -> Picture:
    across, _ = _meters(recipe)
    band = (np.mod(across, 0.5) < 0.25)[..., None]
    return np.where(
        band, np.array(recipe.color, np.float32), np.array([0.78, 0.76, 0.7], np.float32)
    )


def _curtain(recipe: Texture) -> Picture:
    """A lit room behind net curtains: brighter in the middle, folds at the sides."""
    across, up = _meters(recipe)
    x, y = across / recipe.width_m, up / recipe.height_m
    folds = 0.85 + 0.15 * np.sin(across * 55 + recipe.seed)
    drawn = 0.12 + 0.2 * ((recipe.seed * 7919) % 100) / 100
    open_part = (x > drawn) & (x < 1 - drawn)
    room = 0.55 + 0.5 * np.exp(-(((x - 0.5) / 0.4) ** 2) - ((y - 0.75) / 0.5) ** 2)
    return _tinted(recipe, np.where(open_part, room, 0.5 * folds * (0.6 + 0.4 * y)) * 0.8)


def _shop(recipe: Texture) -> Picture:
    """The inside of a shop: back wall, ceiling lights, shelves with goods of all colors."""
    rng = np.random.default_rng(recipe.seed)
    height, width = recipe.height_px, recipe.width_px
    picture = np.empty((height, width, 3), np.float32)
    wall = rng.uniform(0.25, 0.6, 3).astype(np.float32)
    picture[:] = wall * np.linspace(0.9, 0.35, height, dtype=np.float32)[:, None, None]
    picture[int(0.86 * height) :] = np.array([0.16, 0.12, 0.09], np.float32)
    for left in np.arange(0.04, 0.92, 0.16):
        _shelf(picture, rng, left)
    for left in np.arange(0.1, 0.95, 0.2):
        x0 = int(left * width)
        picture[int(0.03 * height) : int(0.07 * height), x0 : x0 + width // 11] = 0.95
    blurred = np.asarray(cv2.GaussianBlur(picture, (0, 0), 1.0), np.float32)
    return blurred * np.asarray(recipe.color, np.float32)


def _shelf(picture: Picture, rng: np.random.Generator, left: float) -> None:
    height, width = picture.shape[:2]
    x0, x1 = int(left * width), int((left + rng.uniform(0.09, 0.14)) * width)
    top = rng.uniform(0.2, 0.45)
    for level in np.arange(top, 0.84, 0.13):
        y1 = int((level + 0.12) * height)
        x = x0
        while x < x1:
            step = int(width * rng.uniform(0.006, 0.02)) + 1
            y0 = y1 - int(height * rng.uniform(0.05, 0.1))
            grey = rng.uniform(0.08, 0.55)
            picture[y0:y1, x : x + step] = grey + (rng.uniform(0.05, 0.6, 3) - grey) * 0.45
            x += step + 1
        picture[y1 : y1 + max(1, height // 90), x0:x1] = np.array([0.3, 0.24, 0.18], np.float32)


_PATTERNS: dict[str, Callable[[Texture], Picture]] = {
    "asphalt": _asphalt,
    "brick": _brick,
    "cobbles": _cobbles,
    "concrete": _concrete,
    "curtain": _curtain,
    "grass": _grass,
    "paving": _paving,
    "plaster": _plaster,
    "shop": _shop,
    "stone": _stone,
    "stripes": _stripes,
    "tiles": _tiles,
    "wood": _wood,
}
