"""Vases, bottles, mugs, bowls, teapots, plants, lamps and candlesticks.

Each maker fills `Solids` in meters, standing on y = 0. Part 0 is the body; 1 and 2 are what
else there is.
"""

import numpy as np

from panokit.dataset.objects.shaping import Floats, bend, between, chance, curve
from panokit.dataset.objects.solids import Solids, flat_section, round_section


def _hollow(outline: Floats, wall: float, floor: float) -> Floats:
    """The profile of a vessel: from the axis up its outside, over the rim, down its inside."""
    inside = outline[outline[:, 1] > floor + wall]
    inside = np.stack([np.maximum(inside[:, 0] - wall, 0.3 * wall), inside[:, 1]], axis=1)
    rim = outline[-1] + [-wall / 2, wall * 0.4]
    bottom = [[0, outline[0, 1]]]
    return np.concatenate([bottom, outline, [rim], inside[::-1], [[0, floor + wall]]])


def vase(solids: Solids, rng: np.random.Generator) -> None:
    """A thrown vase, wide or slender, ribbed or smooth."""
    height, foot = between(rng, 0.18, 0.45), between(rng, 0.03, 0.07)
    belly, neck = between(rng, 0.06, 0.14), between(rng, 0.02, 0.06)
    where, lip = between(rng, 0.25, 0.6), neck * between(rng, 1.0, 1.7)
    knots = [(foot, 0.0), (belly, height * where), (neck, height * between(rng, 0.78, 0.9))]
    outline = curve([*knots, (lip, height)], 24)
    if chance(rng, 0.3):
        ripple = 1 + between(rng, 0.01, 0.03) * np.sin(outline[:, 1] / height * 2 * np.pi * 9)
        outline = outline * np.stack([ripple, np.ones_like(ripple)], axis=1)
    profile = _hollow(outline, between(rng, 0.004, 0.008), 0.004)
    solids.lathe(0, profile, segments=40)
    if chance(rng, 0.25):
        for side in (0, 180):
            grip = solids.placed(turn_deg=side)
            top, low = height * 0.86, height * where
            path = bend((neck * 0.9, top, 0), (belly * 2.1, top, 0), (belly * 0.97, low, 0), 12)
            grip.tube(1, path, 0.009, 8)


def bottle(solids: Solids, rng: np.random.Generator) -> None:
    """A bottle with its stopper."""
    height, radius = between(rng, 0.2, 0.34), between(rng, 0.03, 0.05)
    neck, shoulder = between(rng, 0.011, 0.017), between(rng, 0.45, 0.68)
    body = [(radius * 0.94, 0.0), (radius, 0.006), (radius, height * shoulder)]
    rise = curve(
        [(radius, height * shoulder), (neck * 1.15, height * (shoulder + 0.2)), (neck, height)], 14
    )
    top = [(neck * 1.3, height), (neck * 1.3, height + 0.014), (0, height + 0.014)]
    solids.lathe(0, [(0, 0.0), *body[:-1], *map(tuple, rise), *top], segments=40)
    cork = neck * between(rng, 0.85, 1.5)
    low = height + 0.012
    profile = [(0, low), (cork, low), (cork * 1.05, low + 0.02), (cork * 0.9, low + 0.026)]
    solids.lathe(1, [*profile, (0, low + 0.026)], segments=20)
    if chance(rng, 0.6):
        low, high = height * shoulder * 0.2, height * shoulder * 0.85
        out, inner = radius * 1.012, radius * 0.97
        solids.lathe(2, [(inner, low), (out, low), (out, high), (inner, high)], segments=40)


def mug(solids: Solids, rng: np.random.Generator) -> None:
    """A mug with a handle."""
    height, radius = between(rng, 0.07, 0.12), between(rng, 0.033, 0.05)
    foot = radius * between(rng, 0.7, 1.05)
    waist = radius * between(rng, 0.85, 1.12)
    outline = curve([(foot * 0.95, 0), (foot, 0.003), (waist, height * 0.5), (radius, height)], 16)
    solids.lathe(0, _hollow(outline, 0.0035, 0.003), segments=48)
    top, low = height * between(rng, 0.75, 0.88), height * between(rng, 0.15, 0.3)
    reach = radius + between(rng, 0.03, 0.05)
    ends = (
        float(np.interp(top, outline[:, 1], outline[:, 0])),
        float(np.interp(low, outline[:, 1], outline[:, 0])),
    )
    first = bend((ends[0] - 0.002, top, 0), (reach, top, 0), (reach, (top + low) / 2, 0), 9)
    second = bend((reach, (top + low) / 2, 0), (reach, low, 0), (ends[1] - 0.002, low, 0), 9)
    section = round_section(0.006, 10) * [1.4, 0.8]
    solids.sweep(1, np.concatenate([first, second[1:]]), section)


