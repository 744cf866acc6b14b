"""What stands in a street: trees, lamps, benches, bollards, hedges, a fountain."""

import numpy as np

from panokit.synthetic.city import GroundPlan, Thing
from panokit.synthetic.materials import (
    DARK_METAL,
    LIMESTONE,
    Color,
    Material,
    Texture,
)
from panokit.synthetic.shapes import Parts, Placement

SODIUM: Color = (1.0, 0.66, 0.30)
_LEAVES: tuple[Color, ...] = ((0.07, 0.14, 0.025), (0.10, 0.17, 0.03), (0.05, 0.10, 0.025))
_BARK = Material(color=(0.09, 0.07, 0.05), roughness=0.95, smooth=True)
_PLANKS = Material(color=(0.22, 0.12, 0.06), roughness=0.6)


def build_ground(parts: Parts, ground: GroundPlan) -> None:
    """Add a level rectangle, with kerbs where it is raised."""
    if ground.surface == "water":
        parts.floor(Material(color=ground.color, roughness=0.06, kind="water"),
                    ground.x_m, ground.z_m, ground.y_m)  # fmt: skip
        return
    if ground.surface == "paint":
        paint = Material(color=ground.color, roughness=0.7)
        parts.floor(paint, ground.x_m, ground.z_m, ground.y_m)
        return
    texture = Texture(
        pattern=ground.surface, width_px=1024, height_px=1024, seed=3, color=ground.color
    )
    surface = Material(texture=texture, roughness=0.9)
    parts.floor(surface, ground.x_m, ground.z_m, ground.y_m)
    if ground.y_m < 0.05:
        return
    kerb = Material(color=(0.33, 0.32, 0.3), roughness=0.85)
    (x0, x1), (z0, z1) = ground.x_m, ground.z_m
    for x in (x0, x1 - 0.14):
        parts.box(kerb, [x, -0.02, z0], [x + 0.14, ground.y_m + 0.003, z1], omit=("bottom",))


def build_tree(parts: Parts, tree: Thing) -> None:
    """Add a tree: a trunk, branches, and thousands of small leaves."""
    rng = np.random.default_rng(tree.seed)
    here = parts.placed(Placement.standing(tree.x_m, tree.z_m, tree.turn, tree.y_m))
    height = tree.height_m
    fork = 0.32 * height
    lean = rng.normal(0, 0.05, 2)
    trunk = [[0, 0, 0], [lean[0], fork / 2, lean[1]], [2 * lean[0], fork, 2 * lean[1]]]
    here.tube(_BARK, trunk, [0.17, 0.13, 0.11], 12)
    clumps = []
    for turn in np.linspace(0, 2 * np.pi, 9, endpoint=False) + rng.normal(0, 0.2, 9):
        reach = height * rng.uniform(0.13, 0.27)
        tip = np.array([reach * np.cos(turn), height * rng.uniform(0.5, 0.88),
                        reach * np.sin(turn)])  # fmt: skip
        start = np.array([2 * lean[0], fork * rng.uniform(0.85, 1), 2 * lean[1]])
        here.tube(_BARK, [start, start + (tip - start) * [0.4, 0.6, 0.4], tip],
                  [0.07, 0.045, 0.015], 7)  # fmt: skip
        clumps.append(tip)
    clumps += [np.array([0, height * 0.93, 0]), np.array([0, height * 0.72, 0])]
    # A few thousand leaves near the camera cost little; the renderer only stores them once.
    for index, color in enumerate(_LEAVES):
        _leaves(here, rng, clumps[index::3], 0.15 * height, color)


def _leaves(
    here: Parts, rng: np.random.Generator, clumps: list, radius_m: float, color: Color
) -> None:
    count = 1100
    for center in clumps:
        shell = rng.normal(0, 1, (count, 3))
        shell /= np.linalg.norm(shell, axis=1, keepdims=True)
        place = center + shell * radius_m * rng.uniform(0.35, 1, (count, 1)) ** 0.6 * [1, 0.8, 1]
        u = rng.normal(0, 1, (count, 3))
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        v = np.cross(u, rng.normal(0, 1, (count, 3)))
        v /= np.linalg.norm(v, axis=1, keepdims=True)
        size = rng.uniform(0.05, 0.1, (count, 1))
        corners = np.stack([place - u * size * 1.5, place + v * size, place + u * size * 1.5,
                            place - v * size], 1)  # fmt: skip
        here.quads(Material(color=color, roughness=0.7), corners)


def build_lamp(parts: Parts, lamp: Thing, *, night: bool) -> None:
    """Add a street lamp; tall ones reach over the road along +z of their own frame."""
    here = parts.placed(Placement.standing(lamp.x_m, lamp.z_m, lamp.turn, lamp.y_m))
    top = lamp.height_m
    glass = Material(color=(0.7, 0.68, 0.6), roughness=0.4)
    here.tube(DARK_METAL, [[0, 0, 0], [0, 0.5, 0], [0, 1.0, 0]], [0.11, 0.1, 0.06], 12)
    here.tube(DARK_METAL, [[0, 0.9, 0], [0, top / 2, 0], [0, top, 0]], [0.06, 0.05, 0.04], 12)
    if top > 5.5:
        here.tube(DARK_METAL, [[0, top - 0.1, 0], [0, top + 0.25, 0.6], [0, top + 0.3, 1.5]],
                  0.035, 8)  # fmt: skip
        here.box(DARK_METAL, [-0.15, top + 0.27, 1.2], [0.15, top + 0.37, 2.0])
        panel = glass.lit(_scaled(SODIUM, 260.0)) if night else glass
        here.box(panel, [-0.12, top + 0.24, 1.25], [0.12, top + 0.27, 1.95], omit=("top",))
        return
    bulb = glass.lit(_scaled(SODIUM, 90.0)) if night else glass
    angle = np.linspace(0, np.pi, 9)
    turn = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    globe = np.stack(
        [0.17 * np.sin(angle)[:, None] * np.cos(-turn),
         np.broadcast_to(top + 0.2 - 0.2 * np.cos(angle)[:, None], (9, 16)),
         0.17 * np.sin(angle)[:, None] * np.sin(-turn)], -1,
    )  # fmt: skip
    here.grid(bulb, globe, closed=True)
    here.tube(DARK_METAL, [[0, top + 0.36, 0], [0, top + 0.42, 0], [0, top + 0.55, 0]],
              [0.2, 0.12, 0.01], 12)  # fmt: skip


