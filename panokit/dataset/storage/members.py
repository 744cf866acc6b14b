"""The files of a sample as bytes, see `docs/formats.md`."""

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

# In memory where there is such a place: the OpenEXR package only writes files.
_SCRATCH = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def exr_bytes(
    pixels: NDArray[np.floating[Any]],
    *,
    half: bool = False,
    attributes: Mapping[str, str] | None = None,
) -> bytes:
    """An EXR file of (H, W, 3) pixels as channels R, G, B, or of (H, W) as channel Z.

    Args:
        pixels: Finite.
        half: Store half floats.
        attributes: More header attributes, such as `panokit:projection`.
    """
    dtype = np.float16 if half else np.float32
    stored = np.ascontiguousarray(pixels, dtype)
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **(attributes or {}),
    }
    with tempfile.TemporaryDirectory(prefix="panokit-", dir=_SCRATCH) as folder:
        path = Path(folder) / "member.exr"
        with OpenEXR.File(header, {"RGB" if stored.ndim == 3 else "Z": stored}) as file:
            file.write(str(path))
        return path.read_bytes()


def json_bytes(value: Any) -> bytes:
    """A JSON file with sorted keys, so that equal values are equal bytes."""
    return (json.dumps(value, sort_keys=True, indent=1, ensure_ascii=False) + "\n").encode()
