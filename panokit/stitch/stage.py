"""The stage: a stored capture in, a level panorama that faces north out."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.equirectangular import check_equirectangular
from panokit.errors import ImageError
from panokit.frames import Frame
from panokit.io.captures import StoredCapture
from panokit.io.images import decode_image
from panokit.panorama import Panorama
from panokit.provenance import Provenance, Step, digest_of
from panokit.stitch.level import leveling_from, turn
from panokit.stitch.mosaic import mosaic
from panokit.stitch.overlapping import stitch_stored_views
from panokit.stitch.reduce import Reducer
from panokit.stitch.settings import VERSION, StitchSettings


def stitch(stored: StoredCapture, settings: StitchSettings | None = None) -> Panorama:
    """Make a panorama of a stored capture: put tiles or views together, turn level and north.

    Args:
        stored: The capture with its tiles, its overlapping views, or its one picture.
        settings: How; the defaults if not given.

    Returns:
        A panorama in `Frame.WORLD` where the heading is known, else `Frame.LEVEL`; in
        `Frame.CAMERA` with `level` off. Its last step says which tiles were missing or
        resized and what the leveling rests on.

    Raises:
        ImageError: If a tile or the picture is damaged, the picture is not 2:1, or
            views contradict each other.
        RecordError: If a file is not the one that was stored.
        StorageError: If a file cannot be read.
    """
    settings = settings or StitchSettings()
    if stored.views:
        return stitch_stored_views(stored, settings)
    if stored.grid is None:
        pixels, valid, found = _single_picture(stored, settings.width_px)
    else:
        pixels, valid, found = _tiles(stored, settings)
    frame = Frame.CAMERA
    leveling: dict[str, Any] = {"leveled": False}
    if settings.level:
        plan = leveling_from(stored.capture, pixels, settings.upright)
        pixels, valid = turn(pixels, valid, plan.target_from_camera)
        frame = plan.frame
        leveling = plan.to_json()
    step = Step(
        stage="stitch",
        version=VERSION,
        settings_digest=settings.digest,
        input_digests=(digest_of(stored.capture.to_json()), digest_of(dict(stored.files))),
        values={**found, **leveling, "frame": str(frame)},
    )
    return Panorama(
        pixels=pixels,
        capture=stored.capture,
        frame=frame,
        valid=valid,
        provenance=Provenance((step,)),
    )


_Found = tuple[NDArray[np.uint8], NDArray[np.bool_] | None, dict[str, Any]]


def _tiles(stored: StoredCapture, settings: StitchSettings) -> _Found:
    grid = stored.grid
    if grid is None:
        raise ImageError(f"The capture {stored.capture.id} has no tiles.", reason="no-tiles")
    # Checked on an array without memory, before any tile is decoded.
    check_equirectangular(np.broadcast_to(np.uint8(0), (grid.height_px, grid.width_px, 3)))
    made = mosaic(stored, grid, settings.width_px, soften=settings.deblock)
    found: dict[str, Any] = {
        "native_size_px": [grid.width_px, grid.height_px],
        "tiles": made.tiles,
        "tiles_missing": [list(cell) for cell in made.missing],
        "tiles_black": [list(cell) for cell in made.black],
        "tiles_resized": [list(cell) for cell in made.resized],
    }
    return made.pixels, made.valid, found


def _single_picture(stored: StoredCapture, width_px: int | None) -> _Found:
    names = [name for name in stored.files if Path(name).stem == "image"]
    if len(names) != 1:
        raise ImageError(
            f"The capture {stored.capture.id} has {len(names)} pictures and no tiles, where one "
            "picture is expected. Fetch it again.",
            reason="no-picture",
        )
    pixels = decode_image(stored.read(names[0]), what=str(stored.folder / names[0]))
    check_equirectangular(pixels)
    native_size_px = [pixels.shape[1], pixels.shape[0]]
    if width_px is not None and width_px < pixels.shape[1]:
        reducer = Reducer(pixels.shape[1], width_px)
        reducer.add(0, pixels)
        pixels, _ = reducer.result()
    return pixels, None, {"native_size_px": native_size_px, "tiles": 0}
