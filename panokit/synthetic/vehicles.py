"""Cars and boats, lofted from a few sections; and the rigs that carry the camera."""

import numpy as np

from panokit.synthetic.city import PlacePlan, Thing
from panokit.synthetic.materials import DARK_GLASS, DARK_METAL, RUBBER, STEEL, Color, Material
from panokit.synthetic.shapes import Floats, Parts, Placement

# Stations along a car, front to back: z, half width, belt height, roof height (0: no cabin).
_HATCHBACK = np.array([
    (-2.12, 0.62, 0.56), (-2.05, 0.76, 0.66), (-1.80, 0.85, 0.74), (-1.20, 0.88, 0.86),
    (-0.70, 0.89, 0.92), (0.00, 0.90, 0.95), (0.90, 0.90, 0.97), (1.50, 0.88, 0.98),
    (1.85, 0.84, 0.96), (2.02, 0.76, 0.88), (2.08, 0.66, 0.74),
])  # fmt: skip
_CABIN = np.array([
    (-1.02, 0.78, 0.90), (-0.62, 0.74, 1.20), (-0.25, 0.70, 1.40), (0.10, 0.68, 1.47),
    (0.70, 0.68, 1.48), (1.20, 0.67, 1.43), (1.60, 0.68, 1.25), (1.88, 0.74, 0.94),
])  # fmt: skip


def build_car(parts: Parts, car: Thing) -> None:
    """Add a small car that looks along -z."""
    here = parts.placed(Placement.standing(car.x_m, car.z_m, car.turn, car.y_m))
    paint = Material(color=car.color, roughness=0.35, metallic=0.0, clearcoat=1.0, smooth=True)
    here.grid(paint, _body(_HATCHBACK, 0.22))
    glass = Material(color=DARK_GLASS.color, roughness=0.02, kind="glass", smooth=True)
    here.grid(glass, _cabin(_CABIN, 1.0))
    here.grid(paint, _roof_panel(_CABIN[2:6]))
    for x in (-1.0, 1.0):
        for station in (2, 4, 6):
            _pillar(here, paint, x, station)
    for x in (-0.80, 0.80):
        for z in (-1.32, 1.28):
            _wheel(here, x, z)
    _lights(here)
    here.box(DARK_METAL, [-0.76, 0.16, -1.75], [0.76, 0.34, 1.75])


def _body(stations: Floats, sill_m: float) -> Floats:
    """Rounded boxes of varying width and height, as rows of points from front to back."""
    angle = np.linspace(-0.5 * np.pi, 1.5 * np.pi, 33)[::-1]
    cos, sin = np.cos(angle), np.sin(angle)
    # A superellipse: between an oval and a box.
    x = np.sign(cos) * np.abs(cos) ** 0.45
    y = np.sign(sin) * np.abs(sin) ** 0.45
    rows = [
        np.stack([w * x, sill_m + (top - sill_m) * (y + 1) / 2, np.full_like(x, z)], 1)
        for z, w, top in stations
    ]
    first, last = rows[0].mean(axis=0), rows[-1].mean(axis=0)
    return np.stack([np.broadcast_to(first, rows[0].shape), *rows,
                     np.broadcast_to(last, rows[0].shape)])  # fmt: skip


def _arch(half_width: float, top: float, z: float, belt: float) -> Floats:
    t = np.linspace(0, np.pi, 25)
    x = np.sign(np.cos(t)) * np.abs(np.cos(t)) ** 0.4
    y = np.sin(t) ** 0.5
    lean = 1.14 - 0.14 * y
    return np.stack([-half_width * x * lean, belt + (top - belt) * y, np.full_like(t, z)], 1)


def _cabin(stations: Floats, scale: float) -> Floats:
    return np.stack([_arch(w * scale, top, z, 0.88) for z, w, top in stations])[::-1]


def _roof_panel(stations: Floats) -> Floats:
    """The painted roof: the upper part of the cabin, a hand's breadth above the glass."""
    rows = np.stack([_arch(w, top + 0.012, z, 0.88) for z, w, top in stations])[::-1]
    return rows[:, 6:19] * [1.0, 1.0, 1.0]


def _pillar(here: Parts, paint: Material, side: float, station: int) -> None:
    z, half, top = _CABIN[station]
    foot = _CABIN[max(station - 1, 0)] if station < 4 else _CABIN[min(station + 1, 7)]
    here.tube(
        paint,
        [
            [side * half * 1.12, 0.9, (z + foot[0]) / 2],
            [side * half * 1.06, (0.9 + top) / 2, z],
            [side * half * 0.93, top - 0.03, z],
        ],
        0.045,
        8,
    )


