"""A tiny world to train in: six maps, one lamp each, as Radiance files with a manifest."""

import csv
from pathlib import Path

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.io import sha256_of_file, write_environment_map

COUNT = 6


def lamp_map(index: int) -> np.ndarray:
    random = np.random.default_rng(index)
    radiance = random.uniform(0.02, 0.1, (128, 256, 1)) * np.array([1, 0.95, 0.9])
    row, column = 20 + 10 * index, 40 * index
    radiance[row : row + 6, column : column + 6] = 10.0 * (index + 1)
    return radiance.astype(np.float32)


@pytest.fixture(scope="session")
def probe_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("probes")
    rows = []
    for index in range(COUNT):
        path = folder / f"map{index}.exr"
        write_environment_map(EnvironmentMap(radiance=lamp_map(index)), path)
        rows.append(
            {
                "name": f"map{index}",
                "file": path.name,
                "category": "indoor+urban" if index % 2 else "outdoor",
                "split_group": f"place{index // 2}" if index < 2 else f"place{index}",
                "usable_for": "training" if index != 5 else "robustness only",
                "sha256": sha256_of_file(path),
            }
        )
    with (folder / "manifest.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    return folder
