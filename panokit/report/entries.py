"""A light map as an entry of a gallery, with what it can be compared with."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.envmap import Anchor, EnvironmentMap
from panokit.report.layers import photo_layer, radiance_layer
from panokit.report.pictures import display_gain, thumbnail
from panokit.report.values import MapEntry
from panokit.sphere import irradiance_map

_BALL_WHITE = 0.8
_UNITS: Mapping[Anchor, str] = {
    Anchor.RELATIVE: "",
    Anchor.LDR_WHITE: "× white",
    Anchor.LUMINANCE: "cd/m²",
    Anchor.RADIANCE: "W/(sr m²)",
}


def light_map(
    envmap: EnvironmentMap,
    name: str,
    *,
    label: str = "Light map",
    photos: Mapping[str, NDArray[np.uint8]] | None = None,
    references: Mapping[str, tuple[EnvironmentMap, float]] | None = None,
    width_px: int = 512,
    **words: Any,
) -> MapEntry:
    """An entry of a gallery from a map and what it can be compared with.

    Args:
        envmap: The map.
        name: What it is called; unique within the gallery.
        label: What the map is, in the viewer.
        photos: Label -> (H, 2 H, 3) uint8 photographs of the same place, such as the
            panorama that the map was made of. Their white stands at the map's 1.0 if that is
            what the map is anchored at, else they are exposed as the map is shown.
        references: Label -> another map, and what its radiance is multiplied by to stand on
            this map's scale.
        width_px: The most that the maps may be wide in the page; `layer_width_px` tells.
        **words: The fields of `MapEntry` that say what is known of the map: badge, category,
            figures, subtitle, summary, facts.
    """
    shown = display_gain(envmap)
    white = 1.0 if envmap.anchor is Anchor.LDR_WHITE else 1 / shown
    layers = [radiance_layer(envmap.radiance, label, width_px=width_px)]
    for title, (reference, gain) in (references or {}).items():
        layers.append(radiance_layer(reference.radiance, title, width_px=width_px, gain=gain))
    for title, pixels in (photos or {}).items():
        layers.append(photo_layer(pixels, title, width_px=width_px, gain=white))
    return MapEntry(
        name=name,
        thumbnail=thumbnail(envmap, name),
        layers=tuple(layers),
        display_gain=shown,
        ball_gain=_ball_gain(envmap),
        unit=_UNITS[envmap.anchor],
        **words,
    )


def _ball_gain(envmap: EnvironmentMap) -> float:
    """What brings the lit side of a white ball to just below white."""
    reflected = luminance(irradiance_map(envmap.radiance, 16)) / np.float32(np.pi)
    lit = float(np.percentile(reflected, 95))
    return _BALL_WHITE / lit if lit > 0 else 1.0
