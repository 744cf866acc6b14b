"""Panoramas and environment maps on disk, each with its record NAME.json beside it.

The record is the receipt: it is written last, and says with which key (stage, version,
settings, inputs, weights) and with which bytes the picture was made.
"""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture, local_capture
from panokit.envmap import Anchor, EnvironmentMap
from panokit.errors import ImageError, RecordError, UsageError
from panokit.frames import Frame
from panokit.io.exr import read_exr, write_exr
from panokit.io.files import file_entry, read_bytes, read_json, write_bytes, write_json
from panokit.io.gpano import CroppedArea, gpano_xmp, read_metadata
from panokit.io.images import LDR_SUFFIXES, decode_image, encode_jpeg, encode_png
from panokit.io.radiance import read_radiance, write_radiance
from panokit.panorama import Panorama
from panokit.provenance import Provenance

HDR_SUFFIXES = (".exr", ".hdr")
PANORAMA_SCHEMA = "panokit.panorama/1"
MAP_SCHEMA = "panokit.map/1"


def record_path(path: Path) -> Path:
    """Where the record of a picture lies."""
    return path.with_suffix(".json")


def mask_path(path: Path) -> Path:
    """Where the valid mask of a panorama lies, if it has one."""
    return path.with_name(path.stem + ".mask.png")


def read_mask(path: Path) -> NDArray[np.bool_]:
    """A mask from a picture: (H, W) bool, True where it is brighter than mid gray.

    Raises:
        ImageError: If it is not an image.
        StorageError: If it cannot be read.
    """
    data = np.frombuffer(read_bytes(path), np.uint8)
    try:
        mask = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE)
    except cv2.error:  # on an empty file
        mask = None
    if mask is None:
        raise ImageError(f"The mask {path} is not an image. Make it again.", reason="not-an-image")
    return np.asarray(mask > 127)


def read_panorama(path: Path) -> Panorama:
    """A panorama from a JPEG, PNG, WebP or TIFF file.

    Its record tells license, frame and provenance. A file without one gets a capture of its
    own from its GPano and EXIF tags, with the license "unknown"; a cropped panorama is
    placed in the full sphere and the rest marked as not valid.

    Raises:
        ImageError: If the picture cannot be used, with the reason.
        StorageError: If it cannot be read.
    """
    path = Path(path)
    if path.suffix.lower() in HDR_SUFFIXES:
        raise ImageError(
            f"{path} is HDR already; a panorama is a JPEG, PNG, WebP or TIFF.", reason="is-hdr"
        )
    data = read_bytes(path)
    pixels = decode_image(data, what=str(path))
    record = _record_of(path, PANORAMA_SCHEMA)
    if record is not None:
        mask = mask_path(path)
        return Panorama(
            pixels=pixels,
            valid=read_mask(mask) if mask.name in record["files"] else None,
            capture=Capture.from_json(record["capture"]),
            frame=Frame(record["frame"]),
            provenance=Provenance.from_json(record["provenance"]),
        )
    known, area = read_metadata(data)
    valid = None
    if area is not None and not area.is_whole:
        pixels, valid = _place(pixels, area)
    size = {"width_px": pixels.shape[1], "height_px": pixels.shape[0]}
    capture = local_capture(path.stem, **known, **size)
    tilted = any(abs(known.get(name) or 0) > 0.05 for name in ("pitch_deg", "roll_deg"))
    try:
        return Panorama(
            pixels=pixels,
            valid=valid,
            capture=capture,
            frame=Frame.CAMERA if tilted else Frame.LEVEL,
        )
    except ImageError as error:
        raise ImageError(f"{path}: {error}", reason=error.reason, values=error.values) from error


def _place(
    pixels: NDArray[np.uint8], area: CroppedArea
) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """A partial panorama in its full sphere, at the picture's own resolution."""
    scale = pixels.shape[1] / area.width_px
    height = round(area.full_height_px * scale)
    full = np.zeros((height, 2 * height, 3), np.uint8)
    valid = np.zeros(full.shape[:2], np.bool_)
    top, left = round(area.top_px * scale), round(area.left_px * scale)
    fitting = pixels[: height - top, : 2 * height - left]
    window = np.s_[top : top + fitting.shape[0], left : left + fitting.shape[1]]
    full[window], valid[window] = fitting, True
    return full, valid


def write_panorama(
    panorama: Panorama,
    path: Path,
    *,
    quality: int = 95,
    key: str = "",
    encoded: bytes | None = None,
) -> None:
    """Write a panorama as JPEG with photo-sphere tags, its mask if it has one, then its record.

    Args:
        panorama: What to write.
        path: NAME.jpg; NAME.mask.png and NAME.json go beside it.
        quality: Of the JPEG.
        key: What the picture was made from and with; see `panokit.records.stage_key`.
        encoded: A JPEG of just these pixels, to be written as it is.
    """
    path = Path(path)
    heading = 0.0 if panorama.frame is Frame.WORLD else panorama.capture.heading_deg
    xmp = gpano_xmp(
        panorama.width_px,
        panorama.height_px,
        panorama.capture,
        heading_deg=heading,
        leveled=panorama.frame is not Frame.CAMERA,
    )
    write_bytes(path, encoded or encode_jpeg(panorama.pixels, quality=quality, xmp=xmp))
    files = {path.name: file_entry(path)}
    if panorama.valid is not None:
        mask = mask_path(path)
        write_bytes(mask, encode_png(panorama.valid.astype(np.uint8) * 255))
        files[mask.name] = file_entry(mask)
    write_json(
        record_path(path),
        {
            "schema": PANORAMA_SCHEMA,
            "key": key,
            "capture": panorama.capture.to_json(),
            "frame": str(panorama.frame),
            "provenance": panorama.provenance.to_json(),
            "files": files,
        },
    )


