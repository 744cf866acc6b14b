"""The cube layout against the formulas of ImfEnvmap.h, written out pixel by pixel."""

import numpy as np
import OpenEXR
import pytest

from panokit.errors import ImageError
from panokit.io.exr import iterate_exr_rows, read_exr
from panokit.sphere import energy, equirect_directions

SIZE = 33


def cube(function):
    """A cube map of a function of OpenEXR's directions."""
    pixels = np.zeros((6 * SIZE, SIZE, 3), np.float32)
    for face in range(6):
        for a in range(SIZE):
            for b in range(SIZE):
                # (a, b) is ImfEnvmap's position in face, and p, q its coordinates in [-1, 1].
                p, q = a / (SIZE - 1) * 2 - 1, b / (SIZE - 1) * 2 - 1
                direction = [
                    (1, p, q), (-1, p, q), (p, 1, q), (p, -1, q), (p, q, 1), (p, q, -1)
                ][face]  # fmt: skip
                last = SIZE - 1
                x, y = [
                    (b, last - a), (last - b, last - a), (a, last - b), (a, b),
                    (last - a, last - b), (a, last - b),
                ][face]  # fmt: skip
                unit = np.array(direction) / np.linalg.norm(direction)
                pixels[face * SIZE + y, x] = function(unit)
    return pixels


def write(path, pixels):
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "envmap": OpenEXR.ENVMAP_CUBE,
    }
    with OpenEXR.File(header, {"RGB": pixels}) as file:
        file.write(str(path))
    return path


def test_a_cube_map_is_unrolled(tmp_path):
    path = write(tmp_path / "a.exr", cube(lambda d: 2 + d * [1, 0.9, 0.8]))
    read, _ = read_exr(path)
    assert read.shape == (2 * SIZE, 4 * SIZE, 3)
    # panokit's (x, y, z) is OpenEXR's (-x, y, -z).
    ours = equirect_directions(4 * SIZE, 2 * SIZE) * [-1, 1, -1]
    np.testing.assert_allclose(read, 2 + ours * [1, 0.9, 0.8], atol=8e-3)
    np.testing.assert_allclose(energy(read), 8 * np.pi, rtol=1e-3)


def test_what_is_no_cube(tmp_path):
    path = write(tmp_path / "a.exr", np.ones((16, 32, 3), np.float32))
    with pytest.raises(ImageError, match="not six squares") as caught:
        read_exr(path)
    assert caught.value.reason == "wrong-size"
    with pytest.raises(ImageError, match="no rows of a sphere"):
        next(iterate_exr_rows(path))
