"""Buildings from their plans: walls with openings, trim, sides, roofs.

A front is built in its own frame: x right and y up as seen from the street, z out of the wall.
"""

import math

import numpy as np

from panokit.synthetic.city import BuildingPlan
from panokit.synthetic.fittings import REVEAL_M, Opening, fill_opening
from panokit.synthetic.materials import LIMESTONE, Material, Texture
from panokit.synthetic.shapes import Parts, Placement

_FINEST_WALL_PX_PER_M = 60.0


def build_building(parts: Parts, plan: BuildingPlan, *, night: bool) -> None:
    """Add a building to the heap."""
    rng = np.random.default_rng(plan.seed)
    front = parts.placed(Placement.standing(plan.left_x_m, plan.left_z_m, plan.right_turn))
    openings = _openings(plan, rng)
    wall = _wall_material(plan, openings)
    _wall_with_openings(front, wall, plan, openings)
    for opening in openings:
        fill_opening(front, plan, wall, opening, rng, night=night)
    _trim(front, plan, rng)
    _body(front, plan, wall)
    _roof(front, plan, rng)


def _openings(plan: BuildingPlan, rng: np.random.Generator) -> list[Opening]:
    bays = max(1, round(plan.width_m / plan.bay_m))
    centers = (np.arange(bays) + 0.5) * plan.width_m / bays
    width, height = plan.window_m
    found = []
    for floor in range(plan.floors):
        sill = plan.ground_floor_m + floor * plan.floor_m + 0.85
        tall = min(height * (1 - 0.04 * floor), plan.floor_m - 1.1)
        for x in centers.tolist():
            found.append(Opening(x - width / 2, sill, x + width / 2, sill + tall, "window"))
    top = plan.ground_floor_m - 0.75
    door_bay = int(rng.integers(bays))
    for bay, x in enumerate(centers.tolist()):
        half = plan.width_m / bays / 2
        if plan.ground == "arcade":
            found.append(Opening(x - half + 0.35, 0.0, x + half - 0.35, top, "arcade"))
        elif bay == door_bay:
            found.append(Opening(x - 0.55, 0.0, x + 0.55, 2.45, "door"))
        elif plan.ground == "shop":
            found.append(Opening(x - half + 0.22, 0.45, x + half - 0.22, top - 0.1, "shop"))
        else:
            found.append(Opening(x - width / 2, 1.0, x + width / 2, 1.0 + height * 0.9, "window"))
    return found


def _wall_material(plan: BuildingPlan, openings: list[Opening]) -> Material:
    windows = tuple(opening.box for opening in openings if opening.kind == "window")
    # No finer than the camera, which stands near the origin, can see.
    distance_m = max(5.0, math.hypot(plan.left_x_m, plan.left_z_m) - plan.width_m)
    px_per_m = min(_FINEST_WALL_PX_PER_M, 700 / distance_m)
    return Material(
        roughness=0.9,
        texture=Texture(
            pattern=plan.wall,
            width_px=int(plan.width_m * px_per_m),
            height_px=int(plan.height_m * px_per_m),
            seed=plan.seed % 9973,
            color=plan.color,
            width_m=plan.width_m,
            height_m=plan.height_m,
            marks=windows,
        ),
    )


def _wall_with_openings(
    front: Parts, wall: Material, plan: BuildingPlan, openings: list[Opening]
) -> None:
    boxes = np.array([opening.box for opening in openings])
    xs = np.unique(np.concatenate([[0, plan.width_m], boxes[:, 0], boxes[:, 2]]))
    ys = np.unique(np.concatenate([[0, plan.height_m], boxes[:, 1], boxes[:, 3]]))
    x = (xs[:-1] + xs[1:])[:, None] / 2
    y = (ys[:-1] + ys[1:])[None, :] / 2
    hole = np.zeros((len(xs) - 1, len(ys) - 1), bool)
    for left, bottom, right, top in boxes:
        hole |= (x > left) & (x < right) & (y > bottom) & (y < top)
    i, j = np.nonzero(~hole)
    corners = np.stack(
        [
            np.stack([xs[i + dx], ys[j + dy], np.zeros(len(i))], -1)
            for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1))
        ],
        axis=1,
    )
    front.quads(wall, corners, corners[..., :2] / [plan.width_m, plan.height_m])
    for opening in openings:
        _reveal(front, wall, plan, opening)


