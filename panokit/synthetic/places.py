"""Plans for the kinds of place: old town, boulevard, square, residential street, waterfront."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from panokit.synthetic.city import BuildingPlan, GroundPlan, PlaceKind, PlacePlan, Thing, Wall
from panokit.synthetic.materials import Color

_ASPHALT: Color = (0.075, 0.075, 0.078)
_SLABS: Color = (0.30, 0.285, 0.26)
_SETTS: Color = (0.2, 0.185, 0.165)
_PAINT: Color = (0.62, 0.62, 0.58)
_LAWN: Color = (0.07, 0.12, 0.025)

_PASTELS: tuple[Color, ...] = (
    (0.58, 0.40, 0.20), (0.55, 0.22, 0.13), (0.62, 0.52, 0.33), (0.36, 0.42, 0.40),
    (0.60, 0.36, 0.27), (0.66, 0.61, 0.50), (0.50, 0.45, 0.19), (0.34, 0.40, 0.50),
)  # fmt: skip
_BRICKS: tuple[Color, ...] = ((0.33, 0.12, 0.07), (0.26, 0.10, 0.07), (0.38, 0.21, 0.12))
_STONES: tuple[Color, ...] = ((0.50, 0.44, 0.34), (0.46, 0.43, 0.38), (0.55, 0.50, 0.42))
_GREYS: tuple[Color, ...] = ((0.36, 0.36, 0.36), (0.5, 0.5, 0.49), (0.25, 0.27, 0.29))
_PAINTS: tuple[Color, ...] = (
    (0.45, 0.45, 0.47), (0.02, 0.02, 0.025), (0.6, 0.6, 0.58), (0.30, 0.02, 0.02),
    (0.02, 0.05, 0.16), (0.12, 0.13, 0.14), (0.03, 0.12, 0.08), (0.5, 0.32, 0.04),
)  # fmt: skip
_COLORS: dict[Wall, tuple[Color, ...]] = {
    "plaster": _PASTELS, "brick": _BRICKS, "stone": _STONES, "concrete": _GREYS
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class _Style:
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


_OLD = _Style(
    walls=("plaster", "plaster", "plaster", "stone"), width_m=(6, 10.5), floors=(2, 4),
    shops=0.45, shutters=0.6, balconies=0.12, pitched=0.9, bay_m=(2.2, 2.7), window_m=(1.0, 1.55),
)  # fmt: skip
_GRAND = _Style(
    walls=("stone", "stone", "brick", "plaster"), width_m=(14, 24), floors=(4, 6),
    shops=0.85, balconies=0.45, pitched=0.6, window_m=(1.25, 2.0), ground_floor_m=(4.2, 4.8),
)  # fmt: skip
_CIVIC = _Style(
    walls=("stone", "plaster", "brick"), width_m=(11, 19), floors=(2, 4), shops=0.4,
    arcades=0.45, shutters=0.2, balconies=0.15, pitched=0.8, window_m=(1.2, 1.9),
)  # fmt: skip
_HOUSES = _Style(
    walls=("brick", "plaster", "brick"), width_m=(8, 11), floors=(1, 2), shops=0.0,
    ground_floor_m=(3.0, 3.3), floor_m=(2.8, 3.0), window_m=(1.4, 1.4), pitched=1.0, gap_m=3.5,
)  # fmt: skip
_HARBOR = _Style(
    walls=("plaster", "brick", "plaster"), width_m=(7, 12), floors=(2, 5), shops=0.6,
    shutters=0.35, balconies=0.3, pitched=0.8,
)  # fmt: skip


def plan_place(kind: PlaceKind, seed: int) -> PlacePlan:
    """The plan of a place; the same for the same kind and seed."""
    rng = np.random.default_rng([seed, list(_PLANNERS).index(kind)])
    plan = _PLANNERS[kind](rng)
    return replace(plan, kind=kind, seed=seed)


def _pick(rng: np.random.Generator, choices: tuple[Color, ...]) -> Color:
    shade = rng.uniform(0.8, 1.15)
    red, green, blue = choices[int(rng.integers(len(choices)))]
    return (min(red * shade, 0.8), min(green * shade, 0.8), min(blue * shade, 0.8))


def _row(
    rng: np.random.Generator,
    style: _Style,
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
                color=_pick(rng, _COLORS[wall]),
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


def _both_sides(
    rng: np.random.Generator, style: _Style, half_width_m: float, half_length_m: float
) -> list[BuildingPlan]:
    """Two rows along a street, and a row across each end that closes the view."""
    length = 2 * half_length_m
    end = half_length_m + 14
    return [
        *_row(rng, style, (half_width_m, -half_length_m), -math.pi / 2, length),
        *_row(rng, style, (-half_width_m, half_length_m), math.pi / 2, length),
        *_row(rng, style, (-45, -end), 0.0, 90),
        *_row(rng, style, (45, end), math.pi, 90),
    ]


def _parked(
    rng: np.random.Generator, x_m: float, turn: float, half_length_m: float, share: float
) -> list[Thing]:
    cars = []
    for z in np.arange(-half_length_m, half_length_m, 6.2):
        if rng.random() < share:
            cars.append(
                Thing(
                    kind="car",
                    x_m=x_m + float(rng.normal(0, 0.08)),
                    z_m=float(z + rng.normal(0, 0.3)),
                    turn=turn + float(rng.normal(0, 0.015)) + math.pi * int(rng.random() < 0.3),
                    color=_pick(rng, _PAINTS),
                    seed=int(rng.integers(1 << 31)),
                )
            )
    return cars


def _line(kind: str, xs: tuple[float, ...], step_m: float, half_length_m: float, **more: float):  # noqa: ANN202
    shift = more.pop("shift_m", 0.0)
    return [
        Thing(kind=kind, x_m=x, z_m=float(z) + shift, seed=index, **more)  # type: ignore[arg-type]
        for index, z in enumerate(np.arange(-half_length_m, half_length_m + 1, step_m))
        for x in xs
    ]


def _trees(
    rng: np.random.Generator, xs: tuple[float, ...], step_m: float, half_length_m: float
) -> list[Thing]:
    return [
        Thing(
            kind="tree",
            x_m=x + float(rng.normal(0, 0.15)),
            z_m=float(z + step_m / 2 + rng.normal(0, 0.5)),
            height_m=float(rng.uniform(6.5, 10)),
            seed=int(rng.integers(6)),
            turn=float(rng.uniform(0, 6.28)),
        )
        for z in np.arange(-half_length_m, half_length_m, step_m)
        for x in xs
    ]


def _blank(camera: tuple[float, float, float], azimuth_deg: float, rig: str) -> PlacePlan:
    return PlacePlan(
        kind="square", seed=0, street_azimuth_deg=azimuth_deg, camera_m=camera,
        rig=rig, ground=(), buildings=(), things=(),  # type: ignore[arg-type]
    )  # fmt: skip


_FAR = 400.0


def _old_town(rng: np.random.Generator) -> PlacePlan:
    half = float(rng.uniform(3.6, 4.6))
    ground = [
        GroundPlan(surface="cobbles", x_m=(-_FAR, _FAR), z_m=(-_FAR, _FAR), color=_SETTS),
        GroundPlan(
            surface="paving", x_m=(-half, -half + 1.1), z_m=(-70, 70), y_m=0.08, color=_SLABS
        ),
        GroundPlan(surface="paving", x_m=(half - 1.1, half), z_m=(-70, 70), y_m=0.08, color=_SLABS),
    ]
    things = [
        *_line("lamp", (-half + 0.45,), 17, 60, height_m=4.2, turn=-math.pi / 2, shift_m=5),
        *_line("bollard", (half - 1.3,), 3.1, 40, height_m=0.9),
        *_parked(rng, half - 2.4, 0.0, 50, 0.12),
        *_line("bin", (-half + 0.6,), 23, 46, height_m=0.9, shift_m=2),
    ]
    plan = _blank((float(rng.uniform(-0.6, 0.3)), 1.75, 0.0), float(rng.uniform(0, 360)), "tripod")
    buildings = _both_sides(rng, _OLD, half, 70)
    clear = [t for t in things if abs(t.z_m) > 2.5 or t.kind == "lamp"]
    return replace(plan, ground=tuple(ground), buildings=tuple(buildings), things=tuple(clear))


def _boulevard(rng: np.random.Generator) -> PlacePlan:
    half = float(rng.uniform(13, 15))
    kerb = half - 5.5
    ground = [
        GroundPlan(surface="asphalt", x_m=(-_FAR, _FAR), z_m=(-_FAR, _FAR), color=_ASPHALT),
        *(
            GroundPlan(surface="paving", x_m=side, z_m=(-110, 110), y_m=0.13, color=_SLABS)
            for side in ((-half, -kerb), (kerb, half))
        ),
        *_dashes(0.0, 110),
        *(
            GroundPlan(surface="paint", x_m=(x, x + 0.1), z_m=(-110, 110), y_m=0.004, color=_PAINT)
            for x in (-kerb + 2.2, kerb - 2.3)
        ),
        *_crossing(-17.0, kerb - 2.3),
    ]
    things = [
        *_parked(rng, kerb - 1.15, 0.0, 100, 0.75),
        *_parked(rng, -kerb + 1.15, math.pi, 100, 0.75),
        *_trees(rng, (-kerb - 1.1, kerb + 1.1), float(rng.uniform(9, 12)), 100),
        *_line("lamp", (-kerb - 0.5,), 28, 98, height_m=8.0, turn=-math.pi / 2, y_m=0.13),
        *_line("lamp", (kerb + 0.5,), 28, 98, height_m=8.0, turn=math.pi / 2, shift_m=14, y_m=0.13),
        *_line("bench", (kerb + 2.4,), 21, 84, turn=math.pi / 2, shift_m=4, y_m=0.13),
    ]
    plan = _blank((1.9, 2.5, 0.0), float(rng.uniform(0, 360)), "car")
    buildings = _both_sides(rng, _GRAND, half, 110)
    things = [t for t in things if t.kind != "car" or not -20 < t.z_m < -11]
    return replace(plan, ground=tuple(ground), buildings=tuple(buildings), things=tuple(things))


def _dashes(x_m: float, half_length_m: float) -> list[GroundPlan]:
    return [
        GroundPlan(
            surface="paint", x_m=(x_m - 0.07, x_m + 0.07), z_m=(z, z + 3), y_m=0.004, color=_PAINT
        )
        for z in np.arange(-half_length_m, half_length_m, 9.0).tolist()
    ]


def _crossing(z_m: float, half_width_m: float) -> list[GroundPlan]:
    return [
        GroundPlan(surface="paint", x_m=(x, x + 0.5), z_m=(z_m, z_m + 3.5), y_m=0.006, color=_PAINT)
        for x in np.arange(-half_width_m + 0.3, half_width_m - 0.5, 1.0).tolist()
    ]


def _square(rng: np.random.Generator) -> PlacePlan:
    half = float(rng.uniform(19, 24))
    ground = [
        GroundPlan(surface="paving", x_m=(-_FAR, _FAR), z_m=(-_FAR, _FAR), color=(0.36, 0.33, 0.28)),
        GroundPlan(surface="cobbles", x_m=(-half + 5, half - 5), z_m=(-half + 5, half - 5),
                   y_m=0.003, color=_SETTS),
        GroundPlan(surface="paving", x_m=(-2, 2), z_m=(-half, half), y_m=0.006, color=(0.42, 0.39, 0.33)),
        GroundPlan(surface="paving", x_m=(-half, half), z_m=(-2, 2), y_m=0.007, color=(0.42, 0.39, 0.33)),
    ]  # fmt: skip
    # Each side leaves a street open at one corner.
    sides = [
        *_row(rng, _CIVIC, (-half, -half), 0.0, 2 * half - 7),
        *_row(rng, _CIVIC, (half, -half), -math.pi / 2, 2 * half - 7),
        *_row(rng, _CIVIC, (half, half), math.pi, 2 * half - 7),
        *_row(rng, _CIVIC, (-half, half), math.pi / 2, 2 * half - 7),
    ]
    behind = [
        *_row(rng, _OLD, (-90, -half - 45), 0.0, 180),
        *_row(rng, _OLD, (90, half + 45), math.pi, 180),
        *_row(rng, _OLD, (half + 45, -90), -math.pi / 2, 180),
        *_row(rng, _OLD, (-half - 45, 90), math.pi / 2, 180),
    ]
    lamps = [
        Thing(kind="lamp", x_m=x, z_m=z, height_m=4.6, turn=turn)
        for x, z, turn in ((-9, -9, 0.8), (9, -9, 2.4), (-9, 9, -0.8), (9, 9, -2.4))
    ]
    things = [
        Thing(kind="fountain", x_m=-3.5, z_m=-7.0, height_m=2.6),
        *lamps,
        *(Thing(kind="bench", x_m=x, z_m=-4, turn=0.0) for x in (6.0, 9.0, -8.5)),
        *(
            Thing(kind="tree", x_m=x, z_m=z, height_m=float(rng.uniform(5.5, 7.5)), seed=i)
            for i, (x, z) in enumerate(((-13, -11), (-13, 1), (-13, 12), (13, 12), (13, 3)))
        ),
        *_parked(rng, half - 3.2, 0.0, 20, 0.5),
    ]
    plan = _blank((1.5, 1.7, 1.5), float(rng.uniform(0, 360)), "tripod")
    return replace(plan, ground=tuple(ground), buildings=(*sides, *behind), things=tuple(things))


def _residential(rng: np.random.Generator) -> PlacePlan:
    half, kerb = 11.0, 4.2
    ground = [
        GroundPlan(surface="grass", x_m=(-_FAR, _FAR), z_m=(-_FAR, _FAR), y_m=-0.004, color=_LAWN),
        GroundPlan(surface="asphalt", x_m=(-kerb, kerb), z_m=(-140, 140), color=_ASPHALT),
        *(
            GroundPlan(surface="paving", x_m=side, z_m=(-140, 140), y_m=0.12, color=_SLABS)
            for side in ((-kerb - 1.9, -kerb), (kerb, kerb + 1.9))
        ),
    ]
    fronts = _both_sides(rng, _HOUSES, half, 110)
    # A path to every other door, so that the gardens look used.
    paths = [
        GroundPlan(surface="paving", x_m=side, z_m=(z, z + 1.2), y_m=0.02, color=(0.34, 0.30, 0.25))
        for z in np.arange(-100, 100, 12.0).tolist()
        for side in ((-half, -kerb - 1.9), (kerb + 1.9, half))
    ]
    things = [
        *_parked(rng, kerb - 1.1, 0.0, 100, 0.45),
        *_parked(rng, -kerb + 1.1, math.pi, 100, 0.3),
        *_trees(rng, (-kerb - 3.0, kerb + 3.4), 13, 100),
        *_line("lamp", (kerb + 0.4,), 30, 90, height_m=6.0, turn=math.pi / 2, shift_m=8, y_m=0.12),
        *_line("hedge", (-kerb - 2.3, kerb + 2.3), 12, 96, height_m=8.6, shift_m=5.2),
    ]
    plan = _blank((-0.4, 2.45, 1.0), float(rng.uniform(0, 360)), "car")
    return replace(plan, ground=(*ground, *paths), buildings=tuple(fronts), things=tuple(things))


def _waterfront(rng: np.random.Generator) -> PlacePlan:
    front, quay = 12.0, -8.0
    ground = [
        GroundPlan(surface="water", x_m=(-900, quay), z_m=(-900, 900), y_m=-1.6, color=(0.02, 0.05, 0.05)),
        GroundPlan(surface="cobbles", x_m=(quay, _FAR), z_m=(-_FAR, _FAR), color=_SETTS),
        GroundPlan(surface="paving", x_m=(quay, quay + 1.4), z_m=(-_FAR, _FAR), y_m=0.06, color=_SLABS),
        GroundPlan(surface="asphalt", x_m=(3.0, 8.6), z_m=(-150, 150), y_m=0.002, color=_ASPHALT),
        GroundPlan(surface="paving", x_m=(8.6, front), z_m=(-150, 150), y_m=0.13, color=_SLABS),
    ]  # fmt: skip
    buildings = [
        *_row(rng, _HARBOR, (front, -150), -math.pi / 2, 300),
        # The town across the water.
        *_row(rng, _HARBOR, (-150, 120), math.pi / 2, 240),
        *_row(rng, _HARBOR, (-128, -150), 0.0, 118),
    ]
    things = [
        *_line("lamp", (quay + 2.0,), 22, 110, height_m=5.2, turn=math.pi / 2, shift_m=6),
        *_line("bollard", (quay + 0.7,), 11, 99, height_m=0.6, shift_m=2, y_m=0.06),
        *_line("bench", (quay + 3.1,), 22, 88, turn=math.pi / 2, shift_m=-2),
        *_parked(rng, 7.5, 0.0, 90, 0.5),
        *(
            Thing(kind="boat", x_m=quay - float(rng.uniform(2.4, 3.2)), z_m=z, turn=math.pi / 2,
                  height_m=float(rng.uniform(6, 9)), color=_pick(rng, _PAINTS), y_m=-1.6)
            for z in (-34.0, -19.5, -6.0, 9.0, 24.0)
        ),
    ]  # fmt: skip
    plan = _blank((-5.4, 1.75, 0.5), float(rng.uniform(0, 360)), "tripod")
    return replace(plan, ground=tuple(ground), buildings=tuple(buildings), things=tuple(things))


_PLANNERS: dict[PlaceKind, Callable[[np.random.Generator], PlacePlan]] = {
    "old-town": _old_town,
    "boulevard": _boulevard,
    "square": _square,
    "residential": _residential,
    "waterfront": _waterfront,
}