def _wheel(here: Parts, x: float, z: float) -> None:
    angle = np.linspace(0, 2 * np.pi, 25)
    rim = np.array([(0.0, 0.02), (0.2, 0.02), (0.21, 0.0), (0.3, 0.0), (0.32, 0.05), (0.32, 0.2)])
    side = np.sign(x)
    for material, ring in ((STEEL, rim[:3]), (RUBBER, rim[2:])):
        points = np.stack(
            [
                np.stack(
                    [
                        np.full_like(angle, x + side * (0.1 - inset)),
                        0.32 + radius * np.sin(angle),
                        z + radius * np.cos(angle),
                    ],
                    1,
                )
                for radius, inset in ring
            ]
        )
        here.grid(material, points if side < 0 else points[::-1])


def _lights(here: Parts) -> None:
    clear = Material(color=(0.7, 0.7, 0.7), roughness=0.1, clearcoat=1.0)
    red = Material(color=(0.35, 0.01, 0.01), roughness=0.15, clearcoat=1.0)
    plate = Material(color=(0.7, 0.7, 0.62), roughness=0.6)
    for x in (-0.72, 0.42):
        here.box(clear, [x, 0.56, -2.06], [x + 0.3, 0.68, -1.9])
        here.box(red, [x, 0.68, 1.9], [x + 0.3, 0.86, 2.03])
    here.box(plate, [-0.26, 0.4, -2.13], [0.26, 0.51, -2.0])
    here.box(plate, [-0.26, 0.5, 2.0], [0.26, 0.61, 2.11])


def build_boat(parts: Parts, boat: Thing) -> None:
    """Add a small open boat afloat, with its bow along -z."""
    here = parts.placed(Placement.standing(boat.x_m, boat.z_m, boat.turn, boat.y_m))
    length = boat.height_m
    share = np.linspace(0, 1, 15)
    half = 0.22 * length * 0.55 * np.sqrt(np.clip(1 - (1 - share * 1.9).clip(0) ** 2, 0.003, 1))
    t = np.linspace(0, np.pi, 17)
    rows = []
    for s, w in zip(share, half, strict=True):
        rim = 0.75 + 0.35 * (1 - s) ** 2
        x, y = -w * np.cos(t), rim - (rim + 0.3) * np.sin(t) ** 0.7
        rows.append(np.stack([x, y, np.full_like(t, (s - 0.5) * length)], 1))
    hull = np.stack(rows)
    here.grid(Material(color=boat.color, roughness=0.3, clearcoat=0.6, smooth=True), hull)
    wood = Material(color=(0.26, 0.16, 0.08), roughness=0.6)
    here.box(wood, [-half[5], 0.42, -0.28 * length], [half[5], 0.5, 0.42 * length])
    white = Material(color=(0.66, 0.66, 0.64), roughness=0.4)
    here.box(white, [-half[6] * 0.75, 0.5, -0.1 * length], [half[6] * 0.75, 1.75, 0.16 * length])
    here.box(
        DARK_GLASS, [-half[6] * 0.76, 1.15, -0.09 * length], [half[6] * 0.76, 1.6, 0.15 * length]
    )
    here.tube(STEEL, [[0, 0.5, 0.0], [0, 2.6, 0.0], [0, 4.6, 0.0]], [0.05, 0.04, 0.03], 8)


def build_rig(parts: Parts, plan: PlacePlan) -> None:
    """Add what carries the camera; pictures show it at their foot, the truth does not."""
    x, y, z = plan.camera_m
    if plan.rig == "car":
        color: Color = (0.1, 0.13, 0.17)
        build_car(parts, Thing(kind="car", x_m=x, z_m=z + 0.25, color=color))
        mast = parts.placed(Placement.standing(x, z))
        mast.box(DARK_METAL, [-0.55, 1.48, -0.03], [0.55, 1.53, 0.03])
        mast.tube(DARK_METAL, [[0, 1.45, 0], [0, (y + 1.2) / 2, 0], [0, y - 0.26, 0]], 0.035)
        mast.tube(DARK_METAL, [[0, y - 0.35, 0], [0, y - 0.27, 0], [0, y - 0.25, 0]],
                  [0.06, 0.07, 0.001], 20)  # fmt: skip
        return
    stand = parts.placed(Placement.standing(x, z))
    for turn in (0.4, 0.4 + 2 * np.pi / 3, 0.4 + 4 * np.pi / 3):
        foot = np.array([0.48 * np.cos(turn), 0.0, 0.48 * np.sin(turn)])
        neck = np.array([0.0, y - 0.6, 0.0])
        stand.tube(DARK_METAL, [foot, (foot + neck) / 2, neck], [0.012, 0.016, 0.02], 10)
    stand.tube(DARK_METAL, [[0, y - 0.75, 0], [0, y - 0.5, 0], [0, y - 0.26, 0]], 0.018)
    stand.tube(DARK_METAL, [[0, y - 0.27, 0], [0, y - 0.25, 0], [0, y - 0.24, 0]],
               [0.03, 0.035, 0.001], 20)  # fmt: skip
