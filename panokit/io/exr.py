"""OpenEXR maps as users have them: any layout, layer, part, tiling and primaries.

Written files are float32 ZIP RGB with the lat-long `envmap` attribute and panokit's own.
"""

import errno
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import Imath
import numpy as np
import OpenEXR
from numpy.typing import NDArray

from panokit.color.primaries import REC709
from panokit.errors import ImageError, UsageError
from panokit.io.exr_color import file_primaries, rgb_from_luma_chroma, to_rec709
from panokit.io.exr_cube import equirect_from_exr_cube
from panokit.io.exr_header import (
    ExrPart,
    Window,
    choose_part,
    damaged,
    read_exr_parts,
)
from panokit.io.exr_layers import Layer, choose_layer
from panokit.io.files import atomic_write
from panokit.io.finite import check_finite, repaired

COMPRESSIONS = (
    "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab",
)  # fmt: skip
# Half floats end at 65504; DWAA and DWAB turn values from about 65000 into infinity.
_HALF_TOP = 60000.0
_SMALLEST_NORMAL_HALF = 2.0**-14
# The largest chunk of any compression has 256 rows; strips of whole chunks decode each once.
_STRIP_ROWS = 256
_LAYOUT_NOTE = (
    "Latitude-longitude map. Pixel edges, not centers, lie on the borders: column i has its "
    "center at u = (i + 0.5) / width; row 0 touches the zenith. Directions follow the OpenEXR "
    "lat-long convention (+Y up, center +Z); in panokit's own frame the center is -Z."
)


def read_exr(
    path: Path,
    *,
    layer: str | None = None,
    part: int | str | None = None,
    repair: bool = False,
) -> tuple[NDArray[np.float32], dict[str, str]]:
    """The pixels of an EXR file as linear Rec.709, and its `panokit:` attributes.

    Half floats and integers are widened, luminance-chroma and other primaries converted, a
    cube map unrolled, a cropped data window placed in its display window (a file with an
    `envmap` attribute is its data window), and the factor of a half file of panokit's own
    divided out. Alpha is ignored: radiance has none.

    Args:
        path: The file.
        layer: Of several layers, this one ("diffuse"); "" is the plain R, G, B. The name of
            a single channel reads it as gray.
        part: Of several parts, this one, by number or name.
        repair: Take NaN as 0 and infinities as the largest finite value.

    Returns:
        (H, W, 3) float32 and the attributes, without their prefix.

    Raises:
        ImageError: If it is no readable EXR, holds no RGB picture or several, is deep, or has
            NaN or infinite values.
        StorageError: If the file cannot be opened.
    """
    path = Path(path)
    source = _choose(path, layer, part)
    shape = (source.shown.height_px, source.shown.width_px, 3)
    pixels: NDArray[np.float32] | None = None
    for top, strip in _strips(source):
        if pixels is None:
            # Only now: a file that lies about its size has failed before.
            pixels = np.empty(shape, np.float32)
        pixels[top : top + len(strip)] = strip
    if pixels is None:
        raise damaged(path, "no rows")
    if repair:
        pixels = repaired(pixels)
    check_finite(pixels, str(path), _why_not_finite(source))
    if source.part.attributes.get("envmap") == OpenEXR.ENVMAP_CUBE:
        pixels = equirect_from_exr_cube(pixels, path)
    return pixels, {
        name.removeprefix("panokit:"): str(value)
        for name, value in source.part.attributes.items()
        if name.startswith("panokit:") and isinstance(value, str | int | float)
    }


def iterate_exr_rows(
    path: Path, *, layer: str | None = None, part: int | str | None = None
) -> Iterator[tuple[int, NDArray[np.float32]]]:
    """The same picture in strips of 256 rows from the top, in the memory of about two strips.

    Parts after the first and subsampled chroma are decoded whole, as the OpenEXR package has
    no other way.

    Yields:
        The first row of the strip, and its pixels (rows, W, 3) float32.

    Raises:
        ImageError: As `read_exr`; a cube map cannot be read in strips.
    """
    path = Path(path)
    source = _choose(path, layer, part)
    if source.part.attributes.get("envmap") == OpenEXR.ENVMAP_CUBE:
        raise ImageError(
            f"{path} is a cube map, which has no rows of a sphere. Read it with read_exr.",
            reason="wrong-projection",
        )
    for top, strip in _strips(source):
        check_finite(strip, str(path), _why_not_finite(source))
        yield top, strip


