"""Tables, desks, shelves and cabinets.

Each maker fills `Solids` in meters, standing on y = 0 with its front toward +z. Parts: 0 the
body, 1 tops and doors, 2 handles and what stands on it.
"""

from itertools import pairwise

import numpy as np

from panokit.dataset.objects.seating import legs
from panokit.dataset.objects.shaping import between, chance
from panokit.dataset.objects.solids import Solids


def table(solids: Solids, rng: np.random.Generator) -> None:
    """A table: rectangular on four legs, or round on a column."""
    height, top = between(rng, 0.4, 0.78), between(rng, 0.02, 0.05)
    if chance(rng, 0.35):
        radius = between(rng, 0.3, 0.65)
        edge, low = top * 0.3, height - top
        profile = [(0, low), (radius - edge, low), (radius, low + edge)]
        profile += [(radius, height - edge), (radius - edge, height), (0, height)]
        solids.lathe(1, profile, segments=48)
        foot, neck = radius * between(rng, 0.5, 0.75), between(rng, 0.025, 0.06)
        column = [(0, 0), (foot, 0), (foot, 0.02), (neck * 1.6, 0.06), (neck, 0.12)]
        belly = neck * between(rng, 0.7, 1.8)
        column += [(belly, low * 0.55), (neck, low * 0.85), (neck * 1.9, low), (0, low)]
        solids.lathe(0, column, segments=24)
        return
    x, z = between(rng, 0.4, 0.9), between(rng, 0.25, 0.45)
    thick = between(rng, 0.035, 0.08)
    legs(solids, rng, (x * 0.96, z * 0.96), height - top, thick)
    solids.box(1, (-x, height - top, -z), (x, height, z), between(rng, 0.003, 0.012))
    if chance(rng, 0.7):
        tall, inset = between(rng, 0.05, 0.1), thick * 1.1
        for side in (-1, 1):
            low, high = height - top - tall, height - top
            at = side * (z - inset)
            solids.box(0, (-x + inset, low, at - 0.011), (x - inset, high, at + 0.011), 0.003)
            at = side * (x - inset)
            solids.box(0, (at - 0.011, low, -z + inset), (at + 0.011, high, z - inset), 0.003)


def desk(solids: Solids, rng: np.random.Generator) -> None:
    """A desk with a block of drawers, and sometimes a shelf on top."""
    x, z = between(rng, 0.5, 0.8), between(rng, 0.27, 0.4)
    height, top = between(rng, 0.7, 0.76), between(rng, 0.022, 0.04)
    solids.box(1, (-x, height - top, -z), (x, height, z), 0.005)
    side, block = (-1 if chance(rng, 0.5) else 1), between(rng, 0.32, 0.45)
    low, high = sorted((side * (x - 0.02), side * (x - 0.02 - block)))
    base = between(rng, 0.02, 0.15)
    solids.box(0, (low, base, -z + 0.02), (high, height - top, z - 0.03), 0.004)
    _fronts(solids, rng, (low, base, high, height - top), z - 0.03, int(rng.integers(2, 5)), 1)
    for end in (-1, 1):
        at, foot = end * (z - 0.04), -side * (x - 0.05)
        solids.box(
            0, (foot - 0.025, 0, at - 0.025), (foot + 0.025, height - top, at + 0.025), 0.004
        )
        if base > 0.03:
            for edge in (low + 0.03, high - 0.03):
                near = at - end * 0.02
                solids.box(
                    0, (edge - 0.02, 0, near - 0.02), (edge + 0.02, base, near + 0.02), 0.004
                )
    if chance(rng, 0.4):
        tall = between(rng, 0.2, 0.35)
        for edge in (-x + 0.02, x - 0.02):
            solids.box(0, (edge - 0.01, height, -z), (edge + 0.01, height + tall, -z + 0.2), 0.002)
        solids.box(1, (-x, height + tall, -z), (x, height + tall + 0.02, -z + 0.2), 0.003)


