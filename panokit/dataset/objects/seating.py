"""Chairs, stools, benches, armchairs, sofas and beds.

Each maker fills `Solids` in meters, standing on y = 0 with its front toward +z. Parts: 0 the
frame, 1 what one sits or lies on, 2 what else there is.
"""

import numpy as np

from panokit.dataset.objects.shaping import bend, between, chance
from panokit.dataset.objects.solids import Solids, flat_section, round_section


def legs(
    solids: Solids,
    rng: np.random.Generator,
    half: tuple[float, float],
    height: float,
    thick: float,
    part: int = 0,
) -> None:
    """Four legs under a rectangle: round or square, straight, tapered or splayed."""
    round_legs, splay = chance(rng, 0.5), between(rng, 0, 0.09) * chance(rng, 0.6)
    foot = between(rng, 0.55, 1.0)
    section = round_section(0.55, 10) if round_legs else flat_section(1, 1, 0.12)
    inset = thick * 0.7
    for x in (-1, 1):
        for z in (-1, 1):
            top = np.array([x * (half[0] - inset), height, z * (half[1] - inset)])
            bottom = np.array([top[0] + x * splay, 0, top[2] + z * splay])
            path = np.linspace(bottom, top, 3)
            solids.sweep(part, path, section, thick * np.linspace(foot, 1, 3))
    if chance(rng, 0.45):
        at = height * between(rng, 0.25, 0.5)
        out = splay * (1 - at / height)
        wide, deep, rod = half[0] - inset + out, half[1] - inset + out, thick * 0.28
        for sign in (-1, 1):
            solids.tube(part, [[sign * wide, at, -deep], [sign * wide, at, deep]], rod, 8)
        if chance(rng, 0.5):
            solids.tube(part, [[-wide, at, 0], [wide, at, 0]], rod, 8)


def chair(solids: Solids, rng: np.random.Generator) -> None:
    """A dining chair with one of five backs."""
    width, depth = between(rng, 0.38, 0.52), between(rng, 0.38, 0.5)
    seat, thick = between(rng, 0.42, 0.5), between(rng, 0.03, 0.05)
    legs(solids, rng, (width / 2, depth / 2), seat - 0.02, thick)
    _seat(solids, rng, width, depth, seat)
    back = solids.placed((0, seat, -depth / 2 + thick / 2), lean_deg=-between(rng, 3, 13))
    _back(back, rng, width, between(rng, 0.36, 0.6), thick)


def _seat(
    solids: Solids, rng: np.random.Generator, width: float, depth: float, height: float
) -> None:
    x, z = width / 2, depth / 2
    if chance(rng, 0.5):
        soft = between(rng, 0.04, 0.08)
        solids.box(0, (-x, height - 0.04, -z), (x, height - 0.01, z), 0.006)
        low, high = (-x * 0.97, height - 0.015, -z * 0.97), (x * 0.97, height - 0.015 + soft, z)
        solids.cushion(1, low, high, soft * 0.45, (0, 0.012, 0))
    else:
        solids.box(1, (-x, height - 0.035, -z), (x, height, z), between(rng, 0.004, 0.012))


def _back(
    solids: Solids, rng: np.random.Generator, width: float, height: float, thick: float
) -> None:
    style, x = rng.integers(5), width / 2 - thick / 2
    post = flat_section(thick, thick * 0.8, 0.006)
    bow = -between(rng, 0.0, 0.06)

    def rail(y: float, tall: float, part: int) -> None:
        path = bend((-x, y, 0), (0, y, 2 * bow), (x, y, 0), 9)
        solids.sweep(part, path, flat_section(thick * 0.55, tall, 0.006))

    if style != 4:
        for side in (-x, x):
            solids.sweep(0, [[side, -0.05, 0], [side, height, 0]], post)
    if style == 0:
        for y in np.linspace(height * 0.3, height - 0.05, rng.integers(2, 5)):
            rail(float(y), 0.06, 2)
    elif style == 1:
        rail(height - 0.04, 0.08, 0)
        rail(height * 0.15, 0.04, 0)
        for side in np.linspace(-x, x, rng.integers(5, 9))[1:-1]:
            # The rails bow by a parabola, and the rods with them.
            z = bow * (1 - (side / x) ** 2)
            solids.tube(2, [[side, height * 0.15, z], [side, height - 0.05, z]], thick * 0.22, 8)
    elif style == 2:
        rail(height * 0.62, height * 0.6, 2)
    elif style == 3:
        soft = between(rng, 0.02, 0.035)
        low, high = (-x, height * 0.2, -soft), (x, height * 1.02, soft)
        solids.cushion(1, low, high, soft * 0.9, (0, 0, 0.012))
    else:
        arch = bend((-x, -0.03, 0), (-x * 1.1, height * 1.2, bow), (0, height, bow), 9)
        whole = np.concatenate([arch, (arch * [-1, 1, 1])[-2::-1]])
        solids.tube(0, whole, thick * 0.4, 10)
        for side in np.linspace(-0.62, 0.62, rng.integers(3, 7)) * x:
            top = height * (1 - 0.35 * (side / x) ** 2) - 0.005
            solids.tube(2, [[side, -0.03, 0], [side * 1.08, top, bow]], thick * 0.2, 8)


