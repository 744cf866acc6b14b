"""Make the README's picture from the run of `panokit demo`.

python docs/pictures/make_demo.py demo docs/pictures/demo.jpg
"""

import sys
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from panokit.color import luminance, srgb_encode_u8
from panokit.io import read_environment_map, read_panorama, write_bytes
from panokit.io.images import encode_jpeg
from panokit.metrics.balls import diffuse_ball, mirror_ball
from panokit.synthetic import embedded_truth

SHOWN = ("figtree-place-7-002", "lantern-square-7-007", "tallow-lane-7-005")
HEIGHT_PX = 200
GAP_PX = 8
WHITE = 255


def ball_pixels(ball, gain):
    """A ball over white, sRGB-encoded."""
    color = srgb_encode_u8(ball[..., :3] * gain).astype(np.float32)
    alpha = ball[..., 3:]
    return np.rint(color * alpha + WHITE * (1 - alpha)).astype(np.uint8)


def row(run, name):
    """A panorama, then diffuse and mirror balls by our map and by the truth."""
    key = f"panoramax-{name}"
    pixels = read_panorama(run / "filled" / f"{key}.jpg").pixels
    panorama = cv2.resize(pixels, (2 * HEIGHT_PX, HEIGHT_PX), interpolation=cv2.INTER_AREA)
    parts = [panorama]
    maps = [
        read_environment_map(run / "probes" / f"{key}.exr").radiance,
        read_environment_map(embedded_truth() / f"{name}.exr").radiance,
    ]
    # One exposure for all balls of a row: the truth's diffuse ball is mid gray to light.
    lit = diffuse_ball(maps[1], HEIGHT_PX)
    gain = np.float32(0.6 / np.percentile(luminance(lit[lit[..., 3] > 0.5][:, :3]), 90))
    for radiance in maps:
        parts.append(ball_pixels(diffuse_ball(radiance, HEIGHT_PX), gain))
        parts.append(ball_pixels(mirror_ball(radiance, HEIGHT_PX), gain))
    gap = np.full((HEIGHT_PX, GAP_PX, 3), WHITE, np.uint8)
    return np.hstack([piece for part in parts for piece in (part, gap)][:-1])


def heading(width_px):
    """What stands in each column, as a strip of text."""
    strip = Image.new("RGB", (width_px, 26), (WHITE, WHITE, WHITE))
    draw = ImageDraw.Draw(strip)
    column = HEIGHT_PX + GAP_PX
    texts = ("street panorama", "lit by panokit's map", "lit by the true light")
    for text, x in zip(
        texts, (0, 2 * HEIGHT_PX + GAP_PX, 2 * HEIGHT_PX + GAP_PX + 2 * column), strict=True
    ):
        draw.text((x + 4, 2), text, fill=(60, 60, 60), font=ImageFont.load_default(size=17))
    return np.asarray(strip)


def main(run, out):
    rows = [row(Path(run), name) for name in SHOWN]
    gap = np.full((GAP_PX, rows[0].shape[1], 3), WHITE, np.uint8)
    pieces = [piece for one in rows for piece in (one, gap)][:-1]
    picture = np.vstack([heading(rows[0].shape[1]), *pieces])
    write_bytes(Path(out), encode_jpeg(picture, quality=88))


if __name__ == "__main__":
    main(*sys.argv[1:])