class _Source:
    """What is to be read: a layer of a part, and the window that it fills."""

    def __init__(self, path: Path, part: ExrPart, layer: Layer, parts: int) -> None:
        self.path, self.part, self.layer = path, part, layer
        is_map = "envmap" in part.attributes
        self.shown: Window = part.data_window if is_map else part.display_window
        self.primaries = file_primaries(path, part.attributes)
        self.gain = 1 / _scale_of(path, part)
        self.parts = parts
        self.in_strips = parts == 1 and not part.subsampled
        self.is_half = False  # known once rows are read


def _choose(path: Path, layer: str | None, part: int | str | None) -> _Source:
    parts = read_exr_parts(path)
    chosen = choose_part(path, parts, part)
    return _Source(path, chosen, choose_layer(chosen.channels, layer, str(path)), len(parts))


def _strips(source: _Source) -> Iterator[tuple[int, NDArray[np.float32]]]:
    """Strips of the shown window, converted; black where nothing is stored."""
    data, shown = source.part.data_window, source.shown
    stored = _strips_in_file(source) if source.in_strips else _whole_part(source)
    same = data == shown
    black = np.zeros((1, shown.width_px, 3), np.float32)
    done = shown.top
    for top, planes in stored:
        strip = to_rec709(_rgb(source, planes), source.primaries, source.gain)
        if same:
            yield top - shown.top, strip
            continue
        first, last = max(top, shown.top), min(top + len(strip) - 1, shown.bottom)
        if first > last:
            continue
        if first > done:
            yield done - shown.top, np.repeat(black, first - done, axis=0)
        placed = np.repeat(black, last - first + 1, axis=0)
        left, right = max(data.left, shown.left), min(data.right, shown.right)
        if left <= right:
            placed[:, left - shown.left : right - shown.left + 1] = strip[
                first - top : last - top + 1, left - data.left : right - data.left + 1
            ]
        yield first - shown.top, placed
        done = last + 1
    if not same and done <= shown.bottom:
        yield done - shown.top, np.repeat(black, shown.bottom - done + 1, axis=0)


def _strips_in_file(source: _Source) -> Iterator[tuple[int, list[NDArray[np.float32]]]]:
    window = source.part.data_window
    as_float = Imath.PixelType(Imath.PixelType.FLOAT)
    names = list(source.layer.channels)
    try:
        file = OpenEXR.InputFile(str(source.path))
        if not file.isComplete():
            raise damaged(source.path, "some of its rows were never written")
        types = file.header()["channels"]
        source.is_half = any(str(types[name].type) == "HALF" for name in names)
        for top in range(window.top, window.bottom + 1, _STRIP_ROWS):
            last = min(top + _STRIP_ROWS - 1, window.bottom)
            planes = file.channels(names, as_float, top, last)
            yield top, [np.frombuffer(p, np.float32).reshape(-1, window.width_px) for p in planes]
        file.close()
    except (OSError, RuntimeError, ValueError, TypeError, KeyError) as error:
        raise damaged(source.path, error) from error


def _whole_part(source: _Source) -> Iterator[tuple[int, list[NDArray[np.float32]]]]:
    try:
        with OpenEXR.File(str(source.path), separate_channels=True) as file:
            # The package drops a part that it cannot decode, and only warns.
            if len(file.parts) != source.parts:
                raise damaged(source.path, f"only {len(file.parts)} of {source.parts} parts")
            channels = file.parts[source.part.index].channels
            planes = [
                np.array(channels[name].pixels).astype(np.float32, copy=False)
                for name in source.layer.channels
            ]
    except ImageError:
        raise
    except Exception as error:  # the package raises bare RuntimeError and ValueError
        raise damaged(source.path, error) from error
    if planes[0].shape != (source.part.data_window.height_px, source.part.data_window.width_px):
        raise ImageError(
            f"{source.path} stores its channels at different sizes. Export it without subsampling.",
            reason="wrong-channels",
        )
    yield source.part.data_window.top, planes


