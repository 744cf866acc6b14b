"""Make the picture of docs/ideas/relighting.md from CC0 light probes of Poly Haven.

python docs/pictures/make_relighting.py PROBE_FOLDER docs/pictures/relighting.jpg
"""

import sys
from pathlib import Path

import cv2
import numpy as np

from panokit.color import luminance, srgb_encode_u8
from panokit.io import read_environment_map, write_bytes
from panokit.io.images import encode_jpeg
from panokit.metrics.transport import relight

SHOWN = (
    "kloofendal_43d_clear_puresky",
    "kloofendal_overcast",
    "blaubeuren_night",
    "aerodynamics_workshop",
    "studio_small_03",
)
SCENES = ("diffuse", "glossy-0.6", "glossy-0.3", "glossy-0.1", "mirror")
SIDE_PX = 128
GAP_PX = 6
WHITE = 255


def encoded(picture, gain):
    """A relit picture over white, sRGB-encoded."""
    alpha = picture[..., 3:]
    color = srgb_encode_u8(picture[..., :3] * gain).astype(np.float32)
    return np.rint(color * alpha + WHITE * (1 - alpha)).astype(np.uint8)


def row(radiance):
    """The map and every scene under it, all of one exposure but the map's own."""
    floor = relight(radiance, "plane")
    gain = np.float32(0.5 / np.percentile(luminance(floor[..., :3]), 90))
    size = (2 * SIDE_PX, SIDE_PX)
    small = cv2.resize(radiance, size, interpolation=cv2.INTER_AREA)
    shown = srgb_encode_u8(small * np.float32(0.5 / np.percentile(luminance(small), 80)))
    scaled = cv2.resize(encoded(floor, gain), (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_CUBIC)
    balls = [encoded(relight(radiance, scene, SIDE_PX), gain) for scene in SCENES]
    gap = np.full((SIDE_PX, GAP_PX, 3), WHITE, np.uint8)
    return np.hstack([piece for part in (shown, scaled, *balls) for piece in (part, gap)][:-1])


def main(folder, output):
    rows = []
    for name in SHOWN:
        part = row(read_environment_map(folder / f"{name}_1k.hdr").radiance)
        rows += [part, np.full((GAP_PX, part.shape[1], 3), WHITE, np.uint8)]
    write_bytes(output, encode_jpeg(np.vstack(rows[:-1]), quality=90))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
