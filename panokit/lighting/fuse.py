"""Several estimates as one: other views, other objects, other moments.

Each map is turned into a common frame. Logs of radiance are compared direction by direction: an
estimate that is far from the median of all counts less there. What is left is the weighted mean of
logs, with the light that a mean of logs loses added where it was lost, until the energy is right.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from panokit.equirectangular import read_only
from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.lighting.confidence import Confidence
from panokit.lighting.estimate import TARGET_PX, LightEstimate
from panokit.lighting.representations import latlong_radiance, square_radiance
from panokit.lighting.settings import VERSION
from panokit.provenance import Provenance, Step, digest_of
from panokit.reflectance.mirroring import DARKEST
from panokit.sphere import energy, rotate_radiance

# Farther from the median than so many times the usual spread, the weight of an estimate falls as
# one over its distance (Huber 1964). Spreads are of logs: a tenth at least.
_FAR, _LEAST_SPREAD = 1.5, 0.1
_ROUNDS = 5
# Without a confidence every estimate counts the same, as if off by a factor of two.
_UNKNOWN_ERROR = float(np.log(2))


def fuse_estimates(
    estimates: Sequence[LightEstimate],
    common_from_camera: Sequence[Rotation] | None = None,
    *,
    gains: Sequence[float] | None = None,
) -> LightEstimate:
    """One estimate from several of the same light.

    Args:
        estimates: At least one.
        common_from_camera: For each, the rotation from its left camera's frame to the common one;
            none of them is turned if not given. The result is in the common frame.
        gains: For each, what its radiance is multiplied with first: the exposure of the common
            pictures over that of its own, where exposures differ.

    Returns:
        The estimate, whose energy in each channel is the weighted mean of logs of energies. It is
        as sure as they are on the mean, less where they disagree; it is called calibrated if all
        are.

    Raises:
        UsageError: If there is none, or the lists have other lengths, or a gain is not over 0.
    """
    count = len(estimates)
    turns = list(common_from_camera or [Rotation.identity()] * count)
    factors = [float(gain) for gain in (gains or [1.0] * count)]
    if count == 0 or len(turns) != count or len(factors) != count:
        raise UsageError(
            f"{count} estimates with {len(turns)} rotations and {len(factors)} gains cannot be "
            "fused. Give one of each for every estimate, and at least one estimate."
        )
    if not all(np.isfinite(factor) and factor > 0 for factor in factors):
        raise UsageError(f"Gains are over 0 and finite, not {factors}.")
    maps = np.stack(
        [
            _turned(one.radiance, turn) * np.float32(factor)
            for one, turn, factor in zip(estimates, turns, factors, strict=True)
        ]
    )
    errors = np.stack(
        [_turned_error(one, turn) for one, turn in zip(estimates, turns, strict=True)]
    )
    trust = (1 / np.maximum(errors, _LEAST_SPREAD) ** 2).astype(np.float64)
    fused, weights = _robust_mean(maps, trust)
    return LightEstimate(
        radiance=square_radiance(fused, TARGET_PX),
        level_from_camera=_level(estimates[0], turns[0]),
        confidence=_confidence(estimates, maps, fused, errors, weights),
        warnings=tuple(dict.fromkeys(text for one in estimates for text in one.warnings)),
        model=estimates[0].model,
        provenance=_provenance(estimates, turns, factors),
    )


def _turned(radiance: NDArray[np.float32], turn: Rotation) -> NDArray[np.float32]:
    return rotate_radiance(latlong_radiance(radiance, 2 * TARGET_PX), turn)


def _turned_error(estimate: LightEstimate, turn: Rotation) -> NDArray[np.float32]:
    """The expected error in each direction of the common frame, (64, 128)."""
    if estimate.confidence is None:
        return np.full((TARGET_PX, 2 * TARGET_PX), _UNKNOWN_ERROR, np.float32)
    return estimate.confidence.turned_error(turn)


def _robust_mean(
    maps: NDArray[np.float32], trust: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """The fused map (64, 128, 3), and what each counted for (N, 64, 128)."""
    logs = np.log(np.maximum(maps, _floor(maps))).astype(np.float64)
    middle = _weighted_median(logs, trust)
    weights = trust
    for _ in range(_ROUNDS):
        away = np.abs(logs - middle).mean(axis=-1)
        spread = np.maximum(_weighted_median(away[..., None], trust)[..., 0], _LEAST_SPREAD)
        weights = trust * np.minimum(1.0, _FAR * spread / np.maximum(away, 1e-9))
        middle = (weights[..., None] * logs).sum(axis=0) / weights.sum(axis=0)[..., None]
    share = weights / weights.sum(axis=0)
    arithmetic = (share[..., None] * maps).sum(axis=0)
    # Below the floor of the logs the mean of radiance is as good.
    geometric = np.minimum(np.exp(middle), arithmetic)
    return _with_energy(geometric, arithmetic, _energy(maps, weights)), weights


def _floor(maps: NDArray[np.float32]) -> float:
    """What is darker than this is dark: a thousandth of the mean of all."""
    return DARKEST * max(float(maps.mean()), 1e-20)


def _energy(maps: NDArray[np.float32], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """The energy that the fused map shall have, (3,): the weighted mean of logs of all."""
    whole = np.stack([energy(one) for one in maps])
    counts = weights.mean(axis=(1, 2))
    logs = np.log(np.maximum(whole, 1e-30))
    return np.asarray(np.exp((counts[:, None] * logs).sum(axis=0) / counts.sum()))


def _with_energy(
    geometric: NDArray[np.float64], arithmetic: NDArray[np.float64], wanted: NDArray[np.float64]
) -> NDArray[np.float32]:
    """The mean of logs and as much of what it lost as gives the energy, channel by channel."""
    lost = arithmetic - geometric
    have, more = energy(geometric), energy(lost)
    part = np.divide(wanted - have, more, out=np.zeros_like(have), where=more > 1e-12)
    made = geometric + np.clip(part, 0, None) * lost
    total = energy(made)
    made *= np.divide(wanted, total, out=np.ones_like(total), where=total > 0)
    return np.ascontiguousarray(made, np.float32)


def _weighted_median(
    values: NDArray[np.float64], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The median over the first axis of values (N, H, W, C) with weights (N, H, W)."""
    order = np.argsort(values, axis=0, kind="stable")
    ranked = np.take_along_axis(values, order, axis=0)
    mass = np.take_along_axis(np.broadcast_to(weights[..., None], values.shape), order, axis=0)
    reached = np.cumsum(mass, axis=0) / mass.sum(axis=0)
    # Between the two in the middle where the weights fall into equal halves.
    first, last = (np.argmax(reached > half, axis=0)[None] for half in (0.5 - 1e-6, 0.5 + 1e-6))
    low, high = (np.take_along_axis(ranked, index, axis=0)[0] for index in (first, last))
    return np.asarray((low + high) / 2)