def _scaled(color: Color, factor: float) -> Color:
    return color[0] * factor, color[1] * factor, color[2] * factor


def build_bench(parts: Parts, bench: Thing) -> None:
    """Add a bench that looks along +z."""
    here = parts.placed(Placement.standing(bench.x_m, bench.z_m, bench.turn, bench.y_m))
    for z in np.arange(-0.2, 0.25, 0.12).tolist():
        here.box(_PLANKS, [-0.8, 0.43, z], [0.8, 0.46, z + 0.09])
    for y in (0.55, 0.68, 0.81):
        here.box(_PLANKS, [-0.8, y, -0.28], [0.8, y + 0.1, -0.25])
    for x in (-0.65, 0.6):
        here.box(DARK_METAL, [x, 0, -0.28], [x + 0.05, 0.43, 0.25])
        here.box(DARK_METAL, [x, 0.43, -0.3], [x + 0.05, 0.92, -0.26])


def build_bollard(parts: Parts, bollard: Thing) -> None:
    """Add an iron post."""
    here = parts.placed(Placement.standing(bollard.x_m, bollard.z_m, 0, bollard.y_m))
    top = bollard.height_m
    here.tube(
        Material(color=DARK_METAL.color, roughness=0.4, smooth=True),
        [[0, 0, 0], [0, top * 0.85, 0], [0, top * 0.9, 0], [0, top * 0.97, 0], [0, top, 0]],
        [0.07, 0.055, 0.08, 0.07, 0.005],
        14,
    )


def build_bin(parts: Parts, rubbish_bin: Thing) -> None:
    """Add a litter bin."""
    here = parts.placed(Placement.standing(rubbish_bin.x_m, rubbish_bin.z_m, 0, rubbish_bin.y_m))
    top = rubbish_bin.height_m
    here.tube(Material(color=(0.03, 0.07, 0.05), roughness=0.5, smooth=True),
              [[0, 0.1, 0], [0, top / 2, 0], [0, top, 0]], [0.2, 0.22, 0.24], 18)  # fmt: skip
    here.tube(DARK_METAL, [[0, 0, 0], [0, 0.05, 0], [0, 0.12, 0]], 0.05, 8)


def build_hedge(parts: Parts, hedge: Thing) -> None:
    """Add a clipped hedge along z; `height_m` is its length."""
    rng = np.random.default_rng(hedge.seed)
    here = parts.placed(Placement.standing(hedge.x_m, hedge.z_m, hedge.turn, hedge.y_m))
    half = hedge.height_m / 2
    here.box(Material(color=(0.03, 0.055, 0.012), roughness=0.9),
             [-0.28, 0, -half], [0.28, 0.95, half])  # fmt: skip
    count = int(900 * half)
    place = rng.uniform([-0.34, 0.05, -half], [0.34, 1.02, half], (count, 3))
    # Leaves only on the surface.
    side = rng.integers(3, size=count)
    place[side == 0, 0] = -0.32
    place[side == 1, 0] = 0.32
    place[side == 2, 1] = 1.0
    u = rng.normal(0, 1, (count, 3)) * 0.045
    v = rng.normal(0, 1, (count, 3)) * 0.045
    here.quads(Material(color=(0.07, 0.13, 0.03), roughness=0.7),
               np.stack([place - u, place + v, place + u, place - v], 1))  # fmt: skip


def build_fountain(parts: Parts, fountain: Thing) -> None:
    """Add a round stone basin with a column in it."""
    here = parts.placed(Placement.standing(fountain.x_m, fountain.z_m))
    stone = Material(
        color=LIMESTONE.color,
        roughness=0.8,
        smooth=False,
        texture=Texture(pattern="stone", color=(0.5, 0.47, 0.4), seed=5),
    )
    wide = fountain.height_m
    here.tube(
        stone,
        [[0, 0, 0], [0, 0.2, 0], [0, 0.55, 0], [0, 0.62, 0], [0, 0.621, 0], [0, 0.3, 0]],
        [wide, wide * 0.97, wide * 0.97, wide * 1.02, wide * 0.9, wide * 0.89],
        40,
    )
    here.floor(
        Material(color=(0.03, 0.06, 0.06), roughness=0.05, kind="water"),
        (-wide * 0.64, wide * 0.64),
        (-wide * 0.64, wide * 0.64),
        0.48,
    )
    here.tube(
        stone,
        [
            [0, 0.3, 0],
            [0, 0.8, 0],
            [0, 1.5, 0],
            [0, 2.4, 0],
            [0, 2.5, 0],
            [0, 2.62, 0],
            [0, 2.7, 0],
        ],
        [0.5, 0.3, 0.24, 0.2, 0.9, 0.95, 0.05],
        24,
    )
