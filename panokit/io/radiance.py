"""Radiance .hdr files (RGBE and XYZE), with the header lines that most readers ignore.

A file's EXPOSURE and COLORCORR say what its pixels were multiplied with and are divided out;
pictures of other primaries and XYZE become Rec.709; all eight orientations are turned upright.
"""

import mmap
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.color.primaries import REC709, XYZ, rec709_from_rgb
from panokit.errors import ImageError, UsageError
from panokit.io.files import atomic_write, read_bytes, storage_error
from panokit.io.finite import check_finite
from panokit.io.radiance_coding import Scanlines, encode_scanlines
from panokit.io.radiance_header import RadianceHeader, parse_radiance_header

_STRIP_ROWS = 256
_PIXELS_AT_ONCE = 1 << 20  # small strips stay in the cache: faster than all at once
# XYZE is in cd/m2, RGBE in W/(sr m2): 179 lm/W (WHTEFFICACY in Radiance's color.h).
_LUMEN_PER_WATT = 179.0
_HEADER = "#?RADIANCE\nSOFTWARE=panokit\nPRIMARIES={}\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n"


def read_radiance(path: Path) -> NDArray[np.float32]:
    """The radiance in a .hdr file, (H, W, 3) float32, linear Rec.709, upright.

    Values are those that most programs read; where the writer cut mantissas off instead of
    rounding them they are low by half a step, 0.3 % or more on average (Radiance's own
    programs add it back).

    Raises:
        ImageError: If it is not a readable Radiance file.
        StorageError: If it cannot be read.
    """
    data = read_bytes(path)
    header = parse_radiance_header(data, str(path), len(data))
    stored = Scanlines(data, header, str(path))
    at_once = max(1, _PIXELS_AT_ONCE // header.scanline_px)
    if header.scanlines <= at_once:
        scanlines = _as_radiance(stored.read(0, header.scanlines), header, str(path))
        return _upright(scanlines, header)
    scanlines = np.empty((header.scanlines, header.scanline_px, 3), np.float32)
    for first in range(0, header.scanlines, at_once):
        strip = stored.read(first, min(at_once, header.scanlines - first))
        scanlines[first : first + at_once] = _as_radiance(strip, header, str(path))
    return _upright(scanlines, header)


def read_radiance_header(path: Path) -> RadianceHeader:
    """What a .hdr file says of itself; see `RadianceHeader`.

    Raises:
        ImageError: If it is not a Radiance file, or lies about its size.
        StorageError: If it cannot be read.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            head = file.read(1 << 16)
        size = path.stat().st_size
    except OSError as error:
        raise storage_error("read", path, error) from error
    return parse_radiance_header(head, str(path), size)


def iterate_radiance_rows(
    path: Path, rows: slice | None = None, *, strip_rows: int = _STRIP_ROWS
) -> Iterator[tuple[int, NDArray[np.float32]]]:
    """The same radiance in strips, in the memory of about three of them.

    Files in the old run lengths are held whole, in 4 bytes a pixel.

    Args:
        path: The file.
        rows: Only these rows of the upright picture, all if not given.
        strip_rows: Rows in a strip, at most.

    Yields:
        The first row of the strip, and its pixels (rows, W, 3) float32; in the order of the
        file, which is upward for the orientations +Y.

    Raises:
        ImageError: As `read_radiance`; a file that stores columns cannot be read by rows.
    """
    if strip_rows < 1:
        raise UsageError(f"A strip has at least one row, not {strip_rows}.")
    header = read_radiance_header(path)
    if header.orientation[1] == "X":
        raise ImageError(
            f"{path} stores columns one after the other ({header.orientation}), so it cannot "
            "be read by rows. Use read_radiance.",
            reason="wrong-orientation",
        )
    first, last, step = (rows or slice(None)).indices(header.height_px)
    if step != 1:
        raise UsageError("Rows are read one after the other: a slice without a step.")
    scanlines = Scanlines(_map(Path(path)), header, str(path))
    upward = header.orientation[0] == "+"
    for top in range(first, last, strip_rows):
        count = min(strip_rows, last - top)
        stored = header.height_px - top - count if upward else top
        strip = _as_radiance(scanlines.read(stored, count), header, str(path))
        yield top, _upright(strip, header)


def read_radiance_rows(path: Path, rows: slice) -> NDArray[np.float32]:
    """Some rows of a large .hdr file, (rows, W, 3) float32; see `iterate_radiance_rows`."""
    strips = [strip for _, strip in iterate_radiance_rows(path, rows)]
    if not strips:
        return np.empty((0, read_radiance_header(path).width_px, 3), np.float32)
    return np.concatenate(strips)


def write_radiance(path: Path, radiance: NDArray[np.floating]) -> None:
    """Write radiance (H, W, 3), linear Rec.709, as RLE RGBE, atomically.

    Never clipped; each pixel is off by at most 1/256 of its brightest channel.

    Raises:
        UsageError: If the array is no picture.
        ImageError: If a value is negative, not finite or beyond 1.7e38.
        StorageError: If the file cannot be written.
    """
    radiance = np.asarray(radiance)
    if radiance.ndim != 3 or radiance.shape[2] != 3 or radiance.size == 0:
        raise UsageError(f"A .hdr map is written from (H, W, 3) pixels, not {radiance.shape}.")
    height, width = radiance.shape[:2]
    strips = (radiance[top : top + _STRIP_ROWS] for top in range(0, height, _STRIP_ROWS))
    write_radiance_rows(path, width, height, strips)


def write_radiance_rows(
    path: Path, width_px: int, height_px: int, strips: Iterable[NDArray[np.floating]]
) -> None:
    """Write radiance that comes in strips from the top, atomically; see `write_radiance`.

    Args:
        path: The file.
        width_px: Of the picture.
        height_px: Of the picture.
        strips: Arrays (rows, width_px, 3), together `height_px` rows.

    Raises:
        UsageError: If the strips do not make up the picture; no file is written then.
        ImageError: If a value is negative, not finite or beyond 1.7e38.
        StorageError: If the file cannot be written.
    """
    if width_px < 1 or height_px < 1:
        raise UsageError(f"A picture has at least one pixel, not {width_px}x{height_px}.")
    primaries = " ".join(f"{value:.4f}" for value in REC709)
    done = 0
    with atomic_write(Path(path)) as part, part.open("wb") as file:
        file.write(_HEADER.format(primaries, height_px, width_px).encode())
        for strip in strips:
            if strip.ndim != 3 or strip.shape[1:] != (width_px, 3):
                raise UsageError(f"A strip is (rows, {width_px}, 3), not {strip.shape}.")
            done += len(strip)
            if len(strip):
                pixels = np.ascontiguousarray(strip, np.float32)
                file.write(encode_scanlines(pixels, str(path)))
        if done != height_px:
            raise UsageError(f"The strips have {done} rows, but the picture {height_px}.")


def _as_radiance(
    scanlines: NDArray[np.float32], header: RadianceHeader, what: str
) -> NDArray[np.float32]:
    """Scanlines with exposure divided out, in Rec.709; in place where that will do."""
    is_xyz = header.color_model == "xyze"
    matrix = rec709_from_rgb(XYZ if is_xyz else header.primaries)
    gain = 1 / (header.exposure * np.array(header.color_correction))
    with np.errstate(over="ignore", invalid="ignore"):  # found by the check below
        if matrix is not None:
            unit = _LUMEN_PER_WATT if is_xyz else 1.0
            scanlines = scanlines @ (matrix.T * gain[:, None] / unit).astype(np.float32)
        elif (gain != 1).any():
            scanlines *= gain.astype(np.float32)
        else:
            return scanlines
    check_finite(scanlines, what, "Its EXPOSURE makes values too large for float32.")
    return scanlines


def _upright(scanlines: NDArray[np.float32], header: RadianceHeader) -> NDArray[np.float32]:
    """Scanlines (in a strip or whole) as rows from the top and columns from the left."""
    pixels = scanlines
    if header.orientation[1] == "X":
        pixels = pixels.transpose(1, 0, 2)
    if "+Y" in header.orientation:
        pixels = pixels[::-1]
    if "-X" in header.orientation:
        pixels = pixels[:, ::-1]
    return np.ascontiguousarray(pixels)


def _map(path: Path) -> mmap.mmap:
    try:
        with path.open("rb") as file:
            return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except OSError as error:
        raise storage_error("read", path, error) from error
