"""Plans for the kinds of place: old town, boulevard, square, residential street, waterfront."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from panokit.synthetic.city import GroundPlan, PlaceKind, PlacePlan, Thing, ThingKind
from panokit.synthetic.materials import Color
from panokit.synthetic.rows import (
    CIVIC,
    GRAND,
    HARBOR,
    HOUSES,
    OLD_TOWN,
    both_sides,
    pick_color,
    row_of_buildings,
)

_ASPHALT: Color = (0.075, 0.075, 0.078)
_SLABS: Color = (0.30, 0.285, 0.26)
_SETTS: Color = (0.2, 0.185, 0.165)
_PAINT: Color = (0.62, 0.62, 0.58)
_LAWN: Color = (0.07, 0.12, 0.025)

_PAINTS: tuple[Color, ...] = (
    (0.45, 0.45, 0.47), (0.02, 0.02, 0.025), (0.6, 0.6, 0.58), (0.30, 0.02, 0.02),
    (0.02, 0.05, 0.16), (0.12, 0.13, 0.14), (0.03, 0.12, 0.08), (0.5, 0.32, 0.04),
)  # fmt: skip


def plan_place(kind: PlaceKind, seed: int) -> PlacePlan:
    """The plan of a place; the same for the same kind and seed."""
    rng = np.random.default_rng([seed, list(_PLANNERS).index(kind)])
    plan = _PLANNERS[kind](rng)
    return replace(plan, kind=kind, seed=seed)


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
                    color=pick_color(rng, _PAINTS),
                    seed=int(rng.integers(1 << 31)),
                )
            )
    return cars


def _line(
    kind: ThingKind,
    xs_m: tuple[float, ...],
    step_m: float,
    half_length_m: float,
    *,
    shift_m: float = 0.0,
    **more: float,
) -> list[Thing]:
    """Equal things at equal steps along the street, at each of some distances from its middle."""
    return [
        Thing(kind=kind, x_m=x, z_m=float(z) + shift_m, seed=index, **more)  # type: ignore[arg-type]
        for index, z in enumerate(np.arange(-half_length_m, half_length_m + 1, step_m))
        for x in xs_m
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
    buildings = both_sides(rng, OLD_TOWN, half, 70)
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
    buildings = both_sides(rng, GRAND, half, 110)
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
        GroundPlan(
            surface="paving", x_m=(-_FAR, _FAR), z_m=(-_FAR, _FAR), color=(0.36, 0.33, 0.28)
        ),
        GroundPlan(
            surface="cobbles",
            x_m=(-half + 5, half - 5),
            z_m=(-half + 5, half - 5),
            y_m=0.003,
            color=_SETTS,
        ),
        GroundPlan(
            surface="paving", x_m=(-2, 2), z_m=(-half, half), y_m=0.006, color=(0.42, 0.39, 0.33)
        ),
        GroundPlan(
            surface="paving", x_m=(-half, half), z_m=(-2, 2), y_m=0.007, color=(0.42, 0.39, 0.33)
        ),
    ]
    # Each side leaves a street open at one corner.
    sides = [
        *row_of_buildings(rng, CIVIC, (-half, -half), 0.0, 2 * half - 7),
        *row_of_buildings(rng, CIVIC, (half, -half), -math.pi / 2, 2 * half - 7),
        *row_of_buildings(rng, CIVIC, (half, half), math.pi, 2 * half - 7),
        *row_of_buildings(rng, CIVIC, (-half, half), math.pi / 2, 2 * half - 7),
    ]
    behind = [
        *row_of_buildings(rng, OLD_TOWN, (-90, -half - 45), 0.0, 180),
        *row_of_buildings(rng, OLD_TOWN, (90, half + 45), math.pi, 180),
        *row_of_buildings(rng, OLD_TOWN, (half + 45, -90), -math.pi / 2, 180),
        *row_of_buildings(rng, OLD_TOWN, (-half - 45, 90), math.pi / 2, 180),
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
    fronts = both_sides(rng, HOUSES, half, 110)
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
        GroundPlan(
            surface="water", x_m=(-900, quay), z_m=(-900, 900), y_m=-1.6, color=(0.02, 0.05, 0.05)
        ),
        GroundPlan(surface="cobbles", x_m=(quay, _FAR), z_m=(-_FAR, _FAR), color=_SETTS),
        GroundPlan(
            surface="paving", x_m=(quay, quay + 1.4), z_m=(-_FAR, _FAR), y_m=0.06, color=_SLABS
        ),
        GroundPlan(surface="asphalt", x_m=(3.0, 8.6), z_m=(-150, 150), y_m=0.002, color=_ASPHALT),
        GroundPlan(surface="paving", x_m=(8.6, front), z_m=(-150, 150), y_m=0.13, color=_SLABS),
    ]
    buildings = [
        *row_of_buildings(rng, HARBOR, (front, -150), -math.pi / 2, 300),
        # The town across the water.
        *row_of_buildings(rng, HARBOR, (-150, 120), math.pi / 2, 240),
        *row_of_buildings(rng, HARBOR, (-128, -150), 0.0, 118),
    ]
    things = [
        *_line("lamp", (quay + 2.0,), 22, 110, height_m=5.2, turn=math.pi / 2, shift_m=6),
        *_line("bollard", (quay + 0.7,), 11, 99, height_m=0.6, shift_m=2, y_m=0.06),
        *_line("bench", (quay + 3.1,), 22, 88, turn=math.pi / 2, shift_m=-2),
        *_parked(rng, 7.5, 0.0, 90, 0.5),
        *(
            Thing(
                kind="boat",
                x_m=quay - float(rng.uniform(2.4, 3.2)),
                z_m=z,
                turn=math.pi / 2,
                height_m=float(rng.uniform(6, 9)),
                color=pick_color(rng, _PAINTS),
                y_m=-1.6,
            )
            for z in (-34.0, -19.5, -6.0, 9.0, 24.0)
        ),
    ]
    plan = _blank((-5.4, 1.75, 0.5), float(rng.uniform(0, 360)), "tripod")
    return replace(plan, ground=tuple(ground), buildings=tuple(buildings), things=tuple(things))


_PLANNERS: dict[PlaceKind, Callable[[np.random.Generator], PlacePlan]] = {
    "old-town": _old_town,
    "boulevard": _boulevard,
    "square": _square,
    "residential": _residential,
    "waterfront": _waterfront,
}