def bowl(solids: Solids, rng: np.random.Generator) -> None:
    """A bowl, sometimes with fruit."""
    radius, height = between(rng, 0.09, 0.16), between(rng, 0.05, 0.1)
    foot = radius * between(rng, 0.35, 0.55)
    knots = [(foot, 0.0), (foot * 1.02, 0.008), (radius * 0.86, height * 0.55), (radius, height)]
    solids.lathe(0, _hollow(curve(knots, 18), between(rng, 0.004, 0.007), 0.006), segments=48)
    for _ in range(int(rng.integers(3, 7)) if chance(rng, 0.5) else 0):
        size, turn = between(rng, 0.026, 0.038), between(rng, 0, 2 * np.pi)
        out = between(rng, 0.15, 0.42) * radius
        level = height * 0.3 + size * between(rng, 0.7, 1.2)
        arc = np.linspace(0, np.pi, 10)
        ball = np.stack([size * np.sin(arc), level - size * np.cos(arc)], axis=1)
        ball[[0, -1], 0] = 0
        solids.lathe(1, ball, (out * np.cos(turn), out * np.sin(turn)), 16)


def teapot(solids: Solids, rng: np.random.Generator) -> None:
    """A round teapot with spout, handle and lid."""
    radius, squash = between(rng, 0.07, 0.095), between(rng, 0.75, 1.1)
    height, mouth = 1.6 * radius * squash, radius * between(rng, 0.4, 0.55)
    knots = [(radius * 0.6, 0), (radius, height * 0.45), (mouth, height)]
    body = curve(knots, 20)
    solids.lathe(0, [(0, 0), *map(tuple, body), (0, height)], segments=40)
    lid = curve([(mouth * 0.98, height - 0.001), (mouth * 0.6, height + 0.014)], 6)
    knob = [(0.006, height + 0.02), (0.007, height + 0.024), (0.013, height + 0.032)]
    top = [(0.01, height + 0.042), (0, height + 0.044)]
    solids.lathe(1, [(0, height - 0.001), *map(tuple, lid), *knob, *top], segments=28)
    start, tip = (radius * 0.85, height * 0.3, 0), (radius * 1.75, height * 0.95, 0)
    spout = bend(start, (radius * 1.4, height * 0.3, 0), tip, 10)
    solids.tube(0, spout, np.linspace(0.024, 0.011, 10), 14)
    arc = np.linspace(0.3 * np.pi, 1.62 * np.pi, 18)
    reach = radius * between(rng, 0.55, 0.7)
    grip = np.stack(
        [-radius * 0.98 - 0.75 * reach * (-np.cos(arc) * 0.9 + 0.25),
         height * 0.5 + 0.8 * reach * np.sin(arc), 0 * arc], axis=1,
    )  # fmt: skip
    inside = grip[:, 0] > -radius * 0.6
    solids.tube(2, grip[~inside], 0.0065, 10)


def plant(solids: Solids, rng: np.random.Generator) -> None:
    """A pot with a plant of broad or narrow leaves."""
    radius, height = between(rng, 0.08, 0.15), between(rng, 0.12, 0.24)
    outline = curve([(radius * between(rng, 0.6, 0.95), 0), (radius, height)], 6)
    solids.lathe(0, _hollow(outline, 0.008, height * 0.8), segments=36)
    narrow, count = chance(rng, 0.5), int(rng.integers(9, 20))
    for index in range(count):
        turn = index * 137.5 + between(rng, -20, 20)
        rise, reach = between(rng, 0.25, 0.6), between(rng, 0.1, 0.35)
        root = 0.35 * radius * np.sqrt(index / count)
        leaf = solids.placed((0, height * 0.8, 0), turn_deg=turn)
        path = bend((root, 0, 0), (root + 0.2 * reach, rise, 0), (root + reach, rise * 0.85, 0), 12)
        t = np.linspace(0, 1, 12)
        if narrow:
            section, width = flat_section(0.034, 0.004), np.clip(1.05 - t**2, 0.06, 1) ** 0.8
            leaf.sweep(1, path, section, width)
            continue
        leaf.tube(2, path[:8], 0.004, 6)
        blade = np.clip(np.sin(np.pi * t[:7] ** 0.8), 0.08, 1)
        leaf.sweep(1, bend(path[6], path[9], path[11] * [1.25, 0.95, 1], 7),
                   flat_section(between(rng, 0.08, 0.14), 0.004), blade)  # fmt: skip


