"""Scanlines of Radiance files: RGBE <-> float, and the three ways they are stored.

New run lengths (each scanline begins with 2, 2 and its width; then R, G, B and E one after the
other), old run lengths (a pixel 1, 1, 1, n repeats the one before), and flat (4 bytes a pixel).
(Radiance, src/common/color.c.) A mantissa m with exponent byte e is m * 2**(e - 136), as in
Bruce Walter's rgbe.c and nearly every reader; Radiance's own programs add half a mantissa step.
"""

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError
from panokit.io.radiance_header import RadianceHeader

_CV2_HEADER = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n"
_SHORTEST, _LONGEST = 8, 0x7FFF  # widths that the new run lengths are made for
_LONGEST_RUN = 127
_STEP = np.ldexp(np.float32(1), np.arange(256) - 136).astype(np.float32)
_STEP[0] = 0
_POWERS = np.ldexp(np.float32(1), np.arange(-140, 128)).astype(np.float32)
_OVERFLOW = 2.0**127 * (1 - 2.0**-9)


class Scanlines:
    """Random access to the scanlines of a file's bytes.

    Args:
        data: The whole file: bytes or a memory map.
        header: What its header says.
        what: The file, for messages.

    Raises:
        ImageError: If there are too few bytes for the size in the header.
    """

    def __init__(self, data: Any, header: RadianceHeader, what: str) -> None:
        self._data, self._header, self._what = data, header, what
        self._starts: list[int] | None = None
        self._pixels: NDArray[np.uint8] | None = None
        width = header.scanline_px
        start = header.data_offset
        self._mark = bytes([2, 2, width >> 8, width & 255]) if width <= _LONGEST else b""
        if width < _SHORTEST or data[start : start + 4] != self._mark:
            self._pixels = self._old_pixels()
            return
        shortest = header.scanlines * (4 + 8 * -(-width // _LONGEST_RUN))
        if len(data) - start < shortest:
            raise self._damaged(f"it has {len(data) - start} bytes where {shortest} is the least")

    def read(self, first: int, count: int) -> NDArray[np.float32]:
        """Scanlines as (count, scanline_px, 3) float32, nothing divided out yet."""
        width = self._header.scanline_px
        if self._pixels is not None:
            pixels = self._pixels[first * width : (first + count) * width]
            return float_from_rgbe(pixels).reshape(count, width, 3)
        begin, end = self._header.data_offset, len(self._data)
        if (first, count) != (0, self._header.scanlines):
            starts = self._scanline_starts()
            begin, end = starts[first], starts[first + count]
        packed = (_CV2_HEADER % (count, width)) + self._data[begin:end]
        try:
            decoded = cv2.imdecode(np.frombuffer(packed, np.uint8), cv2.IMREAD_UNCHANGED)
        except cv2.error:
            decoded = None
        if decoded is None or decoded.shape != (count, width, 3) or decoded.dtype != np.float32:
            raise self._damaged("its run lengths do not fit")
        return np.asarray(cv2.cvtColor(decoded, cv2.COLOR_BGR2RGB), np.float32)

    def _scanline_starts(self) -> list[int]:
        """Where each scanline begins, and where the last one ends."""
        if self._starts is None:
            first, count = self._header.data_offset, self._header.scanlines
            found: list[int] = []
            place = self._data.find(self._mark, first)
            while place >= 0 and len(found) <= count:
                found.append(place)
                place = self._data.find(self._mark, place + 1)
            if len(found) == count:
                # Every scanline begins with the mark, so these are all of them.
                self._starts = [*found, len(self._data)]
            else:
                self._starts = self._walk(first, count)
        return self._starts

    def _walk(self, position: int, count: int) -> list[int]:
        starts = [position]
        data, width = self._data, self._header.scanline_px
        try:
            for _ in range(count):
                if data[position : position + 4] != self._mark:
                    raise self._damaged("a scanline does not begin as it should")
                position += 4
                for _ in range(4):
                    filled = 0
                    while filled < width:
                        code = data[position]
                        filled += code - 128 if code > 128 else code
                        position += 2 if code > 128 else 1 + code
                        if not code:
                            raise self._damaged("a run has no length")
                    if filled > width:
                        raise self._damaged("a run is too long")
                starts.append(position)
        except IndexError as error:
            raise self._damaged("it ends early") from error
        return starts

    def _old_pixels(self) -> NDArray[np.uint8]:
        count = self._header.scanlines * self._header.scanline_px
        stored = (len(self._data) - self._header.data_offset) // 4
        quads = np.frombuffer(self._data, np.uint8, stored * 4, self._header.data_offset)
        quads = quads.reshape(-1, 4)
        repeats = (quads[:, :3] == 1).all(axis=1)
        if not repeats.any() or (stored == count and _total(quads, repeats) != count):
            if stored < count:
                raise self._damaged(f"it has {stored} of {count} pixels")
            return quads[:count]
        lengths = _run_lengths(quads, repeats)
        ends = np.cumsum(lengths)
        last = int(np.searchsorted(ends, count))
        if repeats[0] or last >= len(ends) or ends[last] != count:
            raise self._damaged("its repetitions do not fit its size")
        literal = np.maximum.accumulate(np.where(repeats, 0, np.arange(stored)))
        return np.asarray(quads[np.repeat(literal[: last + 1], lengths[: last + 1])], np.uint8)

    def _damaged(self, why: str) -> ImageError:
        return ImageError(
            f"{self._what} is a damaged Radiance file: {why}. Copy it again.", reason="truncated"
        )


def _run_lengths(quads: NDArray[np.uint8], repeats: NDArray[np.bool_]) -> NDArray[np.int64]:
    """How many pixels each stored one stands for; repetitions in a row count in base 256."""
    index = np.arange(len(quads))
    since = index - np.maximum.accumulate(np.where(repeats, -1, index)) - 1
    lengths = quads[:, 3].astype(np.int64) << (8 * np.clip(since, 0, 3))
    return np.where(repeats, lengths, 1)


def _total(quads: NDArray[np.uint8], repeats: NDArray[np.bool_]) -> int:
    return int(_run_lengths(quads, repeats).sum())


def float_from_rgbe(rgbe: NDArray[np.uint8]) -> NDArray[np.float32]:
    """RGBE bytes (..., 4) as floats (..., 3): mantissa times 2 to the exponent byte - 136."""
    return rgbe[..., :3] * _STEP[rgbe[..., 3]][..., None]


def encode_scanlines(pixels: NDArray[np.float32], what: str) -> bytes:
    """Pixels (rows, W, 3) as scanlines in new run lengths, or flat where W is out of their range.

    Mantissas are rounded to nearest, so what was read from a file is written with the same
    values, and the error is at most half a step: 1/256 of the brightest channel.

    Raises:
        ImageError: If a value is negative, not finite, or beyond 2**127.
    """
    rows, width = pixels.shape[:2]
    low, high = float(pixels.min()), float(pixels.max())
    if not (low >= 0 and high < _OVERFLOW):
        raise ImageError(
            f"{what}: a Radiance file holds values from 0 to 1.7e38, not {low:.4g} to {high:.4g}. "
            "Write EXR, or clean the values first.",
            reason="not-physical",
            values={"lowest": low, "highest": high},
        )
    # Not max(axis=-1), which is slow over three values.
    peak = np.maximum(np.maximum(pixels[..., 0], pixels[..., 1]), pixels[..., 2])
    _, exponent = np.frexp(peak)
    # The brightest channel would round up to a mantissa of 256: one exponent higher then.
    exponent += peak * _power_of_two(8 - exponent) >= 255.5
    mantissa = np.rint(pixels * _power_of_two(8 - exponent)[..., None])
    # Below 2**-106 the coder of cv2 writes black, as others do.
    lost = peak < 2.0**-106
    if _SHORTEST <= width <= _LONGEST:
        mantissa *= _power_of_two(exponent - 8)[..., None]
        mantissa[lost] = 0
        _, encoded = cv2.imencode(".hdr", cv2.cvtColor(mantissa, cv2.COLOR_RGB2BGR))
        data = encoded.tobytes()
        return data[data.index(b"\n", data.index(b"\n\n") + 2) + 1 :]
    rgbe = np.empty((rows, width, 4), np.uint8)
    rgbe[..., :3] = mantissa
    rgbe[..., 3] = np.clip(exponent + 128, 0, 255)
    rgbe[lost] = 0
    return rgbe.tobytes()


def _power_of_two(exponent: NDArray[np.int32]) -> NDArray[np.float32]:
    return _POWERS[np.clip(exponent, -140, 127) + 140]
