"""The nearest reference of each map: by its harmonic spectrum, and by its look at the best yaw."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.qa.sets.multivariate import log_spectra
from panokit.sphere import row_solid_angles

Array = NDArray[np.float64]

_DEGREES = slice(1, 9)
# Correlations worked on at once.
_AT_ONCE = 1 << 23
_ROWS = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class Nearest:
    """The reference maps that a map is most like.

    Attributes:
        by_spectrum: Name of the one with the most alike harmonic spectrum.
        spectrum_stops: RMS difference over degrees 1 to 8, in stops of power.
        by_look: Name of the one that looks most alike after turning it about the vertical.
        look_stops: RMS difference of 64x32 pixels of luminance, in stops, at the best yaw and
            exposure.
        yaw_deg: By how much the reference is turned to the right for that.
        correlation: Of these pixels, -1 to 1.
        own_rank: Where the map's own truth comes among all references by look, 1 for the
            first; None where it is not among them.
    """

    by_spectrum: str
    spectrum_stops: float
    by_look: str
    look_stops: float
    yaw_deg: float
    correlation: float
    own_rank: int | None = None

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return asdict(self)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Alignment:
    """Every map of one set against every map of another, each turned to fit best.

    Attributes:
        residual_stops: (n, m) RMS difference left.
        correlation: (n, m) -1 to 1.
        yaw: (n, m) radians by which the second map is turned to the right, 0 to 2 pi.
    """

    residual_stops: Array
    correlation: Array
    yaw: Array


def align(
    thumbnails: NDArray[np.float32], others: NDArray[np.float32], turns: int = 64
) -> Alignment:
    """Turn maps about the vertical until they fit each other best.

    Args:
        thumbnails: (n, H, W), each with mean 0 over the sphere.
        others: (m, H, W), likewise.
        turns: How many yaws are tried around the circle, W or a multiple of it; between the
            pixels' own the pictures are interpolated as band-limited.
    """
    height, width = thumbnails.shape[1:]
    weights = row_solid_angles(height, width) / (4 * np.pi)
    ours, theirs = (np.fft.rfft(x.astype(np.float64), axis=2) for x in (thumbnails, others))
    # Half the sampling rate has no phase, so it cannot be interpolated.
    ours[..., -1] = theirs[..., -1] = 0
    power_a, power_b = (
        np.einsum("nhw,h->n", np.square(np.fft.irfft(x, width, axis=2)), weights)
        for x in (ours, theirs)
    )
    best = np.empty((len(thumbnails), len(others)))
    place = np.empty(best.shape, np.intp)
    step = max(_AT_ONCE // (len(others) * turns), 1)
    conjugate = np.conj(theirs) * weights[:, None]
    for start in range(0, len(thumbnails), step):
        part = ours[start : start + step]
        # One matrix product for each frequency: (n, H) x (H, m).
        cross = np.matmul(part.transpose(2, 0, 1), conjugate.transpose(2, 1, 0))
        found = np.fft.irfft(cross, turns, axis=0) * (turns / width)
        place[start : start + step] = found.argmax(axis=0)
        best[start : start + step] = found.max(axis=0)
    both = power_a[:, None] + power_b - 2 * best
    norm = np.sqrt(np.maximum(power_a[:, None] * power_b, 1e-30))
    return Alignment(
        residual_stops=np.sqrt(np.maximum(both, 0.0)),
        correlation=np.clip(best / norm, -1.0, 1.0),
        yaw=np.asarray(place * (2 * np.pi / turns), np.float64),
    )


def nearest_references(
    augmented: tuple[Array, NDArray[np.float32]],
    reference: tuple[Array, NDArray[np.float32]],
    names: tuple[list[str], list[str]],
) -> list[Nearest]:
    """The nearest reference of each augmented map.

    Args:
        augmented: (n, 17) power by degree and (n, 32, 64) thumbnails.
        reference: (m, 17) and (m, 32, 64).
        names: Of the augmented maps, and of the reference maps.
    """
    ours, theirs = (log_spectra(power)[:, _DEGREES] for power in (augmented[0], reference[0]))
    known = {name: place for place, name in enumerate(names[1])}
    found = []
    for number, name in enumerate(names[0]):
        row = number % _ROWS
        if row == 0:
            looks = align(augmented[1][number : number + _ROWS], reference[1])
        apart = np.sqrt(np.square(ours[number] - theirs).mean(axis=1))
        spectrum = int(apart.argmin())
        look = int(looks.residual_stops[row].argmin())
        own = known.get(name)
        own_rank = None
        if own is not None:
            closer = looks.residual_stops[row] < looks.residual_stops[row, own]
            own_rank = int(closer.sum()) + 1
        yaw = (float(np.degrees(looks.yaw[row, look])) + 180) % 360 - 180
        found.append(
            Nearest(
                by_spectrum=names[1][spectrum],
                spectrum_stops=float(apart[spectrum]),
                by_look=names[1][look],
                look_stops=float(looks.residual_stops[row, look]),
                yaw_deg=yaw,
                correlation=float(looks.correlation[row, look]),
                own_rank=own_rank,
            )
        )
    return found
