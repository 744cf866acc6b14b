"""Make the pictures of docs/commands/inpaint.md: the ground before and after.

python docs/pictures/make_inpaint.py PANORAMAS DEMO_RUN docs/pictures

PANORAMAS holds panoramas by Matthew Petroff (pannellum.org, CC BY-SA 4.0), DEMO_RUN what
`panokit demo --out DEMO_RUN` left.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

from panokit.inpaint import InpaintSettings, inpaint
from panokit.inpaint.face import face_around, paste
from panokit.io import read_panorama, write_bytes
from panokit.io.images import encode_jpeg

PX, GAP = 300, 6
DOWN = np.array([0.0, -1.0, 0.0])
# Limbs seen from above, in tangents of the angle from the point below the camera: right, down.
PLAQUE = (
    [(-0.45, -0.21), (-0.3, -0.22), (-0.2, -0.17), (-0.1, -0.05), (0, -0.03)],
    [(0, 0), (0.1, -0.05), (0.2, -0.07), (0.3, -0.13), (0.41, -0.17)],
    [(0, 0), (0.02, 0.07), (0.04, 0.16)],
)
LOBBY = (
    [(-0.11, -0.36), (-0.15, -0.4), (-0.2, -0.38), (-0.23, -0.25), (-0.2, -0.16), (-0.13, 0)],
    [(0.2, 0.0), (0.04, 0), (-0.05, 0.01), (-0.1, 0.05), (-0.2, 0.09), (-0.3, 0.1), (-0.34, 0.16),
     (-0.33, 0.23), (-0.25, 0.28), (-0.15, 0.33)],
    [(0.19, 0.09), (0.25, 0.05), (0.38, 0.02)],
    [(-0.12, -0.17), (-0.1, -0.1), (-0.05, -0.04)],
)  # fmt: skip
KNEE = ([(1.0, -1.05), (1.12, -0.85), (1.12, -0.64)],)


def mask_of(panorama, limbs, radius):
    """Limbs of a tripod as a mask of the panorama."""
    face = face_around(DOWN, np.deg2rad(32), panorama.width_px)
    drawn = np.zeros((face.size_px, face.size_px), np.uint8)
    for limb in limbs:
        points = np.rint(np.array(limb) * face.px_per_radian + face.size_px / 2).astype(np.int32)
        cv2.polylines(drawn, [points], False, 255, round(2 * radius * face.px_per_radian))
    marked = np.zeros((panorama.height_px, panorama.width_px, 3), np.uint8)
    white = np.full((face.size_px, face.size_px, 3), 255, np.float32)
    paste(
        marked, face, white, (drawn > 0).astype(np.float32), np.zeros(marked.shape[:2], bool),
        slice(0, panorama.height_px),
    )  # fmt: skip
    return marked[..., 0] > 127


def pair(panorama, radius_deg, mask=None, settings=None):
    """The ground before and after, one above the other."""
    filled = inpaint(panorama, settings or InpaintSettings(), mask)
    print(panorama.capture.id, filled.provenance.steps[-1].values["fillings"])
    face = face_around(DOWN, np.deg2rad(radius_deg), panorama.width_px, reach=1.0)
    views = face.views(panorama.pixels, filled.pixels)
    small = [cv2.resize(view, (PX, PX), interpolation=cv2.INTER_AREA) for view in views]
    return np.vstack([small[0], np.full((GAP, PX, 3), 255, np.uint8), small[1]])


def side_by_side(columns):
    gap = np.full((len(columns[0]), GAP, 3), 255, np.uint8)
    return np.hstack([part for column in columns for part in (column, gap)][:-1])


def main(panoramas, run, out):
    def real(name):
        return read_panorama(Path(panoramas) / f"pannellum_{name}.jpg")

    def city(name):
        return read_panorama(Path(run) / "panoramas" / f"panoramax-{name}.jpg")

    lobby, plaque, rock = real("jfk"), real("bma-0"), real("lascar")
    tripods = [
        pair(lobby, 32, mask_of(lobby, LOBBY, 0.052)),
        pair(rock, 54, mask_of(rock, KNEE, 0.24)),
        pair(city("candle-steps-7-000"), 30),
        pair(city("meridian-boulevard-7-006"), 36),
    ]
    write_bytes(Path(out) / "inpaint.jpg", encode_jpeg(side_by_side(tripods), quality=86))
    known = [
        pair(real("alma"), 40, settings=InpaintSettings(nadir_deg=30)),
        pair(real("lascar"), 40, settings=InpaintSettings(nadir_deg=30)),
        pair(real("from-tree"), 40, settings=InpaintSettings(nadir_deg=30)),
        pair(plaque, 32, mask_of(plaque, PLAQUE, 0.056)),
    ]
    write_bytes(Path(out) / "inpaint-truth.jpg", encode_jpeg(side_by_side(known), quality=86))


if __name__ == "__main__":
    main(*sys.argv[1:])
