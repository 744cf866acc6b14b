"""The stage `expand`: an LDR panorama in, an HDR environment map out."""

from collections.abc import Callable, Mapping
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError, ModelError
from panokit.expand.anchoring import find_scale
from panokit.expand.baselines import area_gains, expand_area, expand_reinhard, expand_srgb
from panokit.expand.components import find_components
from panokit.expand.features import CONTRAST_WIDTH_PX
from panokit.expand.lighting import NO_HINT, SunHint, describe_lighting, sun_hint
from panokit.expand.network import TASK, Prediction, compose, load_network, predict
from panokit.expand.reduce import ReducedPanorama, reduce_panorama
from panokit.expand.settings import VERSION, ExpandSettings
from panokit.expand.strips import WIDEST_WHOLE_PX, compose_wide, formula_wide, multiply_wide
from panokit.panorama import Panorama
from panokit.provenance import Step
from panokit.sphere import energy, resize_radiance
from panokit.weights import find_model, released_models

ANALYTIC: Mapping[str, Callable[[ReducedPanorama], NDArray[np.float32]]] = {
    "srgb": expand_srgb,
    "reinhard": expand_reinhard,
    "area": expand_area,
}
# A picture with less that is not burnt out says nothing of the scene's light.
LEAST_CLEAR_SHARE = 0.005
# Codes up to this are a black picture's noise.
BLACK_CODE = 2


def expand(panorama: Panorama, settings: ExpandSettings | None = None) -> EnvironmentMap:
    """Recover the radiance behind a panorama.

    A radiance of 1.0 is the level at which the picture clipped, unless an anchor of the settings
    makes it absolute. Frame and capture stay those of the panorama. Where nothing is burnt
    out, nothing is added. The map is never wider than the panorama: one that is narrower than
    `settings.width_px` keeps its own width, and the step in the provenance says so.

    Args:
        panorama: Any size from 16x8; a network needs 128x64.
        settings: Of the stage; the defaults if not given.

    Raises:
        ImageError: If the panorama is black, or burnt out everywhere, or too small for the
            network; or if it does not show what the anchor speaks of.
        ModelError: If the model is not known, or its files are damaged.
    """
    settings = settings or ExpandSettings()
    digest = weights_digest(settings.model)
    _check_lit(panorama.pixels)
    width_px = min(settings.width_px, panorama.width_px)
    # A network looks at details that a narrower map would no longer show, and at no finer ones
    # than this: wider maps are composed in strips from what it said of the whole.
    working_px = min(max(width_px, CONTRAST_WIDTH_PX), panorama.width_px, WIDEST_WHOLE_PX)
    reduced = reduce_panorama(panorama.pixels, working_px)
    _check_clear(reduced)
    whole, found, prediction = _expanded(panorama.pixels, reduced, settings, width_px)
    # Lights are the same on a small copy, and need far less memory.
    view = resize_radiance(whole, working_px)
    hint = NO_HINT
    if prediction is not None:
        where = sun_hint(view, prediction.components.labels, prediction.sun)
        hint = SunHint(direction=where, looked=prediction.looks_for_sun)
    radiance = resize_radiance(whole, width_px)
    small = view if width_px > working_px else radiance
    scale = find_scale(small, settings, panorama.frame, panorama.capture, hint)
    if scale.by:
        radiance, small = (
            np.multiply(light, np.float32(scale.factor), dtype=np.float32)
            for light in (radiance, small)
        )
    lighting = describe_lighting(
        small,
        panorama.frame,
        panorama.capture,
        most_lights=settings.most_lights,
        harmonics_order=settings.harmonics_order,
        hint=hint,
        range_at=None if prediction is None else prediction.range_at,
    )
    step = Step(
        stage="expand",
        version=VERSION,
        settings_digest=settings.digest,
        weights_digest=digest,
        values={
            "model": settings.model,
            "width_px": width_px,
            "width_limited_by_panorama": width_px < settings.width_px,
            "burnt_share": round(reduced.burnt_share, 6),
            "energy_before": _rounded(energy(reduced.linear)),
            "energy_after": _rounded(energy(small)),
            "scale": {"factor": float(f"{scale.factor:.6g}"), "by": scale.by or "clip level"},
            **found,
            "lighting": lighting,
        },
    )
    return EnvironmentMap(
        radiance=radiance,
        frame=panorama.frame,
        anchor=scale.anchor,
        capture=panorama.capture,
        provenance=panorama.provenance.then(step),
    )


def weights_digest(model: str) -> str:
    """The digest of a model's weights, "" for an analytic method.

    Raises:
        ModelError: If there is no model or method of this name; the message lists them.
    """
    if model in ANALYTIC:
        return ""
    own = [released.id for released in released_models() if released.task == TASK]
    names = [*own, *ANALYTIC]
    if model not in names:
        near = get_close_matches(model, names, n=1)
        hint = f"Did you mean {near[0]!r}? " if near else ""
        raise ModelError(f"There is no model {model!r}. {hint}Choose from: {', '.join(names)}.")
    return find_model(model).digest


def _expanded(
    pixels: NDArray[np.uint8], reduced: ReducedPanorama, settings: ExpandSettings, width_px: int
) -> tuple[NDArray[np.float32], dict[str, Any], Prediction | None]:
    """Radiance, at least as wide as `reduced`; what the model found; what its network said."""
    is_wide = width_px > reduced.width_px
    if settings.model in ANALYTIC:
        if is_wide:
            return _formula_wide(pixels, reduced, settings.model, width_px), {}, None
        return ANALYTIC[settings.model](reduced), {}, None
    prediction = predict(reduced, load_network(settings.model, settings.device))
    gains = prediction.energy[1:] / prediction.components.energy
    found = {
        "curve_slopes": [round(slope, 4) for slope in prediction.curve_slopes],
        "component_gains": [round(float(gain), 3) for gain in gains],
        "component_gain_ranges": [
            [round(float(gain), 3) for gain in pair] for pair in prediction.gain_ranges
        ],
        "component_sun": [round(float(p), 3) for p in prediction.sun],
    }
    if is_wide:
        return compose_wide(pixels, width_px, reduced, prediction), found, prediction
    return compose(reduced, prediction), found, prediction


def _formula_wide(
    pixels: NDArray[np.uint8], reduced: ReducedPanorama, model: str, width_px: int
) -> NDArray[np.float32]:
    if model == "area":
        components = find_components(reduced)
        return multiply_wide(pixels, width_px, components, area_gains(components))
    return formula_wide(pixels, width_px, ANALYTIC[model])


def _check_lit(pixels: NDArray[np.uint8]) -> None:
    if int(pixels.max()) <= BLACK_CODE:
        raise ImageError(
            "This picture is black: there is no light in it to expand. Take it with a longer "
            "exposure.",
            reason="black",
        )


def _check_clear(reduced: ReducedPanorama) -> None:
    if 1 - reduced.burnt_share < LEAST_CLEAR_SHARE:
        raise ImageError(
            f"{reduced.burnt_share:.1%} of this picture are burnt out: nothing in it tells how "
            "much light there was. Take it with a shorter exposure.",
            reason="burnt-out",
            values={"burnt_share": round(reduced.burnt_share, 6)},
        )


def _rounded(values: NDArray[np.float64]) -> list[float]:
    return [round(float(value), 6) for value in values]
