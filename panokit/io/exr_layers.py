"""Channel names of an EXR file as layers, and which of them is the picture.

OpenEXR separates layer from channel by a dot: `diffuse.R`, `ViewLayer.Combined.R`. A layer
without a name has the channels R, G, B. Luminance and chroma are Y, RY, BY; a channel Y alone
is gray. (OpenEXR, "Technical Introduction", layers and channel names.)
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from panokit.errors import ImageError

_COLORS = {"r": "R", "g": "G", "b": "B", "red": "R", "green": "G", "blue": "B"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """One picture in a part.

    Attributes:
        name: "" for the plain one.
        kind: "rgb", "luma-chroma" or "gray".
        channels: Names in the file: R, G, B; or Y, RY, BY; or the one channel.
    """

    name: str
    kind: str
    channels: tuple[str, ...]


def layers_of(channels: Iterable[str]) -> list[Layer]:
    """The layers that hold a color picture, the plain one first, then by name."""
    groups: dict[str, dict[str, str]] = {}
    for channel in channels:
        layer, _, last = channel.rpartition(".")
        groups.setdefault(layer, {}).setdefault(_COLORS.get(last.lower(), last), channel)
    found = []
    for name in sorted(groups):
        group = groups[name]
        for kind, wanted in (("rgb", "RGB"), ("luma-chroma", ("Y", "RY", "BY"))):
            if group.keys() >= set(wanted):
                names = tuple(group[one] for one in wanted)
                found.append(Layer(name=name, kind=kind, channels=names))
                break
    return found


def choose_layer(channels: Sequence[str], layer: str | None, what: str) -> Layer:
    """The layer that was asked for, or the only one there is to take.

    Args:
        channels: All names in the part.
        layer: A name, "" for the plain R, G, B, or None for whichever is clear. The name of
            a single channel takes it as gray.
        what: The file, for messages.

    Raises:
        ImageError: If there is none, or several and none was named; the message lists them.
    """
    layers = layers_of(channels)
    if layer is not None:
        for one in layers:
            if one.name == layer:
                return one
        if layer in channels:
            return Layer(name=layer, kind="gray", channels=(layer,))
        raise _refusal(f"{what} has no layer {layer!r}", channels, layers)
    plain = [one for one in layers if not one.name]
    if plain or len(layers) == 1:
        return (plain or layers)[0]
    if layers:
        raise _refusal(f"{what} has {len(layers)} layers and none without a name", channels, layers)
    if len(set(channels) - {"A"}) == 1:
        name = next(one for one in channels if one != "A")
        raise ImageError(
            f"{what} has one channel, {name}; a map of light has R, G and B. "
            f"If it is meant to be gray, read it with layer={name!r}.",
            reason="wrong-channels",
            values={"channels": sorted(channels)},
        )
    raise _refusal(f"{what} has no channels R, G and B", channels, layers)


def _refusal(problem: str, channels: Sequence[str], layers: Sequence[Layer]) -> ImageError:
    names = ", ".join(sorted(channels)) or "none"
    if layers:
        known = ", ".join(repr(one.name) for one in layers)
        remedy = f"Choose one with layer=: {known}."
    else:
        remedy = f"It has: {names}. Export the layer you want as plain RGB."
    return ImageError(
        f"{problem}. {remedy}",
        reason="wrong-channels",
        values={"channels": sorted(channels), "layers": [one.name for one in layers]},
    )
