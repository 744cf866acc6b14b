from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
import requests

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.io.images import encode_jpeg
from panokit.synthetic import ServedPicture, StreetServer

KEY = "panokit"


def street_capture(name: str, width_px: int = 13312, **changes) -> Capture:
    known = {
        "provider": "synthetic",
        "id": name,
        "license": license_from_spdx("CC0-1.0", "the testers"),
        "latitude_deg": 44.5,
        "longitude_deg": -28.0,
        "time": datetime(2025, 6, 1, 12, 30, tzinfo=UTC),
        "time_precision": TimePrecision.SECOND,
        "heading_deg": 350.0,
        "pitch_deg": -2.5,
        "roll_deg": -5.5,
        "width_px": width_px,
        "height_px": width_px // 2,
    }
    return Capture(**(known | changes))


@pytest.fixture(scope="session")
def gradient() -> np.ndarray:
    """(512, 1024, 3) uint8, smooth and nowhere black, so that every place has its own color."""
    x, y = np.meshgrid(np.linspace(40, 250, 1024), np.linspace(40, 250, 512))
    return np.stack([x, y, np.full_like(x, 120)], axis=-1).astype(np.uint8)


@pytest.fixture(scope="session")
def image(gradient: np.ndarray, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("images") / "gradient.jpg"
    path.write_bytes(encode_jpeg(gradient, quality=98))
    return path


@pytest.fixture
def pictures(image: Path) -> list[ServedPicture]:
    """One picture here, one 33 m north of it, one far away and small."""
    return [
        ServedPicture(capture=street_capture("here"), image=image, sequence="walk"),
        ServedPicture(
            capture=street_capture("north", latitude_deg=44.5003), image=image, sequence="walk"
        ),
        ServedPicture(
            capture=street_capture("far", 1024, latitude_deg=44.6), image=image, sequence="other"
        ),
    ]


@pytest.fixture
def server(pictures: list[ServedPicture]) -> Iterator[StreetServer]:
    with StreetServer(pictures, key=KEY) as running:
        yield running


@pytest.fixture
def http() -> Iterator[requests.Session]:
    with requests.Session() as session:
        yield session


@pytest.fixture(scope="session")
def describe() -> Callable[..., Capture]:
    """Makes captures: `describe("name", width_px, **changes)`."""
    return street_capture
