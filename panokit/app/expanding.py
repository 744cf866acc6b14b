"""What Expand does, without a browser: the stages of the command line on one picture.

Each function is called in the worker process: arguments and results are small, pixels stay in
files. The files are those that `panokit inpaint` and `panokit expand` write, byte for byte.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ItemError, PanokitError, Rejection
from panokit.expand.network import TASK
from panokit.expand.settings import ExpandSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.io import encode_jpeg, read_environment_map, read_panorama
from panokit.io.pictures import write_environment_map
from panokit.pipeline.tasks import StageTask, run_task
from panokit.probes.exporting import export_map
from panokit.probes.settings import ExportSettings
from panokit.report.entries import light_map
from panokit.report.page import render_viewer
from panokit.weights import released_models

ANALYTIC_METHODS = {
    "srgb": "sRGB curve undone",
    "reinhard": "Inverse Reinhard",
    "area": "Energy by area",
}
FORMS = {
    "exr": "EXR",
    "hdr": "Radiance HDR",
    "blender": "Blender world",
    "usd": "USD dome light",
    "gltf": "glTF",
    "mitsuba": "Mitsuba scene",
    "harmonics": "Harmonics",
    "record": "Record (JSON)",
}
_SHOWN_PX = 1024
_MAP_PX = 768
_OUTLINE = (255, 196, 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Filled:
    """A panorama without holes.

    Attributes:
        path: Of it; the picture itself if nothing was to be filled.
        size_px: Width and height.
        holes: What was found: kind, share of the sphere, confidence, whether it was filled.
        before: JPEG, with what was filled outlined; empty if nothing was.
        after: JPEG.
        license: Its id.
        attribution: Whom to credit.
    """

    path: Path
    size_px: tuple[int, int]
    holes: tuple[Mapping[str, Any], ...]
    before: bytes
    after: bytes
    license: str
    attribution: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Expanded:
    """A map that was made of a panorama.

    Attributes:
        path: Of the EXR.
        model: What made it.
        values: What the stage says of it.
    """

    path: Path
    model: str
    values: Mapping[str, Any]


def expansion_models() -> dict[str, str]:
    """Id -> its name: what can expand a panorama here, the networks first."""
    networks = {
        model.id: f"{model.id} (network)"
        for model in reversed(released_models())
        if model.task == TASK
    }
    return {**networks, **ANALYTIC_METHODS}


def fill_holes(source: Path, out: Path, settings: InpaintSettings | None) -> Filled:
    """Find holes and fill them, as `panokit inpaint` does; with no settings, only look.

    Raises:
        ImageError: If the picture cannot be used.
    """
    panorama = read_panorama(source)
    holes: tuple[Mapping[str, Any], ...] = ()
    path, filled = source, panorama
    if settings is not None:
        path = out / f"{source.stem}.jpg"
        values = _ran(
            StageTask(
                stage="inpaint", item=source.stem, source=source, target=path, settings=settings
            )
        )
        holes = tuple(values["holes"])
        filled = read_panorama(path)
    changed = _filled_where(panorama.pixels, filled.pixels, holes)
    return Filled(
        path=path,
        size_px=(filled.width_px, filled.height_px),
        holes=holes,
        before=_shown(panorama.pixels, changed) if changed is not None else b"",
        after=_shown(filled.pixels, None),
        license=panorama.capture.license.id,
        attribution=panorama.capture.license.attribution,
    )


def expand_picture(source: Path, out: Path, settings: ExpandSettings) -> Expanded:
    """Expand a panorama, as `panokit expand` does.

    Raises:
        ImageError: If the picture cannot be used.
        ModelError: If there is no such model.
    """
    target = out / f"{source.stem}.{settings.model}.exr"
    values = _ran(
        StageTask(stage="expand", item=source.stem, source=source, target=target, settings=settings)
    )
    return Expanded(path=target, model=settings.model, values=dict(values))


def viewer_page(
    shown: Expanded, others: Sequence[Expanded], photo: Path | None, name: str
) -> bytes:
    """The HDR viewer with a map and what it can be compared with, as a page."""
    names = expansion_models()
    references = {
        names.get(one.model, one.model): (read_environment_map(one.path), 1.0) for one in others
    }
    photos = {} if photo is None else {"Panorama": read_panorama(photo).pixels}
    entry = light_map(
        read_environment_map(shown.path),
        name,
        label=names.get(shown.model, shown.model),
        photos=photos,
        references=references,
        width_px=_MAP_PX,
    )
    return render_viewer(entry).encode()


def write_forms(path: Path, name: str, form: str, out: Path) -> tuple[Path, ...]:
    """Write a map for another tool; the file to open first is the first.

    Raises:
        UsageError: If there is no such form.
        StorageError: If it cannot be written.
    """
    envmap = read_environment_map(path)
    if form in ("exr", "hdr", "record"):
        # The record is a download of its own: these files say themselves what they are.
        ending = "hdr" if form == "hdr" else "exr"
        write_environment_map(envmap, out / f"{name}.{ending}")
        return (out / f"{name}.{'json' if form == 'record' else ending}",)
    return tuple(
        out / one
        for one in export_map(envmap, name, out, ExportSettings.model_validate({"to": form}))
    )


def expansion_facts(values: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What the stage found, in words."""
    lighting = values.get("lighting") or {}
    rows = [("Burnt out in the picture", _share(values.get("burnt_share", 0.0)))]
    before, after = sum(values["energy_before"]), sum(values["energy_after"])
    if before > 0:
        rows.append(("Light in all", f"{after / before:.2f} × that of the picture"))
    sun = lighting.get("sun")
    if isinstance(sun, Mapping) and "azimuth_deg" in sun:
        rows.append(
            ("Sun", f"azimuth {sun['azimuth_deg']:.0f}°, elevation {sun['elevation_deg']:.0f}°")
        )
    lights = lighting.get("lights")
    if isinstance(lights, Sequence):
        rows.append(("Lights", str(len(lights))))
    stops = lighting.get("dynamic_range_stops")
    if isinstance(stops, int | float):
        rows.append(("Dynamic range", f"{stops:.1f} stops"))
    rows.append(("Width", f"{values['width_px']} px"))
    return rows


