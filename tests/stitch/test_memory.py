"""A full-size street panorama in a fresh process, and the most memory it took."""

import hashlib
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from panokit.capture import TileGrid, local_capture
from panokit.io.captures import StoredCapture, write_capture

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux's /proc"),
]

# VmHWM begins anew with the process; ru_maxrss would count what the parent had.
PROGRAM = """
import re, sys
from pathlib import Path
from panokit.io.captures import read_capture
from panokit.stitch import StitchSettings, stitch
width = int(sys.argv[2]) or None
panorama = stitch(read_capture(Path(sys.argv[1])), StitchSettings(width_px=width))
peak = int(re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
print(panorama.width_px, panorama.frame, peak // 1024)
"""


@pytest.fixture(scope="module")
def large_capture(tmp_path_factory):
    folder = tmp_path_factory.mktemp("large")
    (folder / "tiles").mkdir()
    grid = TileGrid(width_px=16384, height_px=8192, tile_width_px=512, tile_height_px=512)
    rng = np.random.default_rng(0)
    bodies = [
        cv2.imencode(".jpg", rng.integers(60, 160, (512, 512, 3), np.uint8))[1].tobytes()
        for _ in range(4)
    ]
    files = {}
    for column, row in grid.cells():
        body = bodies[(column + row) % len(bodies)]
        name = f"tiles/{column}_{row}.jpg"
        (folder / name).write_bytes(body)
        files[name] = hashlib.sha256(body).hexdigest()
    capture = local_capture("large", heading_deg=94.3, pitch_deg=-1.6, roll_deg=1.7)
    write_capture(StoredCapture(folder=folder, capture=capture, grid=grid, files=files))
    return folder


@pytest.mark.parametrize(
    ("width_px", "result_px", "most_mib"), [(4096, 4096, 400), (0, 16384, 1100)]
)
def test_the_most_memory_it_takes(large_capture, width_px, result_px, most_mib):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(large_capture), str(width_px)],
        capture_output=True,
        text=True,
        check=True,
    )
    width, frame, peak_mib = done.stdout.split()
    assert (int(width), frame) == (result_px, "world")
    assert int(peak_mib) < most_mib
