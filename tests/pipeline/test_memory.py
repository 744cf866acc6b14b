"""A full-size street panorama goes through stitch and expand in little memory."""

import subprocess
import sys

import numpy as np
import pytest

from panokit.capture import TileGrid, local_capture
from panokit.io.captures import StoredCapture, tile_name, write_capture
from panokit.io.files import sha256_of_bytes, write_bytes
from panokit.io.images import encode_jpeg

MOST_BYTES = 3 << 30
_WORK = """
import re, sys
from pathlib import Path
from panokit.cli.main import main
assert main(sys.argv[1:]) == 0
# VmHWM begins anew with the process; ru_maxrss would count what the parent had.
status = Path("/proc/self/status").read_text()
print(int(re.search(r"VmHWM:\\s+(\\d+)", status)[1]) * 1024)
"""


def peak_bytes(*arguments: str) -> int:
    done = subprocess.run(
        [sys.executable, "-c", _WORK, *arguments], check=True, capture_output=True, text=True
    )
    return int(done.stdout.splitlines()[-1])


@pytest.mark.slow
def test_16384x8192_to_2048x1024_within_3_gib(tmp_path, record_property):
    rng = np.random.default_rng(0)
    tiles = [
        encode_jpeg(rng.integers(low, low + 60, (512, 512, 3), dtype=np.uint8), quality=88)
        for low in (20, 90, 180)
    ]
    grid = TileGrid(width_px=16384, height_px=8192, tile_width_px=512, tile_height_px=512, zoom=5)
    folder = tmp_path / "run" / "captures" / "folder-street"
    files = {}
    for column, row in grid.cells():
        data = tiles[(column * 7 + row) % 3]
        write_bytes(folder / tile_name(column, row), data)
        files[tile_name(column, row)] = sha256_of_bytes(data)
    capture = local_capture("street", heading_deg=77.0, pitch_deg=1.5, roll_deg=-0.8)
    write_capture(StoredCapture(folder=folder, capture=capture, grid=grid, files=files))
    run = str(tmp_path / "run")
    peaks = {
        "stitch": peak_bytes("stitch", run, "--width-px", "none"),
        "expand": peak_bytes("expand", run, "--width-px", "2048"),
    }
    for stage, peak in peaks.items():
        record_property(stage, peak)
        print(f"{stage}: {peak / 2**30:.2f} GiB")
        assert peak < MOST_BYTES, stage
