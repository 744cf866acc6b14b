"""8-bit pictures: decode with every doubt named, encode to JPEG and PNG."""

import io
import warnings
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from panokit.errors import ImageError

LDR_SUFFIXES = (".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff")
_MAX_SIDE_PX = 32766  # cv2.remap cannot address more


def decode_image(data: bytes, *, what: str) -> NDArray[np.uint8]:
    """The pixels of an encoded 8-bit RGB picture.

    Args:
        data: The whole file: JPEG, PNG, WebP or TIFF.
        what: The picture's name, for messages.

    Returns:
        (H, W, 3) uint8 RGB, in the picture's own encoding.

    Raises:
        ImageError: If it is not an image, truncated, grey, 16-bit, has alpha, or is too big.
    """
    header = _open(data, what)
    width, height = header.size
    if max(width, height) > _MAX_SIDE_PX:
        raise ImageError(
            f"{what} is {width}x{height}; the largest side is {_MAX_SIDE_PX} px. Reduce it first.",
            reason="too-large",
            values={"width_px": width, "height_px": height},
        )
    if header.format == "JPEG":
        _check_color(what, header.mode, depth=8)
        try:
            with _without_bomb_warning():
                return np.asarray(header.convert("RGB"))
        except OSError as error:
            raise ImageError(
                f"{what} is a damaged JPEG ({error}). Fetch or copy it again.", reason="truncated"
            ) from error
    return _decode_other(data, what)


def _open(data: bytes, what: str) -> Image.Image:
    try:
        with _without_bomb_warning():
            return Image.open(io.BytesIO(data))
    except (UnidentifiedImageError, Image.DecompressionBombError, OSError, SyntaxError) as error:
        start = data[:4].hex(" ") if data else "nothing"
        raise ImageError(
            f"{what} is not an image that panokit can read (it begins with {start}). "
            "Use JPEG, PNG, WebP or TIFF for LDR and .exr or .hdr for HDR.",
            reason="not-an-image",
            values={"bytes": len(data)},
        ) from error


def _decode_other(data: bytes, what: str) -> NDArray[np.uint8]:
    # Pillow turns 16-bit RGB into 8 bits without a word; cv2 keeps what is there.
    try:
        pixels: NDArray[Any] | None = cv2.imdecode(
            np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED
        )
    except cv2.error:
        pixels = None
    if pixels is None:
        raise ImageError(f"{what} is damaged. Copy or export it again.", reason="truncated")
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    mode = {1: "L", 2: "LA", 3: "RGB", 4: "RGBA"}.get(channels, f"{channels} channels")
    _check_color(what, mode, depth=8 * pixels.dtype.itemsize)
    return np.ascontiguousarray(pixels[..., ::-1])


def _check_color(what: str, mode: str, *, depth: int) -> None:
    if depth != 8:
        raise ImageError(
            f"{what} has {depth} bits a channel. Export it as 8-bit sRGB, or as linear .exr "
            "if it is an HDR map.",
            reason="not-8-bit",
            values={"bits": depth},
        )
    if mode in ("L", "1"):
        raise ImageError(
            f"{what} is grey: it says nothing about the color of light. "
            "If that is meant, save it as RGB.",
            reason="grey",
        )
    if mode in ("RGBA", "LA", "PA"):
        raise ImageError(
            f"{what} has an alpha channel. Save it without, and hand what it hides to "
            "`panokit inpaint --mask`.",
            reason="alpha",
        )
    if mode != "RGB":
        raise ImageError(
            f"{what} holds {mode} pixels. Save it as 8-bit sRGB.", reason="wrong-color-model"
        )


def encode_jpeg(pixels: NDArray[np.uint8], *, quality: int = 95, xmp: bytes = b"") -> bytes:
    """A JPEG of RGB pixels, 4:4:4 from quality 90 on, with XMP metadata if given."""
    buffer = io.BytesIO()
    options: dict[str, Any] = {"xmp": xmp} if xmp else {}
    Image.fromarray(np.ascontiguousarray(pixels)).save(
        buffer, "JPEG", quality=quality, subsampling=0 if quality >= 90 else 2, **options
    )
    return buffer.getvalue()


def encode_png(pixels: NDArray[np.uint8]) -> bytes:
    """A PNG of (H, W) grey or (H, W, 3) RGB pixels."""
    ordered = pixels if pixels.ndim == 2 else pixels[..., ::-1]
    _, data = cv2.imencode(".png", ordered)
    return bytes(data)


class _without_bomb_warning(warnings.catch_warnings):  # noqa: N801 - reads as a statement
    """Pillow warns from 89 megapixels on; a 16384x8192 panorama has 134 and is welcome."""

    def __enter__(self) -> None:
        super().__enter__()
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
