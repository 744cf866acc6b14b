"""What the files of a sample are: the one table that cards, checks and documentation use."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

Kind = Literal["rgb", "gray", "index", "normal", "depth", "linear", "unit", "map", "json"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MemberKind:
    """One kind of file.

    Attributes:
        kind: What its values are, for checks.
        what: For people.
        size: "view" for the size of the pictures, "two-to-one", or width and height.
    """

    kind: Kind
    what: str
    size: Literal["view", "two-to-one"] | tuple[int, int] = "view"


_SIDES = ("left", "right")
_OF_VIEW = {
    ".png": MemberKind(kind="rgb", what="the {side} view over its background, camera-encoded"),
    "_object.png": MemberKind(kind="rgb", what="the object of the {side} view on black"),
    "_mask.png": MemberKind(kind="gray", what="how much of each pixel the object covers, {side}"),
    "_material.png": MemberKind(kind="index", what="material plus one, {side}"),
    "_normal.exr": MemberKind(kind="normal", what="normals in the {side} camera's frame, half"),
    "_depth.exr": MemberKind(kind="depth", what="meters along the {side} view's axis, half"),
    ".exr": MemberKind(kind="linear", what="linear radiance of the {side} view"),
}
_OTHERS = {
    "background.png": MemberKind(kind="rgb", what="the left view's background alone"),
    "right_background.png": MemberKind(kind="rgb", what="the right view's background alone"),
    "albedo.exr": MemberKind(kind="unit", what="base color of the left view, half"),
    "env64.exr": MemberKind(
        kind="map", what="the light in the left camera's frame, lat-long, 64x64", size=(64, 64)
    ),
    "env.exr": MemberKind(
        kind="map", what="the same at its true proportions, 256x128 at most", size="two-to-one"
    ),
    "meta.json": MemberKind(kind="json", what="all that is known of the sample"),
}
_REFLECTANCE = MemberKind(
    kind="map", what="a sphere of the sample's material in the same light", size=(64, 64)
)
_VIEW_ENDINGS = tuple(_OF_VIEW)
# In the order in which people want to see them.
_ORDER = (
    *(f"{side}{ending}" for side in _SIDES for ending in _VIEW_ENDINGS),
    *("background.png", "right_background.png", "albedo.exr", "env64.exr", "env.exr"),
    *("reflectance.exr", "reflectance_1.exr", "reflectance_2.exr", "reflectance_3.exr"),
    "meta.json",
)
_SOMETIMES = {"right_background.png", "albedo.exr"}
# What every sample has, besides reflectance maps.
ALWAYS = tuple(
    name
    for name in _ORDER
    if name not in _SOMETIMES
    and not name.startswith("reflectance")
    and not name.endswith(("_material.png", "left.exr", "right.exr"))
)


def member_kind(name: str) -> MemberKind | None:
    """What a member is by its name, or None if samples have none such."""
    if name in _OTHERS:
        return _OTHERS[name]
    if name.startswith("reflectance") and name.endswith(".exr"):
        return _REFLECTANCE
    side = next((side for side in _SIDES if name.startswith(side)), None)
    return _OF_VIEW.get(name.removeprefix(side)) if side else None


def meaning_of(name: str) -> str:
    """What a member is, for people."""
    found = member_kind(name)
    if found is None:
        return ""
    return found.what.format(side="right" if name.startswith("right") else "left")


def in_order(names: Iterable[str]) -> tuple[str, ...]:
    """Members in the order of the documentation; those it does not know come last."""
    return tuple(sorted(names, key=lambda name: (_place(name), name)))


def _place(name: str) -> int:
    return _ORDER.index(name) if name in _ORDER else len(_ORDER)
