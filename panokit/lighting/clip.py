"""The clip that comes with panokit: a camera moves sideways past a teapot in a sunny square.

Made by panokit's own renderer, see `tests/lighting/make_clip.py`. What the light in it really is,
is kept with the tests, for the judge alone.
"""

from pathlib import Path

from panokit.lighting.pair import Click

# A pixel of the teapot, and a frame in which it is whole.
CLIP_CLICK = Click(column=400, row=180, frame=6)
CLIP_FOV_DEG = 60.0


def clip_path() -> Path:
    """The video file, 640x360, mp4v."""
    return Path(__file__).parent / "clip" / "square.mp4"
