"""What fills the openings of a front: windows, shutters, balconies, doors, shop fronts, arcades."""

import math
from dataclasses import dataclass

import numpy as np

from panokit.synthetic.city import BuildingPlan
from panokit.synthetic.materials import (
    DARK_METAL,
    LIMESTONE,
    WHITE_PAINT,
    Color,
    Material,
    Texture,
)
from panokit.synthetic.shapes import Parts

REVEAL_M = 0.16
_LAMPLIGHT: tuple[Color, ...] = ((1.0, 0.62, 0.28), (1.0, 0.72, 0.42), (0.75, 0.85, 1.0))
_SHUTTERS: tuple[Color, ...] = ((0.04, 0.11, 0.07), (0.16, 0.22, 0.28), (0.2, 0.08, 0.04))
_DOORS: tuple[Color, ...] = ((0.1, 0.03, 0.02), (0.02, 0.07, 0.05), (0.03, 0.04, 0.1))
_AWNINGS: tuple[Color, ...] = ((0.35, 0.03, 0.03), (0.03, 0.14, 0.07), (0.03, 0.07, 0.2))
_STEP = Material(color=(0.4, 0.38, 0.34), roughness=0.9)


@dataclass(frozen=True, slots=True)
class Opening:
    """A hole in a front, in meters from its lower left corner.

    Attributes:
        left: Edge.
        bottom: Edge.
        right: Edge.
        top: Edge.
        kind: "window", "door", "shop" or "arcade".
    """

    left: float
    bottom: float
    right: float
    top: float
    kind: str

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Left, bottom, right and top."""
        return self.left, self.bottom, self.right, self.top


def fill_opening(
    front: Parts,
    plan: BuildingPlan,
    wall: Material,
    opening: Opening,
    rng: np.random.Generator,
    *,
    night: bool,
) -> None:
    """Add what belongs into an opening, and what hangs around it."""
    if opening.kind == "window":
        _window(front, plan, opening, rng, night=night)
    elif opening.kind == "door":
        _door(front, opening, rng)
    elif opening.kind == "shop":
        _shop_front(front, opening, rng, night=night)
    else:
        _arcade_bay(front, wall, opening, rng, night=night)


def _pane(
    front: Parts,
    material: Material,
    x: tuple[float, float],
    y: tuple[float, float],
    z: float,
    rng: np.random.Generator,
) -> None:
    """A pane of glass, a few millimeters out of true as they all are."""
    bend = rng.normal(0, 0.0035, 4)
    (x0, x1), (y0, y1) = x, y
    front.quads(
        material,
        [
            [x0, y0, z + bend[0]],
            [x1, y0, z + bend[1]],
            [x1, y1, z + bend[2]],
            [x0, y1, z + bend[3]],
        ],
    )


def _window(
    front: Parts, plan: BuildingPlan, opening: Opening, rng: np.random.Generator, *, night: bool
) -> None:
    left, bottom, right, top = opening.box
    z = -REVEAL_M
    frame = 0.06
    front.box(WHITE_PAINT, [left, bottom, z], [left + frame, top, z + 0.05], omit=("back",))
    front.box(WHITE_PAINT, [right - frame, bottom, z], [right, top, z + 0.05], omit=("back",))
    for y in (bottom, top - frame, bottom + 0.68 * (top - bottom)):
        front.box(WHITE_PAINT, [left, y, z], [right, y + frame, z + 0.05], omit=("back",))
    middle = (left + right) / 2
    front.box(
        WHITE_PAINT, [middle - 0.035, bottom, z], [middle + 0.035, top, z + 0.05], omit=("back",)
    )
    _pane(front, _room(rng, night=night), (left, right), (bottom, top), z + 0.015, rng)
    front.box(
        LIMESTONE, [left - 0.12, bottom - 0.09, -0.02], [right + 0.12, bottom, 0.1], omit=("back",)
    )
    if plan.shutters and opening.bottom > plan.ground_floor_m:
        _shutters(front, plan, opening)
    elif opening.bottom > plan.ground_floor_m and rng.random() < plan.balconies:
        _balcony(front, opening)
    elif plan.wall in ("stone", "brick"):
        front.box(
            LIMESTONE, [left - 0.1, top, -0.02], [right + 0.1, top + 0.18, 0.06], omit=("back",)
        )


def _room(rng: np.random.Generator, *, night: bool) -> Material:
    """What is behind a pane: a dark room or net curtains, by night perhaps a lamp."""
    curtain = Texture(
        pattern="curtain",
        width_px=96,
        height_px=128,
        seed=int(rng.integers(8)),
        color=(0.2, 0.19, 0.17),
        width_m=1.2,
        height_m=1.7,
    )
    dark = Material(color=(0.012, 0.013, 0.015), roughness=0.02, kind="glass")
    veiled = Material(texture=curtain, roughness=0.03, kind="glass")
    if rng.random() < 0.42 and night:
        lamp = _LAMPLIGHT[int(rng.integers(len(_LAMPLIGHT)))]
        strength = float(rng.choice([0.5, 1.4]))
        return veiled.lit((lamp[0] * strength, lamp[1] * strength, lamp[2] * strength))
    return dark if rng.random() < 0.5 else veiled


def _shutters(front: Parts, plan: BuildingPlan, opening: Opening) -> None:
    left, bottom, right, top = opening.box
    color = _SHUTTERS[plan.seed % len(_SHUTTERS)]
    paint = Material(color=color, roughness=0.6)
    wide = (right - left) / 2
    for x0 in (left - wide - 0.03, right + 0.03):
        front.box(paint, [x0, bottom, 0.0], [x0 + wide, top, 0.035], omit=("back",))
        for y in np.arange(bottom + 0.08, top - 0.08, 0.075).tolist():
            front.box(
                paint, [x0 + 0.06, y, 0.035], [x0 + wide - 0.06, y + 0.035, 0.055], omit=("back",)
            )


def _balcony(front: Parts, opening: Opening) -> None:
    left, bottom, right, _ = opening.box
    x0, x1, y, deep = left - 0.35, right + 0.35, bottom - 0.45, 0.8
    front.box(LIMESTONE, [x0, y - 0.14, 0], [x1, y, deep], omit=("back",))
    for height in (0.06, 0.95):
        front.box(DARK_METAL, [x0, y + height, deep - 0.05], [x1, y + height + 0.04, deep - 0.01])
        for x in (x0, x1 - 0.04):
            front.box(DARK_METAL, [x, y + height, 0], [x + 0.04, y + height + 0.04, deep - 0.01])
    for x in np.arange(x0, x1, 0.13).tolist():
        front.box(
            DARK_METAL, [x, y + 0.06, deep - 0.04], [x + 0.018, y + 0.95, deep - 0.02],
            omit=("top", "bottom"),
        )  # fmt: skip


def _door(front: Parts, opening: Opening, rng: np.random.Generator) -> None:
    left, bottom, right, top = opening.box
    color = _DOORS[int(rng.integers(len(_DOORS)))]
    paint = Material(color=color, roughness=0.35, clearcoat=0.3)
    z = -REVEAL_M
    front.panel(paint, (left, right), (bottom, top - 0.45), z)
    for x0, x1 in ((left + 0.12, left + 0.5), (right - 0.5, right - 0.12)):
        for y0, y1 in ((0.25, 0.85), (1.0, 1.8)):
            front.box(paint, [x0, y0, z], [x1, y1, z + 0.03], omit=("back",))
    glass = Material(color=(0.015, 0.015, 0.015), roughness=0.02, kind="glass")
    _pane(front, glass, (left, right), (top - 0.42, top), z + 0.01, rng)
    front.box(WHITE_PAINT, [left, top - 0.48, z], [right, top - 0.42, z + 0.05], omit=("back",))
    front.box(_STEP, [left - 0.15, 0, 0], [right + 0.15, 0.16, 0.32], omit=("back",))
    for x in (left - 0.16, right):
        front.box(LIMESTONE, [x, 0, 0], [x + 0.16, top + 0.1, 0.05], omit=("back",))
    front.box(LIMESTONE, [left - 0.2, top, 0], [right + 0.2, top + 0.2, 0.09], omit=("back",))


def _shop_front(front: Parts, opening: Opening, rng: np.random.Generator, *, night: bool) -> None:
    left, bottom, right, top = opening.box
    goods = _shop_window(rng, night=night, lit_share=0.75)
    sign_y = top - 0.02
    _pane(front, goods, (left, right), (bottom, sign_y), -REVEAL_M, rng)
    wood = Material(color=_AWNINGS[int(rng.integers(len(_AWNINGS)))], roughness=0.4)
    for x in (left, right - 0.07, (left + right) / 2 - 0.03):
        front.box(wood, [x, bottom, -REVEAL_M], [x + 0.07, top, -REVEAL_M + 0.07], omit=("back",))
    front.box(wood, [left, bottom, -REVEAL_M], [right, bottom + 0.12, 0.04], omit=("back",))
    front.box(wood, [left - 0.1, top, 0], [right + 0.1, top + 0.52, 0.09], omit=("back",))
    front.box(
        WHITE_PAINT, [left + 0.35, top + 0.17, 0.09], [right - 0.35, top + 0.34, 0.1],
        omit=("back",),
    )  # fmt: skip
    if rng.random() < 0.45:
        _awning(front, wood.color, left - 0.1, right + 0.1, top)


def _shop_window(rng: np.random.Generator, *, night: bool, lit_share: float) -> Material:
    """A pane before the inside of a shop, dim by day and perhaps lit by night."""
    lit = night and rng.random() < lit_share
    shade = 0.9 if lit else 0.4
    inside = Texture(
        pattern="shop", width_px=768, height_px=512, seed=int(rng.integers(16)),
        color=(shade, shade, shade), width_m=3.0,
    )  # fmt: skip
    goods = Material(texture=inside, roughness=0.02, kind="glass")
    return goods.lit((2.4, 1.95, 1.35)) if lit else goods


def _awning(front: Parts, color: Color, left: float, right: float, y: float) -> None:
    cloth = Material(
        roughness=0.95,
        texture=Texture(
            pattern="stripes", width_px=256, height_px=64, color=color, width_m=right - left
        ),
    )
    deep = 1.1
    front.quads(
        cloth, [[left, y - 0.5, deep], [right, y - 0.5, deep], [right, y, 0.1], [left, y, 0.1]]
    )
    front.panel(cloth, (left, right), (y - 0.72, y - 0.5), deep)


def _arcade_bay(
    front: Parts, wall: Material, opening: Opening, rng: np.random.Generator, *, night: bool
) -> None:
    """A deep bay of an arcade: shop window at the back, half-round head."""
    left, bottom, right, top = opening.box
    middle, radius = (left + right) / 2, (right - left) / 2
    angle = np.linspace(0, math.pi, 17)
    arc = np.stack([middle - radius * np.cos(angle), top - radius + radius * np.sin(angle)], 1)
    roof = np.stack([arc[:, 0], np.full(17, top)], 1)
    flat = np.zeros((17, 1))
    front.grid(wall, np.stack([np.hstack([arc, flat]), np.hstack([roof, flat])]))
    soffit = np.stack([np.hstack([arc, flat - 2.2]), np.hstack([arc, flat])])
    front.grid(Material(color=LIMESTONE.color, roughness=0.9), soffit)
    goods = _shop_window(rng, night=night, lit_share=1.0)
    _pane(front, goods, (left, right), (bottom, top), -2.1, rng)
    front.box(WHITE_PAINT, [left, 2.3, -2.1], [right, 2.4, -2.04], omit=("back",))
