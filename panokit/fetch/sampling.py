"""Points that cover an area evenly, the same every time, and extendable without moving any."""

import hashlib
from collections.abc import Iterator
from itertools import count

from panokit.errors import PlaceError
from panokit.fetch.geodesy import LatLon, offset
from panokit.fetch.places import Place

# The R2 sequence: x_n = frac(x_0 + n a), with a from the plastic number g, the real root of
# x^3 = x + 1. It is the two-dimensional form of the golden-ratio sequence (M. Roberts, "The
# unreasonable effectiveness of quasirandom sequences", 2018).
_PLASTIC = 1.324717957244746
_STEP = (1 / _PLASTIC, 1 / _PLASTIC**2)
_MOST_MISSES = 100_000


def sample_points(place: Place, seed: int = 0) -> Iterator[LatLon]:
    """Points (latitude, longitude) of an area, without end, evenly by ground area.

    The first N are the same however many are taken, and differ by place and seed. Of a place
    that lists its points, those, in their order.

    Raises:
        PlaceError: If next to nothing of the place's box belongs to the place.
    """
    if place.points:
        yield from place.points
        return
    misses = 0
    start_x, start_y = _start(place.name, seed)
    for n in count():
        x = (start_x + n * _STEP[0]) % 1.0
        y = (start_y + n * _STEP[1]) % 1.0
        east_m = (2 * x - 1) * place.half_width_m
        north_m = (2 * y - 1) * place.half_height_m
        point = offset(place.center_deg, east_m, north_m)
        if place.contains(point):
            misses = 0
            yield point
            continue
        misses += 1
        if misses > _MOST_MISSES:
            raise PlaceError(
                f"The area {place.name!r} is too thin to look around in: next to nothing of its "
                "box belongs to it. Split it, or list points instead."
            )


def _start(name: str, seed: int) -> tuple[float, float]:
    # Python's own hash() differs from run to run.
    digest = hashlib.sha256(f"{name}\n{seed}".encode()).digest()
    x, y = int.from_bytes(digest[:6], "big"), int.from_bytes(digest[6:12], "big")
    return x / 2**48, y / 2**48
