"""What objects are made of: random principled materials and small procedural textures.

The ranges, in which every figure is drawn independently for each material:

==================  =============================================================
kind                60 % dielectrics, 20 % varnished or cloth-like, 20 % metals
albedo              hue even; saturation mostly low; luminance 0.06 to 0.8, as of
                    paints, woods and cloths (snow is 0.9, soot 0.04)
metal               iron, aluminum, copper, gold or brass, somewhat tinted
roughness           0.08 to 0.95; of metals 0.08 to 0.6
specular            0.2 to 0.8 (index of refraction 1.3 to 1.8)
sheen, flatness     0.2 to 1 on cloth
clearcoat, gloss    0.3 to 1 and 0.5 to 1 on varnish
==================  =============================================================

Lobes that are off have the strength `OFF` instead of zero: a renderer that compiles its
kernels makes another one for each set of lobes that are exactly zero.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color.luminance import luminance
from panokit.dataset.scene import Material
from panokit.dataset.settings import ObjectSettings

OFF = 1e-4
DARKEST, BRIGHTEST = 0.06, 0.8
# Reflectance at normal incidence, linear Rec.709 (computed from measured indices of
# refraction; Akenine-Moeller et al., "Real-Time Rendering", 4th edition, table 9.2).
METALS = {
    "iron": (0.562, 0.565, 0.578),
    "aluminum": (0.912, 0.914, 0.920),
    "copper": (0.955, 0.638, 0.538),
    "gold": (1.0, 0.782, 0.344),
    "brass": (0.910, 0.778, 0.423),
}
TEXTURE_PX = 128
# One texture is laid on each square of this size.
TEXTURE_SIDE_M = 0.5
_METAL_SHARE, _COATED_SHARE = 0.2, 0.2
Picture = NDArray[np.float32]


def draw_material(rng: np.random.Generator, settings: ObjectSettings) -> Material:
    """A material from the ranges above, with a texture in `textured_share` of the cases."""
    kind = rng.random()
    if kind < _METAL_SHARE:
        return _metal(rng)
    color = draw_albedo(rng)
    texture = None
    if rng.random() < settings.textured_share:
        texture = draw_texture(rng, color)
        color = _color(texture.mean(axis=(0, 1)))
    lobes = {"sheen": OFF, "flatness": OFF, "clearcoat": OFF, "clearcoat_gloss": 0.9}
    roughness = rng.uniform(0.08, 0.95)
    if kind < _METAL_SHARE + _COATED_SHARE / 2:
        lobes |= {"clearcoat": rng.uniform(0.3, 1), "clearcoat_gloss": rng.uniform(0.5, 1)}
    elif kind < _METAL_SHARE + _COATED_SHARE:
        lobes |= {"sheen": rng.uniform(0.2, 1), "flatness": rng.uniform(0.2, 1)}
        roughness = rng.uniform(0.6, 0.95)
    return Material(
        base_color=color,
        roughness=float(roughness),
        metallic=OFF,
        specular=float(rng.uniform(0.2, 0.8)),
        texture=texture,
        **{name: float(value) for name, value in lobes.items()},
    )


def _metal(rng: np.random.Generator) -> Material:
    base = np.array(METALS[sorted(METALS)[rng.integers(len(METALS))]])
    tint = base * rng.uniform(0.75, 1.0) * (1 + rng.uniform(-0.06, 0.06, 3))
    return Material(
        base_color=_color(np.clip(tint, 0.1, 0.97)),
        roughness=float(rng.uniform(0.08, 0.6)),
        metallic=float(rng.uniform(0.9, 1.0)),
        specular=0.5,
        sheen=OFF,
        clearcoat=OFF,
        clearcoat_gloss=0.9,
        flatness=OFF,
    )


def draw_albedo(rng: np.random.Generator) -> tuple[float, float, float]:
    """A color whose luminance and saturation are as of things in a room, linear Rec.709."""
    hue, saturation = rng.uniform(0, 6), 0.85 * rng.beta(1.3, 1.8)
    wheel = np.clip(np.abs((hue + np.array([3.0, 1, 5])) % 6 - 3) - 1, 0, 1)
    color = 1 - saturation * wheel
    target = DARKEST + (BRIGHTEST - DARKEST) * rng.beta(1.5, 2.2)
    color = color * target / float(luminance(color))
    # A saturated color cannot be bright: the rest of the light is gray.
    excess = max(float(color.max()) / 0.85, 1.0)
    return _color(np.clip(color / excess, 0.02, 0.85))


def _color(values: NDArray[Any]) -> tuple[float, float, float]:
    red, green, blue = (round(float(value), 5) for value in values)
    return red, green, blue


def draw_texture(rng: np.random.Generator, color: tuple[float, float, float]) -> Picture:
    """A texture that repeats at its borders, in a color and a relative of it.

    Returns:
        (128, 128, 3) float32 linear albedo, 0.02 to 0.85.
    """
    pattern = TEXTURES[sorted(TEXTURES)[rng.integers(len(TEXTURES))]](rng)
    first = np.asarray(color)
    factor = rng.uniform(0.3, 0.7) if first.max() > 0.2 else rng.uniform(1.8, 3.0)
    second = first * factor * (1 + rng.uniform(-0.15, 0.15, 3))
    mixed = first + pattern[..., None] * (second - first)
    return np.clip(mixed, 0.02, 0.85).astype(np.float32)


def _noise(rng: np.random.Generator, sizes: tuple[int, ...], strength: float = 0.5) -> Picture:
    """Smooth noise in [0, 1] that repeats, as a sum of octaves (rows and columns alike)."""
    total = np.zeros((TEXTURE_PX, TEXTURE_PX))
    at = np.arange(TEXTURE_PX) / TEXTURE_PX
    for octave, cells in enumerate(sizes):
        grid = rng.random((cells, cells))
        low, share = np.floor(at * cells).astype(int), at * cells % 1
        share = share * share * (3 - 2 * share)
        rows = grid[low] + (grid[(low + 1) % cells] - grid[low]) * share[:, None]
        total += (rows[:, low] + (rows[:, (low + 1) % cells] - rows[:, low]) * share) * (
            strength**octave
        )
    return ((total - total.min()) / max(np.ptp(total), 1e-9)).astype(np.float32)


def _wood(rng: np.random.Generator) -> Picture:
    x, y = np.meshgrid(np.arange(TEXTURE_PX) / TEXTURE_PX, np.arange(TEXTURE_PX) / TEXTURE_PX)
    grain = _noise(rng, (2, 4, 8)) * rng.uniform(0.1, 0.25)
    # Turned into a circle, the picture repeats along the board.
    rings = (y + grain + 0.03 * np.sin(2 * np.pi * x)) * int(rng.integers(5, 12)) % 1
    fibers = _noise(rng, (64,)).mean(axis=1, keepdims=True)
    return np.clip(0.75 * np.abs(2 * rings - 1) ** 1.5 + 0.5 * (fibers - 0.35), 0, 1).astype(
        np.float32
    )


def _checker(rng: np.random.Generator) -> Picture:
    count = 2 * int(rng.integers(1, 4))
    step = np.arange(TEXTURE_PX) * count // TEXTURE_PX
    return ((step[:, None] + step) % 2).astype(np.float32)


def _stripes(rng: np.random.Generator) -> Picture:
    count, width = int(rng.integers(3, 9)), rng.uniform(0.25, 0.6)
    wave = (np.arange(TEXTURE_PX) / TEXTURE_PX * count) % 1 < width
    return np.broadcast_to(wave.astype(np.float32), (TEXTURE_PX, TEXTURE_PX)).copy()


def _cloud(rng: np.random.Generator) -> Picture:
    return _noise(rng, (4, 8, 16, 32), rng.uniform(0.4, 0.7))


TEXTURES: dict[str, Callable[[np.random.Generator], Picture]] = {
    "checker": _checker,
    "noise": _cloud,
    "stripes": _stripes,
    "wood": _wood,
}
