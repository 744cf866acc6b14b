"""Rows of buildings: what the fronts of a kind of street have in common, and what they do not."""

import math
from dataclasses import dataclass

import numpy as np

from panokit.synthetic.city import BuildingPlan, Wall
from panokit.synthetic.materials import Color

_PASTELS: tuple[Color, ...] = (
    (0.58, 0.40, 0.20), (0.55, 0.22, 0.13), (0.62, 0.52, 0.33), (0.36, 0.42, 0.40),
    (0.60, 0.36, 0.27), (0.66, 0.61, 0.50), (0.50, 0.45, 0.19), (0.34, 0.40, 0.50),
)  # fmt: skip
_BRICKS: tuple[Color, ...] = ((0.33, 0.12, 0.07), (0.26, 0.10, 0.07), (0.38, 0.21, 0.12))
_STONES: tuple[Color, ...] = ((0.50, 0.44, 0.34), (0.46, 0.43, 0.38), (0.55, 0.50, 0.42))
_GREYS: tuple[Color, ...] = ((0.36, 0.36, 0.36), (0.5, 0.5, 0.49), (0.25, 0.27, 0.29))
_COLORS: dict[Wall, tuple[Color, ...]] = {
    "plaster": _PASTELS, "brick": _BRICKS, "stone": _STONES, "concrete": _GREYS
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class RowStyle:
    """What the buildings of a row have in common; pairs are from and to."""

    walls: tuple[Wall, ...]
    width_m: tuple[float, float]
    floors: tuple[int, int]
    floor_m: tuple[float, float] = (3.0, 3.4)
    ground_floor_m: tuple[float, float] = (3.6, 4.2)
    bay_m: tuple[float, float] = (2.4, 3.0)
    window_m: tuple[float, float] = (1.1, 1.7)
    shops: float = 0.5
    arcades: float = 0.0
    shutters: float = 0.0
    balconies: float = 0.0
    pitched: float = 0.5
    gap_m: float = 0.0


OLD_TOWN = RowStyle(
    walls=("plaster", "plaster", "plaster", "stone"), width_m=(6, 10.5), floors=(2, 4),
    shops=0.45, shutters=0.6, balconies=0.12, pitched=0.9, bay_m=(2.2, 2.7), window_m=(1.0, 1.55),
)  # fmt: skip
GRAND = RowStyle(
    walls=("stone", "stone", "brick", "plaster"), width_m=(14, 24), floors=(4, 6),
    shops=0.85, balconies=0.45, pitched=0.6, window_m=(1.25, 2.0), ground_floor_m=(4.2, 4.8),
)  # fmt: skip
CIVIC = RowStyle(
    walls=("stone", "plaster", "brick"), width_m=(11, 19), floors=(2, 4), shops=0.4,
    arcades=0.45, shutters=0.2, balconies=0.15, pitched=0.8, window_m=(1.2, 1.9),
)  # fmt: skip
HOUSES = RowStyle(
    walls=("brick", "plaster", "brick"), width_m=(8, 11), floors=(1, 2), shops=0.0,
    ground_floor_m=(3.0, 3.3), floor_m=(2.8, 3.0), window_m=(1.4, 1.4), pitched=1.0, gap_m=3.5,
)  # fmt: skip
HARBOR = RowStyle(
    walls=("plaster", "brick", "plaster"), width_m=(7, 12), floors=(2, 5), shops=0.6,
    shutters=0.35, balconies=0.3, pitched=0.8,
)  # fmt: skip


def pick_color(rng: np.random.Generator, choices: tuple[Color, ...]) -> Color:
    """One of some colors, a little lighter or darker."""
    shade = rng.uniform(0.8, 1.15)
    red, green, blue = choices[int(rng.integers(len(choices)))]
    return (min(red * shade, 0.8), min(green * shade, 0.8), min(blue * shade, 0.8))


def row_of_buildings(
    rng: np.random.Generator,
    style: RowStyle,
    start: tuple[float, float],
    right_turn: float,
    length_m: float,
) -> list[BuildingPlan]:
    """Fronts side by side; `start` is the (x, z) of the left end as seen from the street."""
    buildings: list[BuildingPlan] = []
    reached = 0.0
    while reached < length_m - style.width_m[0] / 2:
        width = min(float(rng.uniform(*style.width_m)), length_m - reached)
        wall = style.walls[int(rng.integers(len(style.walls)))]
        chance = rng.random()
        ground = "arcade" if chance < style.arcades else "home"
        if style.arcades <= chance < style.arcades + style.shops:
            ground = "shop"
        setback = float(rng.uniform(0, 0.25))
        along = math.cos(right_turn), -math.sin(right_turn)
        back = along[1], -along[0]
        buildings.append(
            BuildingPlan(
                left_x_m=start[0] + along[0] * reached + back[0] * setback,
                left_z_m=start[1] + along[1] * reached + back[1] * setback,
                right_turn=right_turn,
                width_m=width,
                depth_m=float(rng.uniform(9, 13)),
                floors=int(rng.integers(style.floors[0], style.floors[1] + 1)),
                ground_floor_m=float(rng.uniform(*style.ground_floor_m)),
                floor_m=float(rng.uniform(*style.floor_m)),
                wall=wall,
                color=pick_color(rng, _COLORS[wall]),
                bay_m=float(rng.uniform(*style.bay_m)),
                window_m=style.window_m,
                ground=ground,  # type: ignore[arg-type]
                shutters=bool(rng.random() < style.shutters),
                balconies=style.balconies * float(rng.random() < 0.6),
                pitched=bool(rng.random() < style.pitched),
                seed=int(rng.integers(1 << 31)),
            )
        )
        reached += width + style.gap_m * float(rng.uniform(0.6, 1.6))
    return buildings


def both_sides(
    rng: np.random.Generator, style: RowStyle, half_width_m: float, half_length_m: float
) -> list[BuildingPlan]:
    """Two rows along a street, and a row across each end that closes the view."""
    length = 2 * half_length_m
    end = half_length_m + 14
    return [
        *row_of_buildings(rng, style, (half_width_m, -half_length_m), -math.pi / 2, length),
        *row_of_buildings(rng, style, (-half_width_m, half_length_m), math.pi / 2, length),
        *row_of_buildings(rng, style, (-45, -end), 0.0, 90),
        *row_of_buildings(rng, style, (45, end), math.pi, 90),
    ]
