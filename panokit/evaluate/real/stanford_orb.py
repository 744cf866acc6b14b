"""Stanford-ORB (Kuang et al. 2023): objects in real places, HDR, with light maps.

    ROOT/blender_HDR/<object>_scene00x/{train,test}/%04d.exr       (or blender_LDR, .png)
    ROOT/blender_HDR/<object>_scene00x/{train,test}_mask/%04d.png
    ROOT/blender_HDR/<object>_scene00x/transforms_{train,test}.json
    ROOT/ground_truth/<object>_scene00x/env_map/%04d.exr            (of test images)
    ROOT/ground_truth/<object>_scene00x/surface_normal/%04d.npy     (of test images)

Poses are those of Blender: the world's +Z is up, cameras have +X right, +Y up and look along -Z.
Light maps and normals are in the frame of the camera of the test image whose name they have, the
maps' center along its -Z: panokit's convention. The scale between maps and photographs is not
published.
"""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from panokit.color import srgb_decode_u8
from panokit.errors import ImageError, RecordError, UsageError
from panokit.evaluate.real.scenes import (
    MeasuredLight,
    Picture,
    RealScene,
    RealView,
    look_together_at,
    nearest_rotation,
)
from panokit.io import decode_image, read_exr, read_json
from panokit.io.exr_header import read_exr_parts
from panokit.io.files import read_bytes
from panokit.io.pictures import read_mask

_WORLD_FROM_BLENDER = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
_SPLITS = ("test", "train")


def scenes_of(root: Path) -> Iterator[RealScene]:
    """The scenes in a folder, by name; those without light maps are left out.

    Raises:
        UsageError: If the folder is laid out otherwise.
    """
    pictures = next((root / n for n in ("blender_HDR", "blender_LDR") if (root / n).is_dir()), None)
    truth = root / "ground_truth"
    if pictures is None or not truth.is_dir():
        raise UsageError(
            f"{root} is not laid out as Stanford-ORB: it needs blender_HDR (or blender_LDR) and "
            "ground_truth. Unpack both archives of the data set into one folder."
        )
    found = False
    for folder in sorted(path for path in pictures.iterdir() if path.is_dir()):
        if any((truth / folder.name / "env_map").glob("*.exr")):
            found = True
            yield _scene(folder, truth / folder.name)
    if not found:
        raise UsageError(
            f"{root} has no scene with light maps in ground_truth/<scene>/env_map. Unpack the "
            "archive of the ground truth."
        )


def _scene(folder: Path, truth: Path) -> RealScene:
    views = [view for split in _SPLITS for view in _views(folder, split, truth)]
    lights = tuple(
        MeasuredLight(
            name=view.name.rpartition("/")[2],
            world_from_map=view.world_from_camera,
            read=partial(_read_map, path),
        )
        for view in views
        if view.name.startswith("test/")
        and (path := truth / "env_map" / f"{view.name.rpartition('/')[2]}.exr").is_file()
    )
    if not lights:
        raise RecordError(
            f"The light maps of {truth} are of no test image of {folder}.", reason="no-light"
        )
    thing, _, place = folder.name.rpartition("_")
    return RealScene(
        object=thing or folder.name,
        place=place,
        views=tuple(views),
        center=look_together_at(views),
        lights=lights,
        metered=folder.parent.name.endswith("HDR"),
        scale_known=False,
    )


def _views(folder: Path, split: str, truth: Path) -> Iterator[RealView]:
    path = folder / f"transforms_{split}.json"
    if not path.is_file():
        return
    table = read_json(path)
    try:
        for frame in table["frames"]:
            name = Path(frame["file_path"]).name.partition(".")[0]
            picture = _picture_path(folder / split, name)
            if picture is None:
                continue
            angle = float(frame.get("camera_angle_x", table.get("camera_angle_x")))
            yield _view(folder, split, name, picture, angle, frame["transform_matrix"], truth)
    except (KeyError, TypeError, ValueError) as error:
        raise RecordError(
            f"{path} is not a table of poses as Stanford-ORB has them ({error!r}). Unpack the "
            "archive again.",
            reason="damaged-record",
        ) from error


def _view(
    folder: Path, split: str, name: str, picture: Path, angle: float, matrix: Any, truth: Path
) -> RealView:
    width, height = _size(picture)
    pose = np.array(matrix, np.float64)
    focal = width / 2 / np.tan(angle / 2)
    normals = truth / "surface_normal" / f"{name}.npy"
    return RealView(
        name=f"{split}/{name}",
        intrinsics=np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]]),
        width_px=width,
        height_px=height,
        world_from_camera=nearest_rotation(_WORLD_FROM_BLENDER @ pose[:3, :3]),
        position=_WORLD_FROM_BLENDER @ pose[:3, 3],
        read=partial(_read_view, picture, folder / f"{split}_mask" / f"{name}.png"),
        read_normals=partial(_read_normals, normals)
        if split == "test" and normals.is_file()
        else None,
    )


def _picture_path(folder: Path, name: str) -> Path | None:
    paths = (folder / f"{name}{suffix}" for suffix in (".exr", ".png"))
    return next((path for path in paths if path.is_file()), None)


def _size(path: Path) -> tuple[int, int]:
    if path.suffix == ".exr":
        window = read_exr_parts(path)[0].data_window
        return window.width_px, window.height_px
    height, width = decode_image(read_bytes(path), what=str(path)).shape[:2]
    return width, height


def _read_view(path: Path, mask: Path) -> tuple[Picture, Picture]:
    if path.suffix == ".exr":
        radiance = read_exr(path)[0]
    else:
        radiance = srgb_decode_u8(decode_image(read_bytes(path), what=str(path))).astype(np.float32)
    coverage = read_mask(mask).astype(np.float32)
    if coverage.shape != radiance.shape[:2]:
        raise ImageError(
            f"{mask} is {coverage.shape[::-1]}, its picture {radiance.shape[1::-1]}.",
            reason="wrong-shape",
        )
    return np.asarray(np.maximum(radiance, 0), np.float32), coverage


def _read_map(path: Path) -> Picture:
    return read_exr(path, repair=True)[0]


def _read_normals(path: Path) -> Picture:
    try:
        normals = np.asarray(np.load(path), np.float32)
    except (OSError, ValueError) as error:
        raise ImageError(f"{path} holds no normals ({error}).", reason="not-an-image") from error
    if normals.ndim != 3 or normals.shape[2] != 3:
        raise ImageError(f"{path} is {normals.shape}, not (H, W, 3).", reason="wrong-shape")
    return np.nan_to_num(normals)
