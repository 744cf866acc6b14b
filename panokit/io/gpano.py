"""Photo-sphere metadata (GPano XMP) and the EXIF tags that say where and when.

GPano: namespace http://ns.google.com/photos/1.0/panorama/; heading of the picture's center,
clockwise from north, then pitch and roll of the camera, in degrees.
"""

import io
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, timezone
from typing import Any

from PIL import Image, UnidentifiedImageError

from panokit.capture import Capture, TimePrecision, wrap_degrees

_NAMESPACE = "http://ns.google.com/photos/1.0/panorama/"
_FIELD = re.compile(rb'GPano:(\w+)(?:="([^"]*)"|>([^<]*)<)')
_GPS_IFD, _EXIF_IFD = 0x8825, 0x8769


@dataclass(frozen=True, slots=True, kw_only=True)
class CroppedArea:
    """Where a partial panorama lies in the full sphere, in its own pixels."""

    full_width_px: int
    full_height_px: int
    left_px: int
    top_px: int
    width_px: int
    height_px: int

    @property
    def is_whole(self) -> bool:
        """Whether the picture covers the full sphere."""
        return (self.width_px, self.height_px) == (self.full_width_px, self.full_height_px)


def read_metadata(data: bytes) -> tuple[dict[str, Any], CroppedArea | None]:
    """What a picture file says of its place, time and pose.

    Args:
        data: The whole file.

    Returns:
        Fields of `Capture`, only those that are there, and the cropped area if one is given.
        Damaged metadata counts as none: a picture is not rejected for its tags.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(io.BytesIO(data))
            exif = image.getexif()
            xmp = image.info.get("xmp", b"")
    except (UnidentifiedImageError, OSError, SyntaxError, ValueError):
        return {}, None
    packet = xmp if isinstance(xmp, bytes) else str(xmp).encode()
    tags = {m[1].decode(): (m[2] or m[3]).decode("utf-8", "replace") for m in
            _FIELD.finditer(packet)}  # fmt: skip
    return _pose(tags) | _place(exif) | _time(exif), _cropped(tags)


def _pose(tags: Mapping[str, str]) -> dict[str, Any]:
    names = {
        "PoseHeadingDegrees": "heading_deg",
        "PosePitchDegrees": "pitch_deg",
        "PoseRollDegrees": "roll_deg",
    }
    found = {}
    for tag, field in names.items():
        value = _number(tags.get(tag))
        if value is not None:
            found[field] = value % 360 if field == "heading_deg" else wrap_degrees(value)
    return found


def _cropped(tags: Mapping[str, str]) -> CroppedArea | None:
    names = (
        "FullPanoWidthPixels",
        "FullPanoHeightPixels",
        "CroppedAreaLeftPixels",
        "CroppedAreaTopPixels",
        "CroppedAreaImageWidthPixels",
        "CroppedAreaImageHeightPixels",
    )
    values = [_number(tags.get(name)) for name in names]
    if any(value is None for value in values):
        return None
    full_width, full_height, left, top, width, height = (int(v or 0) for v in values)
    inside = 0 <= left <= full_width - width and 0 <= top <= full_height - height
    if min(full_width, full_height, width, height) <= 0 or not inside:
        return None
    return CroppedArea(
        full_width_px=full_width,
        full_height_px=full_height,
        left_px=left,
        top_px=top,
        width_px=width,
        height_px=height,
    )


def _place(exif: Image.Exif) -> dict[str, Any]:
    gps = exif.get_ifd(_GPS_IFD)
    found: dict[str, Any] = {}
    for field, reference, value, negative, limit in (
        ("latitude_deg", 1, 2, "S", 90.0),
        ("longitude_deg", 3, 4, "W", 180.0),
    ):
        try:
            degrees, minutes, seconds = (float(part) for part in gps[value])
        except (KeyError, TypeError, ValueError, ZeroDivisionError):
            continue
        angle = degrees + minutes / 60 + seconds / 3600
        angle = -angle if str(gps.get(reference, "")).upper().startswith(negative) else angle
        if abs(angle) <= limit:
            found[field] = angle
    return found if len(found) == 2 else {}


def _time(exif: Image.Exif) -> dict[str, Any]:
    tags = exif.get_ifd(_EXIF_IFD)
    try:
        local = datetime.strptime(str(tags[0x9003]), "%Y:%m:%d %H:%M:%S")
        sign, hours, minutes = re.fullmatch(r"([+-])(\d\d):(\d\d)", str(tags[0x9011])).groups()  # type: ignore[union-attr]
    except (KeyError, ValueError, AttributeError):
        # Without its offset from UTC a camera's clock names no moment.
        return {}
    offset = timedelta(hours=int(hours), minutes=int(minutes)) * (-1 if sign == "-" else 1)
    moment = local.replace(tzinfo=timezone(offset)).astimezone(UTC)
    return {"time": moment, "time_precision": TimePrecision.SECOND}


def _number(text: str | None) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


def gpano_xmp(
    width_px: int, height_px: int, capture: Capture, *, heading_deg: float | None, leveled: bool
) -> bytes:
    """The XMP packet that makes viewers show a JPEG as a sphere.

    Args:
        width_px: Of the picture.
        height_px: Of the picture.
        capture: Gives pitch and roll where the picture is not leveled.
        heading_deg: Of the picture's center as it is now, or None.
        leveled: Whether pitch and roll are already taken out of the pixels.
    """
    fields: dict[str, Any] = {
        "ProjectionType": "equirectangular",
        "UsePanoramaViewer": "True",
        "CroppedAreaImageWidthPixels": width_px,
        "CroppedAreaImageHeightPixels": height_px,
        "FullPanoWidthPixels": width_px,
        "FullPanoHeightPixels": height_px,
        "CroppedAreaLeftPixels": 0,
        "CroppedAreaTopPixels": 0,
    }
    if heading_deg is not None:
        fields["PoseHeadingDegrees"] = f"{heading_deg % 360:.4f}"
    if leveled:
        fields |= {"PosePitchDegrees": "0", "PoseRollDegrees": "0"}
    elif capture.pitch_deg is not None and capture.roll_deg is not None:
        fields["PosePitchDegrees"] = f"{capture.pitch_deg:.4f}"
        fields["PoseRollDegrees"] = f"{capture.roll_deg:.4f}"
    attributes = " ".join(f'GPano:{name}="{value}"' for name, value in fields.items())
    return (
        '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>'
        '<x:xmpmeta xmlns:x="adobe:ns:meta/">'
        '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
        f'<rdf:Description rdf:about="" xmlns:GPano="{_NAMESPACE}" {attributes}/>'
        '</rdf:RDF></x:xmpmeta><?xpacket end="w"?>'
    ).encode()
