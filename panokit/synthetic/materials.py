"""What things are made of, as data: the renderer's part turns it into shaders."""

from dataclasses import dataclass, replace
from typing import Literal

Color = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Texture:
    """A recipe for a picture on a surface; `textures.paint` follows it.

    Attributes:
        pattern: Its name in the table of `textures`.
        width_px: Of the picture.
        height_px: Of the picture.
        seed: For its random parts.
        color: The main color, linear Rec.709 reflectance.
        width_m: What the picture's width is on the surface.
        height_m: What the picture's height is on the surface.
        marks: Rectangles (left, bottom, right, top) in meters that the pattern may mind, such
            as windows under which rain leaves streaks.
    """

    pattern: str
    width_px: int = 512
    height_px: int = 512
    seed: int = 0
    color: Color = (0.5, 0.5, 0.5)
    width_m: float = 4.0
    height_m: float = 4.0
    marks: tuple[tuple[float, float, float, float], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """A surface.

    Attributes:
        color: Linear Rec.709 reflectance; ignored where there is a texture.
        texture: The picture on it.
        roughness: 0 is a mirror, 1 is chalk.
        metallic: 0 or 1.
        clearcoat: Car paint has one.
        kind: "solid", "glass" (a pane in front of a dark room) or "water".
        smooth: Vertex normals are interpolated.
        glow: Radiance that it sends out, for lamps and lit windows; None for none. A texture
            multiplies it.
    """

    color: Color = (0.5, 0.5, 0.5)
    texture: Texture | None = None
    roughness: float = 0.8
    metallic: float = 0.0
    clearcoat: float = 0.0
    kind: Literal["solid", "glass", "water"] = "solid"
    smooth: bool = False
    glow: Color | None = None

    def lit(self, glow: Color) -> "Material":
        """The same surface, sending out light."""
        return replace(self, glow=glow)


WHITE_PAINT = Material(color=(0.75, 0.74, 0.7), roughness=0.5)
DARK_METAL = Material(color=(0.03, 0.032, 0.035), roughness=0.4)
STEEL = Material(color=(0.45, 0.46, 0.47), roughness=0.35, metallic=1.0, smooth=True)
LIMESTONE = Material(color=(0.55, 0.5, 0.42), roughness=0.85)
RUBBER = Material(color=(0.015, 0.015, 0.016), roughness=0.9)
DARK_GLASS = Material(color=(0.012, 0.014, 0.016), roughness=0.02, kind="glass")
