"""Whether the files of a sample are what the table of members says."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.storage.member_table import MemberKind, member_kind

# Half floats round a unit vector's length by up to this much.
_UNIT_SLACK = 2e-3
# The center of a pixel that is covered so much shows the object, up to a thin edge.
_SURELY, _AT_MOST_ODD = 250, 0.02
_FARTHEST_M = 500.0


def check_member(name: str, value: Any, width_px: int) -> Iterator[tuple[str, str]]:
    """What is wrong with one member: pairs of a reason and a message.

    Args:
        name: Of the member.
        value: Decoded.
        width_px: Of the pictures.
    """
    found = member_kind(name)
    if found is None:
        yield "unknown-member", "Samples have no such member."
        return
    if found.kind == "json":
        return
    if not isinstance(value, np.ndarray):
        yield "not-a-picture", "It holds no pixels."
        return
    yield from _check_size(found, value, width_px)
    if value.dtype == np.float32 and not np.isfinite(value).all():
        yield "not-finite", "It has values that are not finite."
        return
    yield from _check_values(found, value)


def _check_size(found: MemberKind, value: NDArray[Any], width_px: int) -> Iterator[tuple[str, str]]:
    channels = 2 if found.kind in ("gray", "index", "depth") else 3
    if value.ndim != channels:
        yield "wrong-channels", f"It has {value.ndim} axes, not {channels}."
    height, width = value.shape[:2]
    if found.size == "view":
        if (height, width) != (width_px, width_px):
            yield "wrong-size", f"It is {width}x{height}, not {width_px}x{width_px}."
    elif found.size == "two-to-one":
        if width != 2 * height:
            yield "wrong-size", f"It is {width}x{height}, not twice as wide as high."
    elif (width, height) != found.size:
        yield "wrong-size", f"It is {width}x{height}, not {found.size[0]}x{found.size[1]}."


def _check_values(found: MemberKind, value: NDArray[Any]) -> Iterator[tuple[str, str]]:
    if found.kind in ("linear", "map", "unit", "depth") and value.min() < 0:
        yield "negative", f"It has values down to {value.min():.3g}."
    if found.kind == "unit" and value.max() > 1 + _UNIT_SLACK:
        yield "out-of-range", f"It has values up to {value.max():.3g}; albedo ends at 1."
    if found.kind == "depth" and value.max() > _FARTHEST_M:
        yield "out-of-range", f"It has depths up to {value.max():.3g} m."
    if found.kind == "map" and not value.max() > 0:
        yield "dark", "It is black: there is no light."
    if found.kind == "normal":
        length = np.linalg.norm(value.reshape(-1, 3), axis=-1)
        odd = (np.abs(length - 1) > _UNIT_SLACK) & (length != 0)
        if odd.any():
            worst = float(length[odd][np.argmax(np.abs(length[odd] - 1))])
            yield (
                "not-unit",
                f"{int(odd.sum())} normals are not of unit length (one is {worst:.3f}).",
            )


def check_views(values: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Whether mask, normals and depth of each view show the same object.

    Args:
        values: Member -> decoded; members that are not there are not checked.

    Yields:
        Member, reason and message.
    """
    for side in ("left", "right"):
        names = (f"{side}_mask.png", f"{side}_normal.exr", f"{side}_depth.exr")
        pictures = [value for name in names if isinstance(value := values.get(name), np.ndarray)]
        if len(pictures) < len(names):
            continue
        mask, normal, depth = pictures
        if not mask.shape == normal.shape[:2] == depth.shape:
            continue  # told by `check_member`
        if not mask.any():
            yield f"{side}_mask.png", "blank-mask", "There is no object."
            continue
        has_normal = (normal != 0).any(axis=-1)
        if (has_normal != (depth > 0)).any():
            yield f"{side}_depth.exr", "depth-and-normal", "It has depth where normals are not."
        if (has_normal & (mask == 0)).any() or (
            (~has_normal & (mask >= _SURELY)).mean() > _AT_MOST_ODD
        ):
            yield (
                f"{side}_mask.png",
                "mask-and-normal",
                "It and the normals show different objects.",
            )
