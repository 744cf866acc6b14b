"""Equirectangular pictures on this disk, described by their GPano and EXIF tags or records."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from panokit.capture import Capture, license_from_spdx, local_capture
from panokit.errors import ItemError, Rejection, SettingsError, StorageError
from panokit.fetch.geodesy import LatLon
from panokit.fetch.places import Place
from panokit.fetch.provider import Found
from panokit.fetch.settings import FetchSettings
from panokit.frames import Frame
from panokit.http import Client
from panokit.io import read_panorama
from panokit.io.files import read_bytes
from panokit.io.images import LDR_SUFFIXES
from panokit.panorama import Panorama


class Folder:
    """Takes every picture of a folder and of the folders in it."""

    usd_per_file = 0.0
    may_store = True

    def __init__(self, settings: FetchSettings, client: Client) -> None:
        if settings.folder is None:
            raise SettingsError('The source "folder" needs the setting folder: where to look.')
        if not settings.folder.is_dir():
            raise StorageError(f"{settings.folder} is not a folder. Check the path.")
        self._root = settings.folder
        self._settings = settings

    def find(self, place: Place | None, points: Sequence[LatLon]) -> Iterator[Found | Rejection]:
        """Every picture, in the order of the names; each is decoded once to know it is one."""
        seen: dict[str, Path] = {}
        for path in _pictures(self._root):
            name = path.relative_to(self._root).with_suffix("").as_posix()
            try:
                found = self._describe(path, name)
                other = seen.setdefault(found.capture.key, path)
                if other != path:
                    raise ItemError(
                        f"{path} and {other} have the same name; rename one of them.",
                        reason="duplicate-name",
                    )
                yield found
            except ItemError as error:
                yield Rejection.from_error(local_capture(name).key, "fetch", error)

    def read(self, found: Found, name: str) -> bytes:
        """The file as it is."""
        return read_bytes(Path(found.address))

    def _describe(self, path: Path, name: str) -> Found:
        panorama = read_panorama(path)
        if panorama.valid is not None:
            raise ItemError(
                f"{path} does not cover the full sphere. `panokit inpaint` takes it as it is.",
                reason="partial",
            )
        capture = _posed(panorama)
        if capture.provider == "folder":
            capture = replace(capture, id=name)
        if self._settings.license:
            terms = license_from_spdx(self._settings.license, self._settings.attribution)
            capture = replace(capture, license=terms)
        return Found(
            capture=capture,
            address=str(path),
            suffix=path.suffix.lower(),
            bytes=path.stat().st_size,
        )


def _posed(panorama: Panorama) -> Capture:
    """The capture with the pose of the pixels: those that panokit leveled are level now."""
    capture = panorama.capture
    if panorama.frame is Frame.WORLD:
        return replace(capture, heading_deg=0.0, pitch_deg=0.0, roll_deg=0.0)
    if panorama.frame is Frame.LEVEL and panorama.provenance.steps:
        return replace(capture, pitch_deg=0.0, roll_deg=0.0)
    return capture


def _pictures(root: Path) -> list[Path]:
    return sorted(
        path
        for path in root.rglob("*")
        if path.suffix.lower() in LDR_SUFFIXES
        and not path.name.endswith(".mask.png")
        and path.is_file()
    )