def lamp(solids: Solids, rng: np.random.Generator) -> None:
    """A table or floor lamp with a shade."""
    tall = chance(rng, 0.4)
    height = between(rng, 0.75, 1.2) if tall else between(rng, 0.3, 0.55)
    shade, base = between(rng, 0.14, 0.24), between(rng, 0.08, 0.14)
    stem = between(rng, 0.008, 0.016)
    if tall or chance(rng, 0.4):
        foot = [(0, 0), (base, 0), (base * 0.97, 0.015), (stem * 2, 0.03), (stem, 0.045)]
        solids.lathe(0, [*foot, (stem, height), (0, height)], segments=32)
    else:
        belly = between(rng, 0.05, 0.11)
        knots = [(base * 0.8, 0), (belly, height * 0.3), (stem * 1.5, height * 0.7), (stem, height)]
        solids.lathe(0, [(0, 0), *map(tuple, curve(knots, 22)), (0, height)], segments=32)
    top, deep = shade * between(rng, 0.45, 1.0), between(rng, 0.14, 0.28)
    low, high, wall = height - deep * 0.35, height + deep * 0.65, 0.004
    ring = [(shade - wall, low), (shade, low), (top, high), (top - wall, high)]
    solids.lathe(1, ring, segments=40)
    bulb = np.linspace(0, np.pi, 10)
    ball = np.stack([0.03 * np.sin(bulb), height + 0.03 - 0.035 * np.cos(bulb)], axis=1)
    ball[[0, -1], 0] = 0
    solids.lathe(2, ball, segments=16)
    for turn in (0, 120, 240):
        spoke = solids.placed(turn_deg=turn)
        spoke.tube(0, [[0.0028, high - 0.02, 0], [top * 0.98, high - 0.02, 0]], 0.002, 6)
    solids.tube(0, [[0, height, 0], [0, high - 0.018, 0]], 0.003, 6)


def candlestick(solids: Solids, rng: np.random.Generator) -> None:
    """A turned candlestick with one candle, or three on arms."""
    height, base = between(rng, 0.16, 0.32), between(rng, 0.05, 0.08)
    knots = [(base, 0.0), (base * 0.9, 0.012), (0.012, height * 0.22)]
    for level in np.sort(rng.uniform(0.3, 0.85, int(rng.integers(2, 5)))):
        knots.append((between(rng, 0.008, 0.028), height * float(level)))
    knots = [
        knot
        for index, knot in enumerate(knots)
        if index < 3 or knot[1] > knots[index - 1][1] + 0.012
    ]
    knots += [(0.01, height * 0.94), (0.026, height)]
    solids.lathe(0, [(0, 0), *map(tuple, curve(knots, 40)), (0, height)], segments=24)
    spots = [(0.0, height)]
    if chance(rng, 0.35):
        reach, low = between(rng, 0.08, 0.13), height * 0.55
        for side in (-1, 1):
            path = bend(
                (0, low, 0), (side * reach, low - 0.03, 0), (side * reach, height * 0.85, 0), 12
            )
            solids.tube(0, path, 0.006, 8)
            cup = [(0, -0.008), (0.012, -0.008), (0.024, 0.006), (0, 0.006)]
            held = solids.placed((side * reach, height * 0.85, 0))
            held.lathe(0, cup, segments=16)
            spots.append((side * reach, height * 0.85 + 0.004))
    tall, thick = between(rng, 0.06, 0.2), between(rng, 0.009, 0.012)
    for x, low in spots:
        wax = [(0, low - 0.004), (thick, low - 0.004), (thick, low + tall), (0, low + tall + 0.003)]
        solids.lathe(1, wax, (x, 0), 16)
        solids.tube(2, [[x, low + tall, 0], [x, low + tall + 0.012, 0]], 0.001, 6)
