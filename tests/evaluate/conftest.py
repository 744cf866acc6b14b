"""Eight small worlds with lamps and suns, as maps with a manifest."""

import csv
from pathlib import Path

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.evaluate import probe_set
from panokit.io import sha256_of_file, write_environment_map

COUNT = 8


def world(index: int, height: int = 64) -> np.ndarray:
    """Dim walls and a lamp, (H, 2H, 3) float32; the last one has a sun."""
    random = np.random.default_rng(index)
    radiance = random.uniform(0.2, 0.4, (height, 2 * height, 1)) * np.array([1, 0.95, 0.9])
    row, column = 8 + 3 * index, (29 * index) % (2 * height - 8)
    light = 2e4 if index == COUNT - 1 else 12.0 * (index + 1)
    radiance[row : row + 4, column : column + 6] = light
    return radiance.astype(np.float32)


@pytest.fixture(scope="session")
def probe_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("probes")
    rows = []
    for index in range(COUNT):
        path = folder / f"map{index}.exr"
        write_environment_map(EnvironmentMap(radiance=world(index)), path)
        rows.append(
            {
                "name": f"map{index}",
                "file": path.name,
                "category": "indoor+urban" if index % 2 else "outdoor",
                "split_group": f"place{index}",
                "usable_for": "training",
                "sha256": sha256_of_file(path),
            }
        )
    with (folder / "manifest.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    return folder


@pytest.fixture(autouse=True)
def _small(monkeypatch: pytest.MonkeyPatch):
    """Probes at their own small size, so that a test takes seconds."""
    monkeypatch.setattr(probe_set, "PROBE_WIDTH_PX", 128)
