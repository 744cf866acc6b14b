"""Everything that an estimate says, as files: maps, lights, harmonics, and for other tools."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import tonemap
from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import RecordError
from panokit.frames import Frame, Rotation
from panokit.io import (
    encode_jpeg,
    encode_png,
    read_exr,
    read_json,
    write_bytes,
    write_environment_map,
    write_exr,
    write_json,
    write_radiance,
)
from panokit.io.adapters import AnalyticSun, harmonics_json, take_out_sun
from panokit.io.files import file_entry, storage_error
from panokit.lighting.confidence import Confidence
from panokit.lighting.estimate import LightEstimate
from panokit.lighting.representations import gaussians_json, latlong_radiance, lights_json
from panokit.lighting.settings import VERSION, OutputSettings
from panokit.probes.exporting import export_map
from panokit.probes.settings import ExportSettings
from panokit.provenance import Step
from panokit.sphere import find_lights, rotate

SCHEMA = "panokit.light/1"
RECORD = "estimate.json"
NAME = "light"
PROJECTION = "equirectangular-anamorphic"
# The confidence as a picture has the size of the lat-long map at its smallest.
_PICTURE_PX = 256


def write_outputs(
    estimate: LightEstimate, out: Path, settings: OutputSettings | None = None
) -> dict[str, Any]:
    """Write an estimate into a folder; docs/guides/lighting-outputs.md tells of each file.

    The record `estimate.json` is written last: with it the folder is complete.

    Args:
        estimate: What was read.
        out: The folder; it is made if need be. Files of the same names are replaced.
        settings: What to write.

    Returns:
        The record.

    Raises:
        StorageError: If the folder cannot be written.
    """
    settings = settings or OutputSettings()
    try:
        # Until it is written anew, the folder is not complete.
        (out / RECORD).unlink(missing_ok=True)
    except OSError as error:
        raise storage_error("write into", out, error) from error
    envmap = latlong_of(estimate, settings)
    names = [f"{NAME}64.exr", f"{NAME}.exr", f"{NAME}.json", f"{NAME}.hdr", f"{NAME}.jpg"]
    write_exr(
        out / names[0],
        estimate.radiance,
        {
            "panokit:projection": PROJECTION,
            "panokit:frame": str(Frame.CAMERA),
            "panokit:anchor": str(envmap.anchor),
        },
    )
    write_environment_map(envmap, out / f"{NAME}.exr")
    write_radiance(out / f"{NAME}.hdr", envmap.radiance)
    write_bytes(out / f"{NAME}.jpg", encode_jpeg(tonemap(envmap.radiance), quality=90))
    names += _write_json_forms(envmap, out, settings)
    if estimate.confidence is not None:
        names.append("confidence.png")
        picture = confidence_picture(estimate.confidence, estimate.level_from_camera, settings)
        write_bytes(out / "confidence.png", encode_png(picture))
    tools, sun = _write_exports(envmap, out, settings)
    names += [name for files in tools.values() for name in files]
    record = {
        "schema": SCHEMA,
        "version": VERSION,
        "settings": settings.model_dump(mode="json"),
        "frame": str(envmap.frame),
        **estimate.to_json(),
        "tools": tools,
        "sun_apart": sun and sun.to_json(),
        "files": {name: file_entry(out / name) for name in sorted(set(names))},
    }
    write_json(out / RECORD, record)
    return record


def latlong_of(estimate: LightEstimate, settings: OutputSettings) -> EnvironmentMap:
    """The lat-long map of an estimate, as upright and as wide as the settings say."""
    envmap = EnvironmentMap(
        radiance=latlong_radiance(estimate.radiance, settings.width_px),
        frame=Frame.CAMERA,
        anchor=Anchor.LDR_WHITE,
        provenance=estimate.provenance,
    )
    if settings.frame == "level":
        envmap = rotate(envmap, estimate.level_from_camera, frame=Frame.LEVEL)
    step = Step(
        stage="lighting-outputs", version=VERSION, settings_digest=settings.digest,
        values={"frame": str(envmap.frame)},
    )  # fmt: skip
    return envmap.with_changes(provenance=envmap.provenance.then(step))


def confidence_picture(
    confidence: Confidence, level_from_camera: Rotation, settings: OutputSettings
) -> NDArray[np.uint8]:
    """The confidence beside the lat-long map: (128, 256) uint8, 255 is sure, 128 off by two.

    In the frame of the map, so that one lies on the other.
    """
    turn = level_from_camera if settings.frame == "level" else Rotation.identity()
    values = np.exp(-confidence.turned_error(turn))
    size = (_PICTURE_PX, _PICTURE_PX // 2)
    larger = cv2.resize(values, size, interpolation=cv2.INTER_LINEAR)
    return np.asarray(np.rint(np.clip(larger, 0, 1) * 255), np.uint8)


def read_outputs(out: Path) -> tuple[NDArray[np.float32], dict[str, Any]]:
    """The 64x64 map and the record of a folder that `write_outputs` made.

    Raises:
        RecordError: If the folder is not complete, or of another version.
    """
    record = read_json(out / RECORD)
    if not isinstance(record, dict) or record.get("schema") != SCHEMA:
        raise RecordError(
            f"{out / RECORD} is not the {SCHEMA} of this version of panokit. Write it again.",
            reason="other-schema",
        )
    radiance, attributes = read_exr(out / f"{NAME}64.exr")
    if attributes.get("projection") != PROJECTION:
        raise RecordError(
            f"{out / f'{NAME}64.exr'} is no {PROJECTION} map. Write it again.",
            reason="other-projection",
        )
    return radiance, record


def _write_json_forms(envmap: EnvironmentMap, out: Path, settings: OutputSettings) -> list[str]:
    made = {
        f"{NAME}.harmonics-{order}.json": harmonics_json(envmap, order=order)
        for order in settings.harmonics_orders
    }
    made[f"{NAME}.gaussians.json"] = gaussians_json(envmap, settings.gaussians)
    made[f"{NAME}.lights.json"] = lights_json(envmap)
    for name, value in made.items():
        write_json(out / name, value)
    return list(made)


def _write_exports(
    envmap: EnvironmentMap, out: Path, settings: OutputSettings
) -> tuple[dict[str, list[str]], AnalyticSun | None]:
    """Files by tool, the one to open first, and the light that is apart in them."""
    name, sun = NAME, None
    if settings.sun == "apart":
        taken = _primary_apart(envmap)
        if taken is not None:
            # A name of its own: NAME.exr keeps all of the light.
            name, (rest, sun) = f"{NAME}-rest", taken
            envmap = envmap.with_changes(radiance=rest)
    tools: dict[str, list[str]] = {
        tool: list(export_map(envmap, name, out, ExportSettings(to=tool), sun=sun))
        for tool in settings.exports
    }
    return tools, sun


def _primary_apart(envmap: EnvironmentMap) -> tuple[NDArray[np.float32], AnalyticSun] | None:
    primary = find_lights(envmap.radiance).primary
    if primary is None:
        return None
    sun = AnalyticSun(
        direction=primary.direction,
        irradiance=primary.irradiance,
        angular_radius=primary.angular_radius,
    )
    return take_out_sun(np.asarray(envmap.radiance), sun)
