"""All figures of predicted maps against their truth."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from panokit.color.hdr_coding import ColorCode, HdrCoding
from panokit.frames import angle_between
from panokit.metrics.brightest import brightest_px, dominance_ratio
from panokit.metrics.light_blobs import LightBlob, find_light_blobs
from panokit.metrics.light_matching import MOST_LIGHTS, match_lights
from panokit.metrics.protocols import protocol
from panokit.metrics.similarity import ssim_map
from panokit.metrics.transport import transport
from panokit.reflectance import hemisphere_normals
from panokit.sphere import resize_radiance

Map = NDArray[np.float32]

# The coding that all predictions are compared in, whatever their network's own: that of the
# recipes. The thesis's curves are sums of squared differences of such numbers.
CODING = HdrCoding(brightest=1e3, color=ColorCode.LAB)
IN_CODE = ("code-l1", "code-ssd")
# On the thesis's own 64x64 pictures.
ON_TARGET = (
    "thesis-mse", "thesis-ssd", "thesis-dssim", "thesis-dssim-log", "thesis-brightest-luma",
    "thesis-brightest-rgb",
)  # fmt: skip
WRAPPED = "brightest-luma-wrapped"
# On the sphere: 64x32, equal energy.
ON_SPHERE = (
    "l1", "log-rmse", "si-rmse", "rgb-angular", "dssim-sphere", "irradiance-mean", "energy-ratio",
    "light-vector", "peak", "brightest",
)  # fmt: skip
OF_LIGHTS = ("lights-angle-deg", "lights-missed", "lights-spurious")
OF_CONTROLS = (*IN_CODE, "light-vector")
RELIT = (
    "relit-diffuse-rmse", "relit-diffuse-si-rmse", "relit-glossy-0.3-rmse",
    "relit-glossy-0.3-si-rmse", "relit-mirror-rmse", "relit-mirror-si-rmse", "relit-plane-rmse",
    "relit-plane-si-rmse",
)  # fmt: skip
DOMINANCE = "dominance"
FIGURES = (*IN_CODE, *ON_TARGET, WRAPPED, *ON_SPHERE, *OF_LIGHTS, *RELIT)
# Of reflectance maps, over the half sphere that faces the camera.
ON_REFLECTANCE = (
    "reflectance-l1", "reflectance-mse", "reflectance-code-l1", "reflectance-code-ssd",
    "reflectance-dssim",
)  # fmt: skip
_WIDTH_PX, _HEIGHT_PX = 64, 32
# Predictions relit at once: the sparse operators are read once for all of them.
_AT_ONCE = 24


def score_map(estimate: Map, truth: Map) -> dict[str, float]:
    """The figures of one prediction, see `score_maps`."""
    return score_maps([estimate], truth)[0]


def score_maps(estimates: Sequence[Map], truth: Map) -> list[dict[str, float]]:
    """For each prediction the `FIGURES` by name, and the truth's dominance ratio.

    Args:
        estimates: (64, 64, 3) linear radiance each, anamorphic, on the scale of the truth.
        truth: As `estimates`.
    """
    true = resize_radiance(truth, _WIDTH_PX, _HEIGHT_PX)
    flats = [resize_radiance(one, _WIDTH_PX, _HEIGHT_PX) for one in estimates]
    dominance, lights = dominance_ratio(true), find_light_blobs(true)[:MOST_LIGHTS]
    true_code = CODING.encode(truth)
    scores = []
    for estimate, flat, relit in zip(estimates, flats, _relit(flats, true), strict=True):
        row = _in_code(estimate, true_code)
        row |= {name: protocol(name).score(estimate, truth) for name in ON_TARGET}
        row[WRAPPED] = brightest_px(estimate, truth, wrap="columns")
        results: dict[tuple[str, str], object] = {}
        for name in ON_SPHERE:
            entry = protocol(name)
            call = entry.function, repr(entry.options)
            if call not in results:
                results[call] = entry.result(flat, true)
            row[name] = entry.part_of(results[call])
        scores.append({**row, **_lights(flat, lights), **relit, DOMINANCE: dominance})
    return scores


def score_spoiled(estimate: Map, truth: Map) -> dict[str, float]:
    """The figures `OF_CONTROLS`, which take a tenth of the time of all of them."""
    flat, true = (resize_radiance(one, _WIDTH_PX, _HEIGHT_PX) for one in (estimate, truth))
    light = protocol("light-vector").score(flat, true)
    return {**_in_code(estimate, CODING.encode(truth)), "light-vector": light}


def _in_code(estimate: Map, true_code: Map) -> dict[str, float]:
    difference = CODING.encode(estimate).astype(np.float64) - true_code
    return {"code-l1": float(np.abs(difference).mean()),
            "code-ssd": float((difference**2).sum())}  # fmt: skip


def _lights(guess: Map, true: tuple[LightBlob, ...]) -> dict[str, float]:
    """What `panokit.metrics.light_matching.light_errors` gives, the true lights known already."""
    found = find_light_blobs(guess)[:MOST_LIGHTS]
    pairs = match_lights(found, true)
    angles = [np.degrees(angle_between(a.direction, b.direction)) for a, b in pairs]
    return {
        "lights-angle-deg": float(np.mean(angles)) if angles else float("nan"),
        "lights-missed": float(len(true) - len(pairs)),
        "lights-spurious": float(len(found) - len(pairs)),
    }


def _relit(estimates: Sequence[Map], truth: Map) -> list[dict[str, float]]:
    """What `panokit.metrics.relit.relit_errors` gives, for many estimates at once."""
    rows: list[dict[str, float]] = [{} for _ in estimates]
    for scene in dict.fromkeys(protocol(name).options["scene"] for name in RELIT):
        operator = transport(scene, _WIDTH_PX)
        weights = operator.alpha.astype(np.float64)
        seen = weights > 0
        weights = weights[seen] / weights.sum()
        true = operator.forward(truth)[seen].astype(np.float64)
        for first in range(0, len(estimates), _AT_ONCE):
            several = estimates[first : first + _AT_ONCE]
            lit = operator.forward(np.concatenate(several, axis=-1))[seen]
            for number in range(len(several)):
                guess = lit[:, 3 * number : 3 * number + 3].astype(np.float64)
                power = float(((guess**2).sum(axis=1) * weights).sum())
                shared = float(((guess * true).sum(axis=1) * weights).sum())
                alpha = shared / power if power > 0 else 0.0
                rows[first + number] |= {
                    f"relit-{scene}-rmse": _rms(guess - true, weights),
                    f"relit-{scene}-si-rmse": _rms(alpha * guess - true, weights),
                }
    return rows


def _rms(difference: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    return float(np.sqrt(((difference**2).mean(axis=1) * weights).sum()))


def score_reflectance(estimate: Map, truth: Map) -> dict[str, float]:
    """The figures `ON_REFLECTANCE` of a dense reflectance map.

    Args:
        estimate: (S, S, 3) linear radiance on the grid of `hemisphere_normals`.
        truth: As `estimate`.
    """
    inside = hemisphere_normals(truth.shape[0])[1]
    guess, true = (np.where(inside[..., None], one, 0).astype(np.float64)
                   for one in (estimate, truth))  # fmt: skip
    difference = (guess - true)[inside]
    code = (CODING.encode(guess).astype(np.float64) - CODING.encode(true))[inside]
    similarity = ssim_map(guess, true, "thesis").mean(axis=-1)[inside]
    return {
        "reflectance-l1": float(np.abs(difference).mean()),
        "reflectance-mse": float((difference**2).mean()),
        "reflectance-code-l1": float(np.abs(code).mean()),
        "reflectance-code-ssd": float((code**2).sum()),
        "reflectance-dssim": float((1 - similarity.mean()) / 2),
    }