def hole_sentences(filled: Filled) -> list[str]:
    """What was found in a picture, and what became of it."""
    said = []
    for hole in filled.holes:
        share = _share(float(hole["solid_angle_sr"]) / (4 * np.pi))
        what = _HOLES.get(hole["kind"], str(hole["kind"]))
        done = "filled" if hole["filled"] else "left as it is"
        said.append(f"{what}: {share} of the sphere, {done}.")
    return said or ["No holes were found."]


_HOLES = {
    "nadir": "A cap below the camera",
    "black": "Missing tiles",
    "invalid": "Parts that were never taken",
    "given": "What was marked",
    "watermark": "A repeated mark",
    "blurred-ground": "Blurred ground",
}


def _share(value: float) -> str:
    percent = 100 * float(value)
    return f"{percent:.2g} %" if percent < 10 else f"{percent:.0f} %"


def _ran(task: StageTask) -> Mapping[str, Any]:
    outcome = run_task(task)
    if isinstance(outcome, Rejection):
        raise ItemError(outcome.message, reason=outcome.reason)
    values = getattr(outcome, "values", None)
    if values is None:
        raise PanokitError(f"The stage {task.stage} said nothing. Try again.")
    return dict(values)


def _filled_where(
    before: NDArray[np.uint8], after: NDArray[np.uint8], holes: Sequence[Mapping[str, Any]]
) -> NDArray[np.uint8] | None:
    """Where a picture was filled, (H, W) uint8; None where it was not."""
    if not any(hole["filled"] for hole in holes):
        return None
    away = np.abs(before.astype(np.int16) - after).max(axis=-1)
    # Anything less is the JPEG's noise.
    mask = cv2.medianBlur(np.where(away > 24, 255, 0).astype(np.uint8), 5)
    reach = max(3, before.shape[1] // 200) | 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, kernel), np.uint8)


def _shown(pixels: NDArray[np.uint8], mask: NDArray[np.uint8] | None) -> bytes:
    size = (_SHOWN_PX, _SHOWN_PX // 2)
    small = cv2.resize(pixels, size, interpolation=cv2.INTER_AREA)
    if mask is not None:
        small_mask = cv2.resize(mask, size, interpolation=cv2.INTER_NEAREST)
        outlines, _ = cv2.findContours(small_mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        large = [line for line in outlines if cv2.contourArea(line) > 12]
        cv2.drawContours(small, large, -1, _OUTLINE, 2, cv2.LINE_AA)
    return encode_jpeg(np.asarray(small, np.uint8), quality=82)
