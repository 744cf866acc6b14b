"""A small street of four pictures, one of each documented size, behind the look-alike server."""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.fetch import FetchSettings, PlaceSettings
from panokit.io.images import encode_jpeg
from panokit.synthetic.pictures import ServedPicture
from panokit.synthetic.server import StreetServer

KEY = "AIzaSy-the-fixed-key-of-the-tests"
STREET = PlaceSettings(name="The street", latitude_deg=48.5015, longitude_deg=7.7, radius_m=600)
WIDTHS_PX = (16384, 13312, 5376, 3328)


def picture_bytes(width_px: int = 512) -> bytes:
    y, x = np.indices((width_px // 2, width_px))
    pixels = np.stack([x % 200 + 40, y % 200 + 40, (x + y) % 200 + 40], axis=-1)
    return encode_jpeg(pixels.astype(np.uint8))


@pytest.fixture(scope="session")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> list[ServedPicture]:
    image = tmp_path_factory.mktemp("served") / "image.jpg"
    image.write_bytes(picture_bytes())
    return [
        ServedPicture(
            image=image,
            capture=Capture(
                provider="test",
                id=f"pano-{width_px}",
                license=license_from_spdx("CC-BY-4.0", "a mapper"),
                latitude_deg=48.5 + index * 0.001,
                longitude_deg=7.7,
                time=datetime(2024, 5, 6, 7, 8, 9, tzinfo=UTC),
                time_precision=TimePrecision.SECOND,
                heading_deg=350.0,
                pitch_deg=1.5,
                roll_deg=-2.0,
                width_px=width_px,
                height_px=width_px // 2,
            ),
        )
        for index, width_px in enumerate(WIDTHS_PX)
    ]


@pytest.fixture
def server(
    pictures: list[ServedPicture], monkeypatch: pytest.MonkeyPatch
) -> Iterator[StreetServer]:
    monkeypatch.setenv("GOOGLE_MAPS_API_KEY", KEY)
    with StreetServer(pictures, key=KEY) as running:
        yield running


def panoramax(server: StreetServer, **changes: object) -> FetchSettings:
    """Settings that fetch the small half of the street from the look-alike Panoramax."""
    defaults: dict[str, object] = {
        "places": (STREET,),
        "count": 4,
        "endpoint": server.url,
        "requests_per_s": 1000,
    }
    return FetchSettings.model_validate(defaults | changes)


def google(server: StreetServer, **changes: object) -> FetchSettings:
    """Settings that fetch the street from the look-alike Map Tiles API, at zoom 2."""
    defaults = {"source": "google-tiles", "accept_terms": ("google",), "zoom": 2}
    return panoramax(server, **(defaults | changes))


def folders(out: Path) -> set[str]:
    """The names of the capture folders, complete or not."""
    captures = out / "captures"
    return {path.name for path in captures.iterdir()} if captures.exists() else set()