def armchair(solids: Solids, rng: np.random.Generator) -> None:
    """An upholstered chair with arms."""
    _upholstered(solids, rng, seats=1)


def sofa(solids: Solids, rng: np.random.Generator) -> None:
    """An upholstered sofa for two or three."""
    _upholstered(solids, rng, seats=int(rng.integers(2, 4)))


def _upholstered(solids: Solids, rng: np.random.Generator, seats: int) -> None:
    seat_width, depth = between(rng, 0.55, 0.72), between(rng, 0.75, 0.95)
    arm, foot = between(rng, 0.1, 0.22), between(rng, 0.06, 0.16)
    seat, back = between(rng, 0.4, 0.46), between(rng, 0.72, 0.92)
    arm_height = between(rng, seat + 0.08, seat + 0.22)
    inner, z = seats * seat_width / 2, depth / 2
    x, base = inner + arm, seat - 0.16
    for side in (-1, 1):
        for end in (-1, 1):
            at = (side * (x - 0.07), end * (z - 0.07))
            taper = np.linspace(0.6, 1.0, 2)
            rod = [[at[0], 0, at[1]], [at[0], foot + 0.02, at[1]]]
            solids.sweep(2, rod, round_section(0.03, 10), taper)
    solids.cushion(0, (-x + 0.02, foot, -z), (x - 0.02, base + 0.02, z - 0.02), 0.03)
    thick = between(rng, 0.16, 0.24)
    solids.cushion(0, (-x + 0.01, foot, -z), (x - 0.01, back, -z + thick), 0.05)
    soft = between(rng, 0.03, 0.07)
    for side in (-1, 1):
        low, high = sorted((side * inner, side * x))
        solids.cushion(0, (low, foot, -z + 0.01), (high, arm_height, z), soft)
    lean = between(rng, 8, 16)
    for index in range(seats):
        left = -inner + index * seat_width
        near, far = (left + 0.004, base, -z + thick * 0.8), (left + seat_width - 0.004, seat, z)
        solids.cushion(1, near, far, 0.05, (0, 0.025, 0.01))
        rest = solids.placed((left + seat_width / 2, seat, -z + thick + 0.12), lean_deg=-lean)
        tall, half = back - seat + between(rng, -0.06, 0.06), seat_width / 2 - 0.006
        rest.cushion(1, (-half, 0, -0.08), (half, tall, 0.08), 0.06, (0, 0.02, 0.035))
    if chance(rng, 0.4):
        size = between(rng, 0.3, 0.42)
        spot = solids.placed(
            (between(rng, -0.6, 0.6) * inner, seat + size / 2, -z + thick + 0.3),
            turn_deg=between(rng, -25, 25), lean_deg=-28,
        )  # fmt: skip
        spot.cushion(
            2, (-size / 2, -size / 2, -0.03), (size / 2, size / 2, 0.03), 0.028, (0, 0, 0.05)
        )


