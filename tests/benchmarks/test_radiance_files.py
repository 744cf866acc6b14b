"""Reading .hdr files beside OpenCV, as a ratio of CPU time in one run.

make bench
"""

import cv2
import numpy as np

from panokit.io import read_radiance, write_radiance
from tests.benchmarks.test_sphere import cpu_seconds


def test_reading_a_map(benchmark, tmp_path):
    rng = np.random.default_rng(0)
    smooth = cv2.resize(rng.normal(0, 2, (16, 32, 3)), (2048, 1024), interpolation=cv2.INTER_CUBIC)
    radiance = np.exp(smooth + rng.normal(0, 0.02, smooth.shape)).astype(np.float32)
    path = tmp_path / "a.hdr"
    write_radiance(path, radiance)
    benchmark.pedantic(read_radiance, (path,), rounds=3)
    ours = cpu_seconds(lambda: read_radiance(path), 5)
    other = cpu_seconds(lambda: cv2.imread(str(path), cv2.IMREAD_UNCHANGED), 5)
    benchmark.extra_info["cpu_over_cv2"] = round(ours / other, 2)
    theirs = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1]
    np.testing.assert_allclose(read_radiance(path), theirs, rtol=1e-6)
