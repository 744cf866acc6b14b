"""Poly Haven: HDR maps under CC0, through its public API.

No key, no charge. The service asks every program to name itself (our User-Agent does) and
applications that show what it offers to say "Powered by Poly Haven".
"""

import hashlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any

from panokit.capture import Capture, license_from_spdx
from panokit.errors import ItemError, NetworkError, Rejection, UsageError
from panokit.fetch.settings import PullSettings
from panokit.http import Client, Request
from panokit.io.files import write_bytes

ENDPOINT = "https://api.polyhaven.com"
_SIDES = ("1k", "2k", "4k", "8k", "16k")
# The kind of scene of a map that is in all of these categories; the first that fits.
_SCENES: tuple[tuple[str, frozenset[str]], ...] = tuple(
    (scene, frozenset(words.split(", ")))
    for scene, words in (
        ("indoor_studio", "studio"),
        ("sky_only", "skies"),
        ("indoor_artificial", "indoor, artificial light"),
        ("indoor_windows", "indoor, natural light"),
        ("indoor_artificial", "indoor"),
        ("outdoor_night", "outdoor, night"),
        ("outdoor_sunrise_sunset", "outdoor, sunrise-sunset"),
        ("outdoor_sunrise_sunset", "outdoor, sunrise/sunset"),
        ("outdoor_overcast", "outdoor, overcast"),
        ("outdoor_sunny", "outdoor, clear"),
        ("outdoor_sunny", "outdoor, midday"),
        ("outdoor_sunny", "outdoor, partly cloudy"),
        ("outdoor_overcast", "outdoor, low contrast"),
        ("outdoor_sunny", "outdoor, high contrast"),
        ("outdoor", "outdoor"),
    )
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RemoteMap:
    """An HDR map that the service has.

    Attributes:
        capture: Who made it, where, under which license.
        resolution: What is offered of what was asked: "2k".
        address: Where its file is.
        bytes: How large it is.
        md5: Of the file, in hex.
        suffix: ".exr" or ".hdr".
    """

    capture: Capture
    resolution: str
    address: str
    bytes: int
    md5: str
    suffix: str

    @property
    def name(self) -> str:
        """What it is called in a library: map and resolution."""
        return f"{self.capture.id}_{self.resolution}"


class PolyHaven:
    """The API of api.polyhaven.com.

    Args:
        settings: What is wanted.
        client: Sends the requests.
    """

    def __init__(self, settings: PullSettings, client: Client) -> None:
        self._endpoint = (settings.endpoint or ENDPOINT).rstrip("/")
        self._settings = settings
        self._client = client

    def wanted(self) -> list[Capture]:
        """The maps that the settings ask for; the files of none are looked up yet.

        Raises:
            UsageError: If nothing was asked for, or a name is not known.
        """
        settings = self._settings
        asked = (settings.names, settings.category, settings.query, settings.count)
        if not any(asked) and settings.published_before is None:
            raise UsageError(
                "Say which maps: by name, or with --category, --query, --published-before or "
                "--count. There are close to a thousand."
            )
        params = {"type": "hdris"}
        if settings.category:
            params["categories"] = ",".join(settings.category)
        url = f"{self._endpoint}/assets"
        try:
            reply = self._client.send(Request(url=url, params=params))
        except ItemError as error:
            raise NetworkError(f"{error} Check the category and the endpoint.") from None
        return select(reply.json(), settings)

    def look_up(self, maps: Sequence[Capture]) -> Iterator[RemoteMap | Rejection]:
        """The file of each map, at the resolution wanted or the next smaller one."""
        for capture in maps:
            url = f"{self._endpoint}/files/{capture.id}"
            try:
                reply = self._client.send(Request(url=url))
                yield parse_files(reply.body, capture, self._settings)
            except ItemError as error:
                yield Rejection.from_error(capture.key, "pull", error)

    def download(self, remote: RemoteMap, folder: Path) -> Path:
        """Fetch a map into a folder; it is there whole, with the digest promised, or not at all.

        Raises:
            ItemError: If the service does not have it, or its digest stays wrong.
        """
        request = Request(
            url=remote.address,
            expect="image",
            check=lambda body: check_file(body, remote),
        )
        path = folder / f"{remote.name}{remote.suffix}"
        write_bytes(path, self._client.send(request).body)
        return path


def select(assets: Any, settings: PullSettings) -> list[Capture]:
    """The maps of an /assets reply that the settings want.

    Raises:
        NetworkError: If it is not such a reply.
        UsageError: If a name is not known.
    """
    if not isinstance(assets, dict) or not all(isinstance(one, dict) for one in assets.values()):
        raise NetworkError("Poly Haven's answer has no list of maps. Check the endpoint.")
    # 0 is the type of HDR maps; a server that ignores the question sends textures too.
    maps = {name: one for name, one in assets.items() if one.get("type", 0) == 0}
    unknown = [name for name in settings.names if name not in maps]
    if unknown:
        where = " in these categories" if settings.category else ""
        raise UsageError(
            f"Poly Haven has no HDR map {unknown[0]!r}{where}. Names are those in the addresses "
            "of its pages: polyhaven.com/a/NAME."
        )
    words = settings.query.casefold().split()
    chosen = [
        name
        for name in (settings.names or maps)
        if all(word in _text(name, maps[name]) for word in words)
        and set(settings.category) <= set(maps[name].get("categories") or settings.category)
        and _is_early(maps[name], settings.published_before)
    ]
    if not settings.names:
        chosen.sort(key=lambda name: (_rank(maps[name], settings.order), name))
    return [capture_of(name, maps[name]) for name in dict.fromkeys(chosen)][: settings.count]


def capture_of(name: str, asset: Mapping[str, Any]) -> Capture:
    """What the service says of a map."""
    authors = ", ".join((asset.get("authors") or {}).keys()) or "Poly Haven"
    coords = asset.get("coords")
    has_place = isinstance(coords, list) and len(coords) == 2 and None not in coords
    page = f"https://polyhaven.com/a/{name}"
    details = {
        "title": asset.get("name"),
        "scene": scene_of(asset),
        "categories": asset.get("categories"),
        "category": asset.get("category"),
        "tags": asset.get("tags"),
        "brackets_ev": asset.get("evs_cap"),
        "white_balance_k": asset.get("whitebalance"),
        "files_hash": asset.get("files_hash"),
    }
    return Capture(
        provider="polyhaven",
        id=name,
        license=license_from_spdx("CC0-1.0", f"{authors} via Poly Haven (CC0), {page}"),
        latitude_deg=float(coords[0]) if has_place and coords else None,
        longitude_deg=float(coords[1]) if has_place and coords else None,
        # The service itself calls its times of capture untrustworthy: none is taken over.
        source_url=page,
        details={key: value for key, value in details.items() if value},
    )


def scene_of(asset: Mapping[str, Any]) -> str:
    """The kind of scene, in one word for balancing: "outdoor_night", "indoor_windows", ...

    "" where the service's categories do not tell.
    """
    known = {str(word).casefold() for word in asset.get("categories") or ()}
    return next((scene for scene, words in _SCENES if words <= known), "")


def parse_files(body: bytes, capture: Capture, settings: PullSettings) -> RemoteMap:
    """The file of a /files reply that the settings want.

    Raises:
        ItemError: If there is none ("no-file"), or it is described in another way
            ("bad-metadata").
    """
    reply = json.loads(body)
    try:
        offered: Mapping[str, Any] = reply["hdri"]
        allowed = _SIDES[: _SIDES.index(settings.resolution) + 1]
        sizes = [side for side in allowed if settings.format in offered.get(side, {})]
        if not sizes:
            raise ItemError(
                f"{capture.key}: there is no .{settings.format} of {settings.resolution} or less.",
                reason="no-file",
            )
        entry = offered[sizes[-1]][settings.format]
        return RemoteMap(
            capture=replace(
                capture, width_px=1024 * int(sizes[-1][:-1]), height_px=512 * int(sizes[-1][:-1])
            ),
            resolution=sizes[-1],
            address=str(entry["url"]),
            bytes=int(entry["size"]),
            md5=_md5(entry["md5"]),
            suffix=f".{settings.format}",
        )
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise ItemError(
            f"{capture.key}: the list of its files is not usable ({error!r}).",
            reason="bad-metadata",
        ) from None


def check_file(body: bytes, remote: RemoteMap) -> None:
    """Check that a body has the size and the digest that were promised.

    Raises:
        ItemError: If not ("wrong-digest").
    """
    if len(body) != remote.bytes or _digest(body) != remote.md5:
        raise ItemError(
            f"The file of {remote.name} is not the one that was promised: {len(body)} bytes, "
            f"expected {remote.bytes} with MD5 {remote.md5}. Pull it again later.",
            reason="wrong-digest",
        )


def _digest(body: bytes) -> str:
    # MD5 is what the service publishes; it guards against accidents, not against malice.
    return hashlib.md5(body, usedforsecurity=False).hexdigest()


def _md5(text: Any) -> str:
    if not re.fullmatch(r"[0-9a-f]{32}", str(text).lower()):
        raise ValueError(f"{text!r} is no MD5")
    return str(text).lower()


def _is_early(asset: Mapping[str, Any], before: date | None) -> bool:
    """Whether a map was published before a day; no, where the service does not say when."""
    if before is None:
        return True
    seconds = asset.get("date_published")
    return isinstance(seconds, int | float) and datetime.fromtimestamp(seconds, UTC).date() < before


def _rank(asset: Mapping[str, Any], order: str) -> float:
    if order == "published":
        seconds = asset.get("date_published")
        return float(seconds) if isinstance(seconds, int | float) else float("inf")
    return -float(asset.get("download_count") or 0)


def _text(name: str, asset: Mapping[str, Any]) -> str:
    words = [name, str(asset.get("name") or ""), str(asset.get("category") or "")]
    words += [str(word) for word in (*(asset.get("tags") or ()), *(asset.get("categories") or ()))]
    return " ".join(words).casefold()
