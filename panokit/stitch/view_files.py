"""VIEWS.json: photos on disk and where they look, or with which exposures they were taken.

One file describes one place. Three kinds of contents, told apart by what the file says:
views with poses, photos without, and exposures of whole panoramas; views may be bracketed too.
`docs/formats.md` has the table.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panokit.capture import Capture, View, license_from_spdx, local_capture
from panokit.errors import RecordError
from panokit.io.files import read_bytes, read_json, sha256_of_bytes

SCHEMA = "panokit.views/1"
_POSE = ("heading_deg", "pitch_deg", "fov_deg")
_OPTIONAL = ("roll_deg", "masked_px", "width_px", "height_px")


@dataclass(frozen=True, slots=True, kw_only=True)
class Shot:
    """One picture of a view: its file, and its exposure in a unit of the user's."""

    name: str
    exposure: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewEntry:
    """One view: its shots and, where it is known, its pose as fields of `View`."""

    shots: tuple[Shot, ...]
    pose: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewSet:
    """What a VIEWS.json says.

    Attributes:
        folder: File names count from here.
        capture: Place, time, license.
        entries: The views; one without a pose for brackets of a whole panorama.
        whole: Each shot shows the whole sphere.
        curve: Of the camera: "srgb" or "debevec".
    """

    folder: Path
    capture: Capture
    entries: tuple[ViewEntry, ...]
    whole: bool = False
    curve: str = "srgb"

    @property
    def is_bracketed(self) -> bool:
        """Whether the result is HDR because of several exposures."""
        return any(len(entry.shots) > 1 for entry in self.entries)

    @property
    def is_hdr(self) -> bool:
        """Whether the result is an environment map."""
        names = (shot.name for entry in self.entries for shot in entry.shots)
        return self.is_bracketed or any(n.lower().endswith((".exr", ".hdr")) for n in names)

    def read(self, name: str) -> bytes:
        """The bytes of one of the files."""
        return read_bytes(self.folder / name)

    def digests(self) -> dict[str, str]:
        """File name -> SHA-256, of all files."""
        names = sorted({shot.name for entry in self.entries for shot in entry.shots})
        return {name: sha256_of_bytes(self.read(name)) for name in names}


def read_view_set(path: Path) -> ViewSet:
    """The photos that a VIEWS.json speaks of; the photos themselves are not read.

    Raises:
        RecordError: If it is not such a file, or something in it is missing or contradictory.
        StorageError: If it cannot be read.
    """
    record = read_json(path)
    if not isinstance(record, dict) or record.get("schema") != SCHEMA:
        found = record.get("schema") if isinstance(record, dict) else type(record).__name__
        raise RecordError(
            f'{path} is not a file of views: its "schema" is {found!r}, not "{SCHEMA}". '
            "The table in docs/formats.md shows what it holds.",
            reason="other-schema",
        )
    unknown = set(record) - {"schema", "views", "exposures", "curve", "capture", "license",
                             "attribution"}  # fmt: skip
    if unknown or ("views" in record) == ("exposures" in record):
        what = (
            f"fields that mean nothing here: {', '.join(sorted(unknown))}"
            if unknown
            else ('not exactly one of "views" and "exposures"')
        )
        raise _wrong(path, what)
    whole = "exposures" in record
    listed = [{"exposures": record["exposures"]}] if whole else record["views"]
    if not isinstance(listed, list) or not listed:
        raise _wrong(path, "no views")
    curve = record.get("curve", "srgb")
    if curve not in ("srgb", "debevec"):
        raise _wrong(path, f'the curve {curve!r}, which is neither "srgb" nor "debevec"')
    entries = tuple(_entry(path, number, entry) for number, entry in enumerate(listed))
    posed = {entry.pose is not None for entry in entries}
    if len(posed) > 1:
        raise _wrong(path, "poses for some of its views but not for all")
    return ViewSet(
        folder=path.parent,
        capture=_capture(path, record),
        entries=entries,
        whole=whole,
        curve=curve,
    )


def _entry(path: Path, number: int, entry: Any) -> ViewEntry:
    what = f"view {number}"
    if not isinstance(entry, dict) or ("name" in entry) == ("exposures" in entry):
        raise _wrong(path, f'{what} with not exactly one of "name" and "exposures"')
    unknown = set(entry) - {"name", "exposures", *_POSE, *_OPTIONAL}
    if unknown:
        raise _wrong(path, f"{what} with unknown fields: {', '.join(sorted(unknown))}")
    try:
        shots = (
            (Shot(name=str(entry["name"])),)
            if "name" in entry
            else tuple(
                Shot(name=str(shot["name"]), exposure=float(shot["exposure_s"]))
                for shot in entry["exposures"]
            )
        )
        given = [name for name in _POSE if name in entry]
        if given and len(given) < len(_POSE):
            missing = ", ".join(name for name in _POSE if name not in entry)
            raise _wrong(path, f"{what} without {missing}")
        pose: dict[str, Any] | None = None
        if given:
            pose = {name: float(entry[name]) for name in (*_POSE, "roll_deg") if name in entry}
            boxes = entry.get("masked_px", ())
            pose["masked_px"] = tuple(tuple(int(edge) for edge in box) for box in boxes)
            if not 0 < pose["fov_deg"] < 180:
                raise _wrong(path, f"{what} with a field of view of {pose['fov_deg']} degrees")
    except (KeyError, TypeError, ValueError) as error:
        raise _wrong(path, f"{what} that cannot be read ({error!r})") from None
    if not shots:
        raise _wrong(path, f"{what} without a picture")
    return ViewEntry(shots=shots, pose=pose)


def posed_view(entry: ViewEntry, width_px: int, height_px: int) -> View:
    """The view of an entry whose picture has this size."""
    pose = dict(entry.pose or {})
    return View(name=entry.shots[0].name, width_px=width_px, height_px=height_px, **pose)


def _capture(path: Path, record: Mapping[str, Any]) -> Capture:
    if "capture" in record:
        return Capture.from_json(record["capture"])
    known: dict[str, Any] = {}
    if "license" in record:
        known["license"] = license_from_spdx(
            str(record["license"]), str(record.get("attribution", ""))
        )
    return local_capture(path.stem, **known)


def _wrong(path: Path, what: str) -> RecordError:
    return RecordError(
        f"{path} has {what}. The table in docs/formats.md shows what it holds.",
        reason="damaged-record",
    )