def stool(solids: Solids, rng: np.random.Generator) -> None:
    """A stool: on four legs or on one column, its seat round or square."""
    height, radius = between(rng, 0.42, 0.78), between(rng, 0.15, 0.21)
    if chance(rng, 0.3):
        column = [(0, 0), (radius * 1.05, 0), (radius, 0.015), (0.04, 0.045), (0.028, 0.08)]
        solids.lathe(
            0, [*column, (0.028, height - 0.04), (0.07, height - 0.02), (0, height - 0.02)]
        )
    else:
        legs(solids, rng, (radius * 0.8, radius * 0.8), height - 0.02, between(rng, 0.028, 0.045))
    top = between(rng, 0.03, 0.09)
    edge = min(0.4 * top, 0.02)
    if chance(rng, 0.65):
        rim = [(radius - edge, height - 0.03), (radius, height - 0.03 + edge)]
        upper = [(radius, height - 0.03 + top - edge), (radius - edge, height - 0.03 + top)]
        middle = height - 0.03 + top + between(rng, 0, 0.015)
        solids.lathe(1, [(0, height - 0.03), *rim, *upper, (0, middle)], segments=36)
    else:
        low, high = (-radius, height - 0.03, -radius), (radius, height - 0.03 + top, radius)
        solids.cushion(1, low, high, edge, (0, 0.01, 0))


def bench(solids: Solids, rng: np.random.Generator) -> None:
    """A garden bench of planks, with or without a back."""
    width, depth = between(rng, 1.0, 1.6), between(rng, 0.34, 0.46)
    height, plank = between(rng, 0.42, 0.47), between(rng, 0.022, 0.04)
    count = int(rng.integers(3, 6))
    x, z, pitch = width / 2, depth / 2, depth / count
    for index in range(count):
        front = -z + index * pitch
        low = (-x, height - plank, front + pitch * 0.07)
        solids.box(1, low, (x, height, front + pitch * 0.93), 0.005)
    inset = between(rng, 0.08, 0.22)
    back = between(rng, 0.32, 0.45) if chance(rng, 0.6) else 0.0
    for side in (-1, 1):
        at = side * (x - inset)
        solids.box(0, (at - 0.03, height - plank - 0.07, -z), (at + 0.03, height - plank, z), 0.006)
        for end in (-1, 1):
            spread = between(rng, 0, 0.0) + end * 0.02
            foot, top = (
                [at, 0, end * (z - 0.04) + spread],
                [at, height - plank - 0.01, end * (z - 0.04)],
            )
            solids.sweep(0, [foot, top], flat_section(0.06, 0.06, 0.008))
        if back:
            post = solids.placed((at, height - plank - 0.06, -z + 0.02), lean_deg=-10)
            post.box(0, (-0.025, 0, -0.02), (0.025, back + 0.1, 0.02), 0.006)
    if back:
        rest = solids.placed((0, height - plank - 0.06, -z + 0.055), lean_deg=-10)
        for y in np.linspace(back * 0.4, back, int(rng.integers(2, 4))):
            rest.box(1, (-x, y, -0.012), (x, y + 0.085, 0.012), 0.005)


def bed(solids: Solids, rng: np.random.Generator) -> None:
    """A bed with mattress, blanket and pillows."""
    width, length = between(rng, 0.9, 1.8), between(rng, 1.95, 2.1)
    frame, mattress = between(rng, 0.2, 0.34), between(rng, 0.16, 0.26)
    x, z, top = width / 2, length / 2, frame + mattress
    legs(solids, rng, (x, z), frame - 0.05, 0.08)
    solids.box(0, (-x - 0.03, frame - 0.14, -z - 0.03), (x + 0.03, frame + 0.02, z + 0.03), 0.012)
    head = between(rng, 0.25, 0.6)
    board = (-x - 0.04, frame - 0.14, -z - 0.1), (x + 0.04, top + head, -z - 0.02)
    if chance(rng, 0.5):
        solids.cushion(0, *board, 0.035, (0, 0, 0.02))
    else:
        solids.box(0, *board, 0.015)
    solids.cushion(1, (-x, frame, -z), (x, top, z), 0.05, (0, 0.01, 0))
    cover = between(rng, 0.35, 0.75)
    low = (-x - 0.015, frame + 0.04, z - length * cover)
    solids.cushion(2, low, (x + 0.015, top + 0.035, z + 0.015), 0.045, (0, 0.015, 0))
    count = 2 if width > 1.25 else 1
    for index in range(count):
        middle = (index + 0.5) / count * width - x
        half = min(0.36, width / count / 2 - 0.06)
        place = solids.placed((middle, top + 0.06, -z + 0.24), turn_deg=between(rng, -9, 9))
        place.cushion(1, (-half, -0.06, -0.2), (half, 0.05, 0.2), 0.045, (0, 0.06, 0))
