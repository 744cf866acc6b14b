"""The text at the head of a Radiance picture: what its numbers are and how its rows lie.

Meaning of the lines as in Radiance's "picture file format" notes and its color.h: EXPOSURE and
COLORCORR are what pixels were multiplied with (several lines multiply), PRIMARIES are x and y
of R, G, B and white, FORMAT tells RGBE from XYZE. Other lines are commands and comments.
"""

import math
import re
from dataclasses import dataclass

from panokit.color.primaries import REC709, rec709_from_rgb
from panokit.errors import ImageError, UsageError

_RESOLUTION = re.compile(rb"([+-])([XY]) +(\d+) +([+-])([XY]) +(\d+)\s*")
_LIMIT = 1 << 16
_FORMATS = {b"32-bit_rle_rgbe": "rgbe", b"32-bit_rle_xyze": "xyze"}


@dataclass(frozen=True, slots=True, kw_only=True)
class RadianceHeader:
    """What a Radiance file says of itself.

    Attributes:
        width_px: Of the upright picture.
        height_px: Of the upright picture.
        orientation: As written, for example "-Y +X": how scanlines follow each other, then how
            pixels do in a scanline. Y points up, X to the right.
        color_model: "rgbe" or "xyze".
        exposure: The product of the EXPOSURE lines.
        color_correction: The product of the COLORCORR lines, for R, G, B.
        primaries: x and y of red, green, blue and white; Rec.709 where there is no line.
        pixel_aspect: Height of a pixel over its width, the product of the PIXASPECT lines.
        data_offset: Where the pixels begin in the file.
    """

    width_px: int
    height_px: int
    orientation: str
    color_model: str
    exposure: float
    color_correction: tuple[float, float, float]
    primaries: tuple[float, ...]
    pixel_aspect: float
    data_offset: int

    @property
    def scanline_px(self) -> int:
        """Pixels in a scanline as stored."""
        return self.height_px if self.orientation[1] == "X" else self.width_px

    @property
    def scanlines(self) -> int:
        """How many scanlines are stored."""
        return self.width_px if self.orientation[1] == "X" else self.height_px


def parse_radiance_header(data: bytes, what: str, file_bytes: int) -> RadianceHeader:
    """The header of a Radiance file.

    Args:
        data: The file's first 64 KiB, or all of it.
        what: The file, for messages.
        file_bytes: The size of the whole file; the header may not claim more than it can hold.

    Raises:
        ImageError: If it is none, is damaged, or lies about its size.
    """
    if not data.startswith(b"#?"):
        raise ImageError(
            f"{what} is not a Radiance file (it begins with {data[:4].hex(' ') or 'nothing'}).",
            reason="not-an-image",
        )
    head = data[:_LIMIT]
    end = re.search(rb"\n[ \t\r]*\n", head)
    if end is None:
        raise _damaged(what, "no empty line ends its header")
    line_end = head.find(b"\n", end.end())
    resolution = _RESOLUTION.fullmatch(head[end.end() : line_end]) if line_end > 0 else None
    if resolution is None or resolution[2] == resolution[5]:
        raise _damaged(what, "no size line")
    counts = int(resolution[3][:12]), int(resolution[6][:12])
    model, values = _values(head[: end.start()].split(b"\n"), what)
    turned = resolution[2] == b"X"
    header = RadianceHeader(
        width_px=counts[0] if turned else counts[1],
        height_px=counts[1] if turned else counts[0],
        orientation=(resolution[1] + resolution[2] + b" " + resolution[4] + resolution[5]).decode(),
        color_model=model,
        exposure=values["EXPOSURE"][0],
        color_correction=(values["COLORCORR"][0], values["COLORCORR"][1], values["COLORCORR"][2]),
        primaries=tuple(values["PRIMARIES"]),
        pixel_aspect=values["PIXASPECT"][0],
        data_offset=line_end + 1,
    )
    _check(header, what, file_bytes)
    return header


def _values(lines: list[bytes], what: str) -> tuple[str, dict[str, list[float]]]:
    model = "rgbe"
    values = {
        "EXPOSURE": [1.0],
        "COLORCORR": [1.0, 1.0, 1.0],
        "PIXASPECT": [1.0],
        "PRIMARIES": list(REC709),
    }
    for line in lines:
        name, equals, rest = line.partition(b"=")
        key = name.strip().decode("latin-1")
        if not equals:
            continue
        if key == "FORMAT":
            if rest.strip() not in _FORMATS:
                text = rest.strip().decode("latin-1")[:40]
                raise ImageError(
                    f"{what} is a Radiance file of the format {text!r}. Convert it to RGBE with "
                    "Radiance's ra_xyze -r.",
                    reason="wrong-color-model",
                )
            model = _FORMATS[rest.strip()]
        elif key == "GAMMA" and _numbers(rest, key, what, 1) != [1.0]:
            text = rest.strip().decode("latin-1")[:40]
            raise ImageError(
                f"{what} holds display values (GAMMA={text}), not light. "
                "Save it again with linear values.",
                reason="wrong-color-model",
            )
        elif key in values:
            found = _numbers(rest, key, what, len(values[key]))
            if key == "PRIMARIES":
                # Eight zeros, as in the files of Poly Haven, say that nobody knew.
                values[key] = found if any(found) else list(REC709)
            else:
                values[key] = [a * b for a, b in zip(values[key], found, strict=True)]
    return model, values


def _numbers(text: bytes, key: str, what: str, count: int) -> list[float]:
    try:
        numbers = [float(one) for one in text.split()[:count]]
    except ValueError:
        numbers = []
    good = len(numbers) == count and all(math.isfinite(one) for one in numbers)
    if not good or (key != "PRIMARIES" and min(numbers) <= 0):
        shown = text.strip().decode("latin-1")[:40]
        raise ImageError(
            f"{what} has the line {key}={shown}, which cannot be used. "
            "Correct or remove it with a text editor that keeps bytes.",
            reason="bad-exposure" if key == "EXPOSURE" else "bad-header",
        )
    return numbers


def _check(header: RadianceHeader, what: str, file_bytes: int) -> None:
    product = header.exposure
    for factor in (product, *header.color_correction):
        if not (math.isfinite(factor) and 1e-30 < factor < 1e30):
            raise ImageError(
                f"{what} has an EXPOSURE or COLORCORR of {factor}, which cannot be divided out.",
                reason="bad-exposure",
            )
    try:
        rec709_from_rgb(header.primaries)
    except (UsageError, ArithmeticError, ValueError) as error:
        raise ImageError(
            f"{what}: {error} Correct its PRIMARIES line.", reason="bad-header"
        ) from error
    if header.width_px < 1 or header.height_px < 1:
        raise _damaged(what, f"a size of {header.width_px}x{header.height_px}")
    stored = file_bytes - header.data_offset
    # No coding has less than 8 bytes for a scanline, or 4 for one of a single pixel.
    if stored < header.scanlines * (8 if header.scanline_px > 1 else 4):
        raise ImageError(
            f"{what} claims {header.width_px}x{header.height_px} pixels but has only "
            f"{max(stored, 0)} bytes of them. It is damaged or was cut off; copy it again.",
            reason="truncated",
            values={
                "width_px": header.width_px,
                "height_px": header.height_px,
                "bytes": max(stored, 0),
            },
        )


def _damaged(what: str, why: str) -> ImageError:
    return ImageError(
        f"{what} is a damaged Radiance file: {why}. Copy it again.", reason="truncated"
    )
