"""A town of panoramas of the four documented sizes, each with a picture of its own."""

from collections import Counter
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

import cv2
import numpy as np

from panokit.capture import Capture, TimePrecision, license_from_spdx
from panokit.fetch import FetchSettings, PlaceSettings
from panokit.io.images import encode_jpeg
from panokit.synthetic.exchange import Request
from panokit.synthetic.pictures import ServedPicture

WIDTHS_PX = (16384, 13312, 5376, 3328)
# How many tiles each has at zoom 3, by the rule of sizes at a zoom: 8x4, 7x4, 6x3, 7x4.
TILES_AT_ZOOM_3 = {16384: 32, 13312: 28, 5376: 18, 3328: 28}
TOWN = PlaceSettings(name="The town", latitude_deg=48.5, longitude_deg=7.7, radius_m=650)
_STEP_DEG = (0.00045, 0.00068)  # 50 m north, 50 m east
_COLUMNS = 15


def town(folder: Path, count: int) -> list[ServedPicture]:
    """Panoramas on a grid around the middle of the town, every fourth of the same size."""
    pictures = []
    for number in range(count):
        path = folder / f"{number}.jpg"
        coarse = np.random.default_rng(number).uniform(40, 250, (8, 16, 3)).astype(np.float32)
        fine = cv2.resize(coarse, (128, 64), interpolation=cv2.INTER_CUBIC)
        path.write_bytes(encode_jpeg(np.clip(fine, 40, 250).astype(np.uint8)))
        row, column = divmod(number, _COLUMNS)
        width_px = WIDTHS_PX[number % len(WIDTHS_PX)]
        capture = Capture(
            provider="test",
            id=f"pano-{number:03}",
            license=license_from_spdx("CC-BY-4.0", "a mapper"),
            latitude_deg=48.5 + (row - 7) * _STEP_DEG[0],
            longitude_deg=7.7 + (column - 7) * _STEP_DEG[1],
            time=datetime(2024, 5, 6, tzinfo=UTC),
            time_precision=TimePrecision.SECOND,
            heading_deg=float(number),
            width_px=width_px,
            height_px=width_px // 2,
        )
        pictures.append(ServedPicture(capture=capture, image=path))
    return pictures


def wanted(url: str, count: int, **changes: object) -> FetchSettings:
    """Settings that fetch that many panoramas of the town as Google tiles."""
    defaults: dict[str, object] = {
        "source": "google-tiles",
        "accept_terms": ("google",),
        "places": (TOWN,),
        "count": count,
        "zoom": 3,
        "endpoint": url,
        "requests_per_s": 5000,
        "min_distance_m": 10,
    }
    return FetchSettings.model_validate(defaults | changes)


def tiles_asked(requests: list[Request]) -> Counter[tuple[str, str]]:
    """(panorama, tile) -> how often it was asked for."""
    return Counter(
        (one.query["panoId"], one.path) for one in requests if "/streetview/tiles/" in one.path
    )


def contents(run: Path) -> Mapping[str, bytes]:
    """Every file below the captures of a run, by its path."""
    captures = run / "captures"
    return {
        str(path.relative_to(captures)): path.read_bytes()
        for path in sorted(captures.rglob("*"))
        if path.is_file()
    }
