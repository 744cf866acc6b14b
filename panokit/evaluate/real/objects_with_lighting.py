"""Objects with Lighting (Ummenhofer et al. 2024): photographs, poses, a light map of each place.

    ROOT/<object>/<place>/inputs/image_%04d.png    8 bits, y = 255 (x 2^exposure)^(1/2.2)
    ROOT/<object>/<place>/inputs/camera_%04d.txt   K, R, t, size: x = K (R X + t), rows down
    ROOT/<object>/<place>/inputs/mask_%04d.png     about where the object is
    ROOT/<object>/<place>/inputs/exposure.txt
    ROOT/<object>/<place>/inputs/object_bounding_box.txt
    ROOT/<object>/<place>/env.hdr                  the light, in a frame of its own
    ROOT/<object>/<place>/world_to_env.txt         the rotation to that frame

Cameras look along +Z with +Y down. A light map has +X at its center, +Y at a quarter from the
left, +Z on top: Blender's frame. Map and photographs have one scale but for the exposure.
`env.hdr` is given for looking at only, as the data set's own benchmark is about other light; here
it is the truth.
"""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, RecordError, UsageError
from panokit.evaluate.real.scenes import (
    MeasuredLight,
    Picture,
    RealScene,
    RealView,
    nearest_rotation,
)
from panokit.frames import TOOL_FROM_PANOKIT, Rotation
from panokit.io import decode_image, read_radiance
from panokit.io.files import read_bytes
from panokit.io.pictures import read_mask

# Between their camera (right, down, forward) and panokit's (right, up, back); its own inverse.
_FLIP = Rotation(np.diag([1.0, -1.0, -1.0]))
_GAMMA = 2.2


def scenes_of(root: Path) -> Iterator[RealScene]:
    """The scenes in a folder, by name; those without a light map are left out.

    Raises:
        UsageError: If the folder is laid out otherwise.
    """
    root = root / "dataset" if (root / "dataset").is_dir() else root
    folders = sorted(path.parent for path in root.glob("*/*/env.hdr"))
    if not folders:
        raise UsageError(
            f"{root} is not laid out as Objects with Lighting: there is no "
            "<object>/<place>/env.hdr. Unpack the archives of the data set into one folder."
        )
    for folder in folders:
        if any((folder / "inputs").glob("camera_*.txt")):
            yield _scene(folder)


def _scene(folder: Path) -> RealScene:
    inputs = folder / "inputs"
    env_from_world = nearest_rotation(_numbers(folder / "world_to_env.txt", (4, 4))[:3, :3])
    # Their map's frame, by panokit's names of directions; there up is up, which it is not in the
    # world of their poses. So it is the world here.
    upright = TOOL_FROM_PANOKIT["blender"].inverse @ env_from_world
    exposure = float(_numbers(inputs / "exposure.txt", (1,))[0])
    box = _numbers(inputs / "object_bounding_box.txt", (6,))
    cameras = sorted(inputs.glob("camera_*.txt"))
    center = np.array([box[0] + box[1], box[2] + box[3], box[4] + box[5]]) / 2
    views = [_view(inputs, path, upright) for path in cameras]
    return RealScene(
        object=folder.parent.name,
        place=folder.name,
        views=tuple(view for view in views if view is not None),
        center=np.asarray(upright.apply(center), np.float64),
        lights=(
            MeasuredLight(
                name="env",
                world_from_map=Rotation.identity(),
                read=partial(_read_map, folder / "env.hdr", exposure),
            ),
        ),
        metered=False,
        scale_known=True,
    )


def _view(inputs: Path, path: Path, upright_from_world: Rotation) -> RealView | None:
    number = path.stem.partition("_")[2]
    picture, mask = inputs / f"image_{number}.png", inputs / f"mask_{number}.png"
    if not picture.is_file() or not mask.is_file():
        return None
    values = _numbers(path, (8, 3))
    # R leads from the world to the camera.
    world_from_camera = nearest_rotation(values[3:6]).inverse
    position = -world_from_camera.apply(values[6])
    return RealView(
        name=number,
        intrinsics=values[:3],
        width_px=int(values[7, 0]),
        height_px=int(values[7, 1]),
        world_from_camera=upright_from_world @ world_from_camera @ _FLIP,
        position=np.asarray(upright_from_world.apply(position), np.float64),
        read=partial(_read_view, picture, mask),
    )


def _read_view(path: Path, mask: Path) -> tuple[Picture, Picture]:
    """Linear light on the scale of the picture, 1.0 its white; coverage."""
    pixels = decode_image(read_bytes(path), what=str(path))
    coverage = read_mask(mask).astype(np.float32)
    if coverage.shape != pixels.shape[:2]:
        raise ImageError(
            f"{mask} is {coverage.shape[::-1]}, its picture {pixels.shape[1::-1]}.",
            reason="wrong-shape",
        )
    return np.asarray((pixels / np.float32(255)) ** np.float32(_GAMMA), np.float32), coverage


def _read_map(path: Path, exposure: float) -> Picture:
    return np.asarray(read_radiance(path) * np.float32(2.0**exposure), np.float32)


def _numbers(path: Path, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """The numbers in a text file.

    Raises:
        RecordError: If there are others than expected.
    """
    try:
        values = np.array(path.read_text(encoding="utf-8").split(), np.float64)
        return values.reshape(shape)
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise RecordError(
            f"{path} does not hold {shape} numbers ({error}). Unpack the archive again.",
            reason="damaged-record",
        ) from error
