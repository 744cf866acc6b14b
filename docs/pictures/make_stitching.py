"""docs/pictures/stitching.jpg: 22 uneven views before and after, from a real panorama.

    PANOKIT_DATA=... python docs/pictures/make_stitching.py

The panorama is by Matthew Petroff (pannellum.org), CC BY-SA 4.0, and so is the result.
"""

import os
import sys
from pathlib import Path

import cv2
import numpy as np

from panokit.io import decode_image
from panokit.stitch import StitchSettings, stitch_views

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent.parent / "tests" / "benchmarks" / "peers"))

from compare_stitching import layout, shaken, shoot  # noqa: E402 - the benchmark's own views


def main():
    path = Path(os.environ["PANOKIT_DATA"]) / "panoramas" / "pannellum_bma-0.jpg"
    panorama = decode_image(path.read_bytes(), what=path.name)
    views = layout()
    pictures = shoot(panorama, views, 0.15, 0.15)
    noisy = shaken(views)
    left = StitchSettings(exposure=False, refine="none")
    before = stitch_views(pictures, noisy, 2048, left).pixels
    after = stitch_views(pictures, noisy, 2048).pixels
    rows = []
    for made in (before, after):
        whole = cv2.resize(made, (720, 360), interpolation=cv2.INTER_AREA)
        detail = made[730:890, 470:630]
        rows.append(np.hstack([whole, cv2.resize(detail, (360, 360))]))
    picture = np.vstack([rows[0], np.full((6, 1080, 3), 255, np.uint8), rows[1]])
    cv2.imwrite(str(HERE / "stitching.jpg"), picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 78])


if __name__ == "__main__":
    main()