def _confidence(
    estimates: Sequence[LightEstimate],
    maps: NDArray[np.float32],
    fused: NDArray[np.float32],
    errors: NDArray[np.float32],
    weights: NDArray[np.float64],
) -> Confidence | None:
    known = [one.confidence for one in estimates if one.confidence is not None]
    if not known:
        return None
    share = weights / weights.sum(axis=0)
    told = (share * errors).sum(axis=0)
    floor = _floor(maps)
    logs = np.log(np.maximum(maps, floor)) - np.log(np.maximum(fused, floor))
    seen = (share * np.abs(logs).mean(axis=-1)).sum(axis=0)
    error = np.maximum(told, seen).reshape(TARGET_PX, TARGET_PX, 2).mean(axis=2)
    return Confidence(
        error=read_only(error.astype(np.float32)),
        direction_deg=float(np.mean([one.direction_deg for one in known])),
        calibrated=len(known) == len(estimates) and all(one.calibrated for one in known),
    )


def _level(first: LightEstimate, turn: Rotation) -> Rotation:
    """From the common frame to the level frame that the first estimate knows."""
    return first.level_from_camera @ turn.inverse


def _provenance(
    estimates: Sequence[LightEstimate], turns: Sequence[Rotation], gains: Sequence[float]
) -> Provenance:
    step = Step(
        stage="lighting-fuse",
        version=VERSION,
        settings_digest=digest_of([[turn.matrix.tolist() for turn in turns], list(gains)]),
        input_digests=tuple(one.provenance.digest for one in estimates),
        values={"estimates": len(estimates), "latlong_px": 2 * TARGET_PX},
    )
    return estimates[0].provenance.then(step)