def read_environment_map(
    path: Path,
    *,
    repair: bool = False,
    layer: str | None = None,
    part: int | str | None = None,
) -> EnvironmentMap:
    """An environment map from an .exr or .hdr file.

    Args:
        path: The file; its record, if there is one, tells frame, anchor and provenance.
        repair: Clean values that are not physical instead of refusing them: NaN and negative
            become 0, infinite becomes the largest finite value.
        layer: Of an EXR with several layers, the one to read.
        part: Of an EXR with several parts, the one to read, by number or name.

    Raises:
        ImageError: If the map cannot be used, with the reason.
        StorageError: If it cannot be read.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    attributes: dict[str, str] = {}
    if suffix == ".exr":
        radiance, attributes = read_exr(path, layer=layer, part=part, repair=repair)
    elif suffix == ".hdr":
        radiance = read_radiance(path)
    else:
        hint = "Expand it first with `panokit expand`." if suffix in LDR_SUFFIXES else ""
        raise ImageError(f"{path} is not an .exr or .hdr map. {hint}".strip(), reason="not-hdr")
    if repair:
        radiance = np.maximum(radiance, 0)
    record = _record_of(path, MAP_SCHEMA) or {}
    capture = record.get("capture")
    try:
        return EnvironmentMap(
            radiance=radiance,
            frame=Frame(record.get("frame") or attributes.get("frame") or Frame.LEVEL),
            anchor=Anchor(record.get("anchor") or attributes.get("anchor") or Anchor.RELATIVE),
            capture=Capture.from_json(capture) if capture else None,
            provenance=Provenance.from_json(record.get("provenance", [])),
        )
    except ImageError as error:
        raise ImageError(f"{path}: {error}", reason=error.reason, values=error.values) from error


def write_environment_map(
    envmap: EnvironmentMap,
    path: Path,
    *,
    key: str = "",
    half: bool = False,
    compression: str = "zip",
) -> None:
    """Write a map as EXR or as Radiance .hdr, by suffix, then its record NAME.json.

    Args:
        envmap: What to write.
        path: NAME.exr or NAME.hdr.
        key: What the map was made from and with; see `panokit.records.stage_key`.
        half: Store an EXR as half floats instead of float32; see `panokit.io.exr.write_exr`.
        compression: Of an EXR: "zip", "piz", "dwaa", ...

    Raises:
        UsageError: If a .hdr is asked to be half or compressed otherwise.
        ImageError: If half floats cannot hold the map's range.
        StorageError: If a file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() == ".hdr":
        if half or compression != "zip":
            raise UsageError(f"{path} is a Radiance file, which has one form. Write an .exr.")
        write_radiance(path, envmap.radiance)
    else:
        attributes = _attributes(envmap)
        write_exr(path, envmap.radiance, attributes, half=half, compression=compression)
    write_json(
        record_path(path),
        {
            "schema": MAP_SCHEMA,
            "key": key,
            "capture": envmap.capture and envmap.capture.to_json(),
            "frame": str(envmap.frame),
            "anchor": str(envmap.anchor),
            "provenance": envmap.provenance.to_json(),
            "files": {path.name: file_entry(path)},
        },
    )


def _attributes(envmap: EnvironmentMap) -> dict[str, Any]:
    attributes: dict[str, Any] = {
        "panokit:frame": str(envmap.frame),
        "panokit:anchor": str(envmap.anchor),
        "panokit:projection": "equirectangular",
    }
    if envmap.anchor is Anchor.LUMINANCE:
        attributes["whiteLuminance"] = 1.0  # cd/m2 of R = G = B = 1
    capture = envmap.capture
    if capture is None:
        return attributes
    attributes["panokit:source"] = f"{capture.provider}:{capture.id}"
    attributes["panokit:license"] = capture.license.id
    if capture.license.attribution:
        attributes["owner"] = capture.license.attribution
    if capture.latitude_deg is not None and capture.longitude_deg is not None:
        attributes["latitude"] = float(capture.latitude_deg)
        attributes["longitude"] = float(capture.longitude_deg)
    if capture.time is not None and capture.time_precision == "second":
        attributes["capDate"] = capture.time.strftime("%Y:%m:%d %H:%M:%S")
        attributes["utcOffset"] = 0.0
    return attributes


def _record_of(path: Path, schema: str) -> dict[str, Any] | None:
    """The record beside a picture, or None where there is none of this kind."""
    record = record_path(path)
    if not record.exists():
        return None
    value = read_json(record)
    if not isinstance(value, dict) or value.get("schema") != schema:
        # A folder of pictures may hold JSON files of somebody else's.
        return None
    missing = {"frame", "provenance", "files"} - value.keys()
    if missing:
        raise RecordError(
            f"The record {record} has no {', '.join(sorted(missing))}. Make the file again.",
            reason="damaged-record",
        )
    return value
