"""Make the picture of one probe in every projection.

python docs/pictures/make_projections.py PROBE.hdr docs/pictures/projections.jpg
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from panokit.color import srgb_encode_u8
from panokit.io import read_environment_map, write_bytes
from panokit.io.images import encode_jpeg
from panokit.sphere import PROJECTIONS, Equirectangular, Perspective, Projection, reproject

SHOWN: list[tuple[str, Projection]] = [
    ("equirectangular", PROJECTIONS["equirectangular"]),
    ("cubemap-horizontal-cross", PROJECTIONS["cubemap-horizontal-cross"]),
    ("perspective, 90 degrees", Perspective(fov_deg=90)),
    ("anamorphic", PROJECTIONS["anamorphic"]),
    ("mirror-ball", PROJECTIONS["mirror-ball"]),
    ("angular", PROJECTIONS["angular"]),
    ("sky-dome", PROJECTIONS["sky-dome"]),
    ("octahedral", PROJECTIONS["octahedral"]),
]
# A multiple of 3, the height of the cross in faces.
HEIGHT_PX, GAP_PX, LABEL_PX, WHITE = 219, 10, 24, 255
ROWS = ((0, 1, 2), (3, 4, 5, 6, 7))


def cell(name: str, projection: Projection, radiance: np.ndarray) -> np.ndarray:
    width = round(HEIGHT_PX * projection.aspect)
    shown, valid = reproject(
        radiance, Equirectangular(), projection, width, height_px=HEIGHT_PX, interpolation="spline"
    )
    pixels = srgb_encode_u8(np.minimum(shown, 1))
    pixels[~valid] = WHITE
    label = Image.new("RGB", (width, LABEL_PX), (WHITE, WHITE, WHITE))
    font = ImageFont.load_default(15)
    ImageDraw.Draw(label).text((0, 3), name, fill=(40, 40, 40), font=font)
    return np.vstack([np.asarray(label), pixels])


def main() -> None:
    probe, target = map(Path, sys.argv[1:3])
    radiance = read_environment_map(probe).radiance
    exposed = radiance * np.float32(0.35 / np.median(radiance.max(axis=2)))
    rows = []
    for numbers in ROWS:
        gap = np.full((HEIGHT_PX + LABEL_PX, GAP_PX, 3), WHITE, np.uint8)
        cells = [part for n in numbers for part in (cell(*SHOWN[n], exposed), gap)]
        rows.append(np.hstack(cells[:-1]))
    width = max(row.shape[1] for row in rows)
    page = [np.pad(row, ((0, GAP_PX), (0, width - row.shape[1]), (0, 0)), constant_values=WHITE)
            for row in rows]  # fmt: skip
    write_bytes(target, encode_jpeg(np.vstack(page), quality=88))


if __name__ == "__main__":
    main()