def shelf(solids: Solids, rng: np.random.Generator) -> None:
    """A bookcase with books and boxes, open at the back or not."""
    x, z = between(rng, 0.3, 0.6), between(rng, 0.13, 0.2)
    height, board = between(rng, 0.8, 1.8), between(rng, 0.016, 0.03)
    rows, columns = max(2, round(height / between(rng, 0.3, 0.42))), int(rng.integers(1, 3))
    for edge in np.linspace(-x, x, columns + 1):
        solids.box(0, (edge - board / 2, 0, -z), (edge + board / 2, height, z), 0.002)
    levels = np.linspace(0.05, height - board, rows + 1)
    for y in levels:
        solids.box(0, (-x, y, -z), (x, y + board, z - 0.004), 0.002)
    if chance(rng, 0.6):
        solids.box(1, (-x, 0.02, -z - 0.008), (x, height, -z + 0.002), 0.001)
    gap = float(levels[1] - levels[0]) - board
    books_left = 60
    for y in levels[:-1] + board:
        for column in range(columns):
            start = -x + column * 2 * x / columns + board
            room = 2 * x / columns - 2 * board
            what = rng.random()
            if what < 0.6:
                books_left -= _books(solids, rng, (start, float(y)), room, gap, z, books_left)
            elif what < 0.78:
                wide = room * between(rng, 0.4, 0.8)
                solids.box(2, (start, y, -z * 0.8), (start + wide, y + gap * 0.7, z * 0.9), 0.004)


def _books(
    solids: Solids,
    rng: np.random.Generator,
    place: tuple[float, float],
    room: float,
    gap: float,
    half_depth: float,
    most: int,
) -> int:
    """A row of books from `place` on; how many there are."""
    start, end, count = place[0] + 0.003, place[0] + room * between(rng, 0.4, 1.0), 0
    while count < most:
        thick = between(rng, 0.014, 0.05)
        if start + thick > end:
            break
        tall, deep = gap * between(rng, 0.6, 0.95), half_depth * between(rng, 1.0, 1.7)
        part = 2 if chance(rng, 0.6) else 1
        low = (start, place[1], half_depth * 0.9 - deep)
        solids.box(part, low, (start + thick, place[1] + tall, half_depth * 0.9), 0.002)
        start, count = start + thick + 0.001, count + 1
    return count


def cabinet(solids: Solids, rng: np.random.Generator) -> None:
    """A sideboard, wardrobe or chest of drawers."""
    x, z = between(rng, 0.3, 0.8), between(rng, 0.2, 0.3)
    body, foot = between(rng, 0.45, 1.3), between(rng, 0.02, 0.18)
    legs(solids, rng, (x * 0.95, z * 0.9), foot + 0.01, between(rng, 0.03, 0.05))
    solids.box(0, (-x, foot, -z), (x, foot + body, z), 0.006)
    out = between(rng, 0.0, 0.02)
    high = foot + body
    solids.box(1, (-x - out, high, -z - out), (x + out, high + 0.025, z + 0.02 + out), 0.005)
    columns = max(1, round(2 * x / between(rng, 0.36, 0.5)))
    for column in range(columns):
        low, end = (-x + 2 * x * (column + k) / columns for k in (0, 1))
        rows = int(rng.integers(2, 5)) if chance(rng, 0.5) else 1
        _fronts(solids, rng, (low, foot, end, high), z, rows, columns)


def _fronts(
    solids: Solids,
    rng: np.random.Generator,
    area: tuple[float, float, float, float],
    z: float,
    rows: int,
    columns: int,
) -> None:
    """Drawer fronts or a door on an upright rectangle (x0, y0, x1, y1), with handles."""
    x0, y0, x1, y1 = area
    edges = np.linspace(y0, y1, rows + 1)
    knob = chance(rng, 0.5)
    for low, high in pairwise(edges):
        solids.box(1, (x0 + 0.006, low + 0.006, z), (x1 - 0.006, high - 0.006, z + 0.018), 0.004)
        y, middle = (low + high) / 2, (x0 + x1) / 2
        if rows == 1 and columns > 1:
            middle = x1 - 0.05 if x0 < 0 else x0 + 0.05
        if knob:
            ball = solids.placed((middle, y, z + 0.015), lean_deg=90)
            ball.lathe(
                2,
                [(0, 0), (0.007, 0), (0.006, 0.012), (0.016, 0.02), (0.014, 0.03), (0, 0.034)],
                segments=12,
            )
        else:
            half = 0.3 * (x1 - x0) / 2 if rows > 1 else 0.012
            tall = 0.009 if rows > 1 else min(0.12, (high - low) * 0.2)
            solids.box(
                2, (middle - half, y - tall, z + 0.01), (middle + half, y + tall, z + 0.04), 0.004
            )