def _rgb(source: _Source, planes: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    if source.layer.kind == "luma-chroma":
        return rgb_from_luma_chroma(planes[0], planes[1], planes[2], source.primaries)
    if source.layer.kind == "gray":
        planes = planes * 3
    if len({plane.shape for plane in planes}) != 1:
        raise ImageError(
            f"{source.path} stores R, G and B at different sizes. Export it without subsampling.",
            reason="wrong-channels",
        )
    pixels = np.empty((*planes[0].shape, 3), np.float32)
    for index, plane in enumerate(planes):
        pixels[..., index] = plane
    return pixels


def _why_not_finite(source: _Source) -> str:
    if source.part.compression in ("DWAA", "DWAB"):
        return "DWAA and DWAB turn values near 65504, such as a sun, into infinity."
    if source.is_half:
        return "Half floats end at 65504; a brighter sun became infinity."
    return ""


def _scale_of(path: Path, part: ExrPart) -> float:
    try:
        scale = float(part.attributes.get("panokit:scale", 1.0))
    except (TypeError, ValueError):
        scale = 0.0
    if not (np.isfinite(scale) and scale > 0):
        raise ImageError(
            f"{path} has a panokit:scale that cannot be divided out. Make it again.",
            reason="bad-exposure",
        )
    return scale


def write_exr(
    path: Path,
    radiance: NDArray[np.floating[Any]],
    attributes: Mapping[str, Any] | None = None,
    *,
    half: bool = False,
    compression: str = "zip",
) -> None:
    """Write radiance as a lat-long EXR that other tools take too, atomically.

    Args:
        path: The file.
        radiance: (H, W, 3), linear Rec.709, finite.
        attributes: More header attributes, standard (`owner`, `latitude`, ...) or `panokit:`.
        half: Store half floats. Values beyond their range are then scaled down by a power of
            two, which `panokit:scale` records; `read_exr` divides it out. A `whiteLuminance`
            among the attributes is adapted.
        compression: One of `COMPRESSIONS`. DWAA and DWAB are lossy and store half floats
            whatever is asked, so they are scaled too; they ring round a sun, which leaves
            negative values. B44 is lossy for half floats, and PXR24 keeps 24 bits of a float.

    Raises:
        UsageError: If the array is no picture or the compression is not known.
        ImageError: If a value is not finite, or half floats cannot hold the range.
        StorageError: If the file cannot be written.
    """
    radiance = np.asarray(radiance)
    if radiance.ndim != 3 or radiance.shape[2] != 3 or radiance.size == 0:
        raise UsageError(f"An EXR map is written from (H, W, 3) pixels, not {radiance.shape}.")
    if compression not in COMPRESSIONS:
        raise UsageError(f"Unknown compression {compression!r}; choose of {COMPRESSIONS}.")
    check_finite(radiance, f"What was to be written to {path}")
    pixels = np.ascontiguousarray(radiance, np.float32)
    check_finite(pixels, f"What was to be written to {path}, as float32,")
    header = {
        "compression": getattr(OpenEXR, f"{compression.upper().replace('NONE', 'NO')}_COMPRESSION"),
        "type": OpenEXR.scanlineimage,
        "envmap": OpenEXR.ENVMAP_LATLONG,
        "chromaticities": REC709,
        "wrapmodes": "periodic,clamp",
        "comments": _LAYOUT_NOTE,
        **(attributes or {}),
    }
    if half or compression in ("dwaa", "dwab"):
        scale = _half_scale(pixels, path)
        if scale != 1.0:
            pixels = pixels * np.float32(scale)
            header["panokit:scale"] = scale
            header["comments"] += f" Pixels are radiance times {scale!r} (panokit:scale)."
            if "whiteLuminance" in header:
                header["whiteLuminance"] = float(header["whiteLuminance"]) / scale
        if half:
            pixels = pixels.astype(np.float16)
    with atomic_write(path) as temporary:
        try:
            with OpenEXR.File(header, {"RGB": pixels}) as file:
                file.write(str(temporary))
        except RuntimeError as error:
            full = os.strerror(errno.ENOSPC) in str(error)
            code = errno.ENOSPC if full else errno.EIO
            raise OSError(code, os.strerror(code)) from error


def _half_scale(pixels: NDArray[np.float32], path: Path) -> float:
    """The power of two that brings the brightest value into the range of half floats."""
    top = float(np.abs(pixels).max())
    if top <= _HALF_TOP:
        return 1.0
    scale = float(2.0 ** -np.ceil(np.log2(top / _HALF_TOP)))
    positive = pixels[pixels > 0]
    if positive.size and float(np.median(positive)) * scale < _SMALLEST_NORMAL_HALF:
        raise ImageError(
            f"Half floats cannot hold both the sun ({top:.3g}) and the rest of what was to be "
            f"written to {path}. Write float32, or take the sun out and keep it as a light.",
            reason="range-too-wide",
            values={"highest": top, "median": float(np.median(positive))},
        )
    return scale