def _reveal(front: Parts, wall: Material, plan: BuildingPlan, opening: Opening) -> None:
    """The four inner sides of an opening."""
    left, bottom, right, top = opening.box
    deep = -2.2 if opening.kind == "arcade" else -REVEAL_M - 0.06
    ring = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
    nxt = np.roll(ring, -1, axis=0)
    quads = np.stack(
        [
            np.column_stack([ring, np.zeros(4)]),
            np.column_stack([nxt, np.zeros(4)]),
            np.column_stack([nxt, np.full(4, deep)]),
            np.column_stack([ring, np.full(4, deep)]),
        ],
        axis=1,
    )
    front.quads(wall, quads, quads[..., :2] / [plan.width_m, plan.height_m])


def _trim(front: Parts, plan: BuildingPlan, rng: np.random.Generator) -> None:
    """Plinth, string course, cornice, rain pipe."""
    width, eaves = plan.width_m, plan.height_m
    stone = LIMESTONE if plan.wall != "concrete" else Material(color=(0.4, 0.4, 0.4))
    y = plan.ground_floor_m
    front.box(stone, [0, y - 0.02, 0], [width, y + 0.16, 0.07], omit=("back", "left", "right"))
    for step in range(3):
        rise = 0.14 * step
        out = 0.1 + 0.11 * step
        front.box(stone, [0, eaves - 0.45 + rise, 0], [width, eaves - 0.31 + rise, out])
    pipe_x = 0.12 if rng.random() < 0.5 else width - 0.12
    front.tube(
        Material(color=(0.16, 0.15, 0.14), roughness=0.5, smooth=True),
        [[pipe_x, 0, 0.08], [pipe_x, eaves / 2, 0.08], [pipe_x, eaves - 0.4, 0.08]],
        0.055,
        8,
    )


def _body(front: Parts, plan: BuildingPlan, wall: Material) -> None:
    """The sides and the back."""
    width, deep, height = plan.width_m, plan.depth_m, plan.height_m
    front.quads(wall, [[0, 0, -deep], [0, 0, 0], [0, height, 0], [0, height, -deep]])
    front.quads(
        wall, [[width, 0, 0], [width, 0, -deep], [width, height, -deep], [width, height, 0]]
    )
    front.quads(
        wall, [[width, 0, -deep], [0, 0, -deep], [0, height, -deep], [width, height, -deep]]
    )


def _roof(front: Parts, plan: BuildingPlan, rng: np.random.Generator) -> None:
    width, deep, eaves = plan.width_m, plan.depth_m, plan.height_m
    if not plan.pitched:
        stone = Material(color=(0.35, 0.34, 0.32))
        front.box(stone, [0, eaves, -0.3], [width, eaves + 0.7, 0.1])
        front.box(stone, [0, eaves, -deep], [width, eaves + 0.1, -0.3])
        return
    color = ((0.32, 0.11, 0.06), (0.07, 0.075, 0.085), (0.24, 0.1, 0.06))[plan.seed % 3]
    tiles = Material(
        roughness=0.8,
        texture=Texture(pattern="tiles", seed=plan.seed % 7, color=color),
    )
    rise = deep / 2 * 0.75
    over = 0.35
    slope_m = math.hypot(deep / 2, rise)
    uv = np.array([[0, 0], [width, 0], [width, slope_m], [0, slope_m]]) / 4
    ridge = eaves + rise
    front.quads(
        tiles,
        [[0, eaves, over], [width, eaves, over], [width, ridge, -deep / 2], [0, ridge, -deep / 2]],
        uv,
    )
    front.quads(
        tiles,
        [
            [width, eaves, -deep],
            [0, eaves, -deep],
            [0, ridge, -deep / 2],
            [width, ridge, -deep / 2],
        ],
        uv,
    )
    gable = Material(color=tuple(0.9 * c for c in plan.color), roughness=0.9)  # type: ignore[arg-type]
    for x in (0.0, width):
        front.add(
            gable, [[x, eaves, 0], [x, eaves, -deep], [x, ridge, -deep / 2]], np.zeros((3, 2)),
            [[0, 1, 2]],
        )  # fmt: skip
    brick = Material(color=(0.25, 0.11, 0.07), roughness=0.9)
    x = float(rng.uniform(0.15, 0.85)) * width
    front.box(brick, [x, eaves, -deep * 0.45], [x + 0.7, ridge + 1.0, -deep * 0.45 + 0.6])
