"""OpenEXR light probes: float32 RGB, lat-long `envmap` attribute, panokit's own attributes."""

import errno
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from panokit.errors import ImageError
from panokit.io.files import atomic_write, storage_error

# Rec.709 primaries and D65, as ST 2065-4 readers expect them: r, g, b, white, each x and y.
_REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
_LAYOUT_NOTE = (
    "Latitude-longitude map. Pixel edges, not centers, lie on the borders: column i has its "
    "center at u = (i + 0.5) / width; row 0 touches the zenith. Directions follow the OpenEXR "
    "lat-long convention (+Y up, center +Z); in panokit's own frame the center is -Z."
)


def read_exr(path: Path) -> tuple[NDArray[np.float32], dict[str, str]]:
    """The RGB pixels of an EXR file and its `panokit:` attributes.

    Half floats are widened. An alpha channel is ignored: radiance has none.

    Returns:
        (H, W, 3) float32 and the attributes, without their prefix.

    Raises:
        ImageError: If it is not a readable EXR, or has no channels R, G and B.
        StorageError: If the file cannot be opened.
    """
    try:
        with Path(path).open("rb") as file:
            magic = file.read(4)
    except OSError as error:
        raise storage_error("read", Path(path), error) from error
    if magic != b"\x76\x2f\x31\x01":
        raise ImageError(
            f"{path} is not an OpenEXR file (it begins with {magic.hex(' ') or 'nothing'}).",
            reason="not-an-image",
        )
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            header = dict(file.header())  # emptied when the file is closed
            channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
    except Exception as error:  # the package raises bare RuntimeError and ValueError
        raise ImageError(
            f"{path} is a damaged OpenEXR file ({_first_line(error)}). Copy it again.",
            reason="truncated",
        ) from error
    return _rgb(path, channels), {
        name.removeprefix("panokit:"): str(value)
        for name, value in header.items()
        if name.startswith("panokit:")
    }


def _rgb(path: Path, channels: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
    if not {"R", "G", "B"} <= channels.keys():
        names = ", ".join(sorted(channels)) or "none"
        raise ImageError(
            f"{path} has no channels R, G and B; it has: {names}. "
            "Rename or export the layer you want as plain RGB.",
            reason="wrong-channels",
            values={"channels": sorted(channels)},
        )
    planes = [channels[name] for name in "RGB"]
    if len({plane.shape for plane in planes}) != 1:
        raise ImageError(
            f"{path} stores R, G and B at different sizes. Export it without subsampling.",
            reason="wrong-channels",
        )
    return np.stack(planes, axis=-1).astype(np.float32, copy=False)


def write_exr(
    path: Path, radiance: NDArray[np.float32], attributes: Mapping[str, Any] | None = None
) -> None:
    """Write radiance as a float32 ZIP EXR that other tools take for a lat-long map, atomically.

    Args:
        path: The file.
        radiance: (H, W, 3) float32, linear Rec.709.
        attributes: More header attributes, standard (`owner`, `latitude`, ...) or `panokit:`.
    """
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "envmap": OpenEXR.ENVMAP_LATLONG,
        "chromaticities": _REC709,
        "wrapmodes": "periodic,clamp",
        "comments": _LAYOUT_NOTE,
        **(attributes or {}),
    }
    pixels = np.ascontiguousarray(radiance, np.float32)
    with atomic_write(path) as part:
        try:
            with OpenEXR.File(header, {"RGB": pixels}) as file:
                file.write(str(part))
        except RuntimeError as error:
            full = os.strerror(errno.ENOSPC) in str(error)
            code = errno.ENOSPC if full else errno.EIO
            raise OSError(code, os.strerror(code)) from error


def _first_line(error: BaseException) -> str:
    return str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
