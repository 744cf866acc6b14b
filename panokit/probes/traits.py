"""What the library finds out about a map when it is added: its kind, category, tags and sun."""

from collections.abc import Mapping
from typing import Any

from panokit.capture import Capture
from panokit.envmap import EnvironmentMap
from panokit.expand.lighting import find_sun
from panokit.provenance import Provenance
from panokit.sphere import find_lights, resize_radiance

NATIVE, LIFTED, SYNTHETIC = "native", "lifted", "synthetic"
_WIDTH_PX = 512
_STREET_PROVIDERS = ("panoramax", "mapillary", "google-tiles", "google-static")


def kind_of(capture: Capture | None, provenance: Provenance) -> str:
    """How a map came by its range: "lifted" of a photograph, "synthetic", else "native"."""
    if provenance.last("expand") is not None:
        return LIFTED
    rendered = provenance.last("synthetic") is not None
    is_made_up = capture is not None and capture.provider == "synthetic"
    return SYNTHETIC if rendered or is_made_up else NATIVE


def category_of(capture: Capture | None) -> str:
    """The kind of scene that a capture tells of, "" where it does not.

    Services of street pictures need not say it: their pictures are of streets.
    """
    if capture is None:
        return ""
    by_provider = "outdoor_street" if capture.provider in _STREET_PROVIDERS else ""
    return str(capture.details.get("scene") or by_provider)


def tags_of(capture: Capture | None) -> tuple[str, ...]:
    """The words that a source describes a picture with, lower-case, each once, in order."""
    if capture is None:
        return ()
    found = [*_words(capture.details.get("tags")), *_words(capture.details.get("categories"))]
    return tuple(sorted(set(found)))


def sun_of(envmap: EnvironmentMap) -> Mapping[str, Any] | None:
    """The sun of a map as its record gives it, or None where there is none to be sure of.

    What `expand` wrote counts; a map of another origin is looked at here, by the same rules and
    at 512 columns, where they find the same suns. By night a light like the sun is the moon.
    """
    step = envmap.provenance.last("expand")
    if step is not None and "lighting" in step.values:
        recorded = step.values["lighting"].get("sun")
        return dict(recorded) if recorded else None
    if "night" in category_of(envmap.capture) or "night" in tags_of(envmap.capture):
        return None
    radiance = resize_radiance(envmap.radiance, min(_WIDTH_PX, envmap.width_px))
    sun = find_sun(radiance, find_lights(radiance), envmap.frame, envmap.capture)
    return sun.to_json() if sun else None


def _words(value: Any) -> list[str]:
    if not isinstance(value, list | tuple):
        return []
    return [word for word in (str(one).strip().casefold() for one in value) if word]
