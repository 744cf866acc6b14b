"""Small folders laid out as the published data sets: a gray ball in a light that tells directions.

Light from direction d of the world has the color 0.5 + 0.4 d, so every pixel of a background says
where it looks, and every pixel of a light map which direction it stands for.
"""

import json
from pathlib import Path

import cv2
import numpy as np

from panokit.io import write_exr, write_radiance

RADIUS = 0.5
FOV_DEG = 50.0


def color(direction) -> np.ndarray:
    unit = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    return (0.5 + 0.4 * unit).astype(np.float32)


def look_at(position, target, up=(0.0, 0.0, 1.0)) -> np.ndarray:
    """Columns right, up, back of a camera in a world of any name."""
    back = np.asarray(position, float) - target
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(back, right), back], axis=1)


def photograph(axes, position, center, size):
    """Linear radiance and mask of the ball: (h, w, 3), (h, w). Size is (width, height)."""
    width, height = size
    focal = width / 2 / np.tan(np.radians(FOV_DEG) / 2)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, height / 2 - np.arange(height) - 0.5)
    rays = np.stack([x / focal, y / focal, -np.ones_like(x)], axis=-1) @ axes.T
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    toward = center - position
    along = rays @ toward
    mask = (along > 0) & (toward @ toward - along**2 < RADIUS**2)
    picture = color(rays)
    picture[mask] = 0.2
    return picture, mask


def ring(count, distance=3.0, height=1.0, step_deg=6.0):
    """Positions on a circle about the origin, Z up, going counter-clockwise: to the right."""
    angles = np.radians(step_deg * np.arange(count))
    return [np.array([distance * np.cos(a), distance * np.sin(a), height]) for a in angles]


def write_png(path: Path, picture) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), picture if picture.ndim == 2 else picture[..., ::-1])


def directions_of(width, names):
    """Directions of a lat-long map in a frame where center, left quarter and top are called so."""
    u = (np.arange(width) + 0.5) / width
    v = (np.arange(width // 2) + 0.5) / (width // 2)
    azimuth, height = np.meshgrid((0.5 - u) * 2 * np.pi, (0.5 - v) * np.pi)
    center, left, top = (np.asarray(axis, float)[:, None, None] for axis in names)
    found = center * np.cos(height) * np.cos(azimuth) + left * np.cos(height) * np.sin(azimuth)
    return np.moveaxis(found + top * np.sin(height), 0, -1)


def stanford_orb(root: Path, count=4, hdr=True, **more) -> Path:
    """Two test views and the rest for training; poses as of Blender, Z up."""
    scene = "ball_scene001"
    kind = "blender_HDR" if hdr else "blender_LDR"
    tables = {split: {"camera_angle_x": np.radians(FOV_DEG), "frames": []}
              for split in ("train", "test")}  # fmt: skip
    for number, position in enumerate(ring(count, **more)):
        split = "test" if number < 2 else "train"
        axes = look_at(position, np.zeros(3))
        picture, mask = photograph(axes, position, np.zeros(3), (160, 160))
        folder, name = root / kind / scene, f"{number:04d}"
        if hdr:
            write_exr(folder / split / f"{name}.exr", 3 * picture)
        else:
            from panokit.color import srgb_encode_u8

            write_png(folder / split / f"{name}.png", srgb_encode_u8(picture))
        write_png(folder / f"{split}_mask" / f"{name}.png", mask.astype(np.uint8) * 255)
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = axes, position
        tables[split]["frames"].append(
            {"file_path": f"./{split}/{name}", "transform_matrix": matrix.tolist()}
        )
        if split == "test":
            truth = root / "ground_truth" / scene
            # The center of the map is the camera's forward, its left quarter the camera's left.
            local = directions_of(128, ([0, 0, -1], [-1, 0, 0], [0, 1, 0]))
            write_exr(truth / "env_map" / f"{name}.exr", 3 * color(local @ axes.T))
            normals = np.zeros((80, 80, 3), np.float32)
            normals[mask[::2, ::2]] = [0, 0, 1]
            (truth / "surface_normal").mkdir(parents=True, exist_ok=True)
            np.save(truth / "surface_normal" / f"{name}.npy", normals)
    for split, table in tables.items():
        (root / kind / scene / f"transforms_{split}.json").write_text(json.dumps(table))
    return root


def objects_with_lighting(root: Path, count=3, exposure=-1.0, **more) -> Path:
    """Poses in a leaning world, a light map in a frame of its own, Z up."""
    folder = root / "dataset" / "ball" / "garden"
    inputs = folder / "inputs"
    inputs.mkdir(parents=True)
    turn = cv2.Rodrigues(np.array([0.4, -0.9, 0.3]))[0]  # their world from the one with Z up
    for number, position in enumerate(ring(count, **more)):
        axes = look_at(position, np.zeros(3))
        picture, mask = photograph(axes, position, np.zeros(3), (192, 128))
        write_png(inputs / f"image_{number:04d}.png",
                  np.rint(255 * np.clip(picture * 2.0**exposure, 0, 1) ** (1 / 2.2)).astype(np.uint8))  # fmt: skip  # noqa: E501
        write_png(inputs / f"mask_{number:04d}.png", mask.astype(np.uint8) * 255)
        # Right, down, forward; x = K (R X + t).
        rotation = (turn @ axes * [1, -1, -1]).T
        focal = 96 / np.tan(np.radians(FOV_DEG) / 2)
        rows = [[focal, 0, 96], [0, focal, 64], [0, 0, 1], *rotation.tolist(),
                (-rotation @ turn @ position).tolist(), [192, 128, 3]]  # fmt: skip
        np.savetxt(inputs / f"camera_{number:04d}.txt", np.array(rows))
    (inputs / "exposure.txt").write_text(f"{exposure}\n")
    box = np.array([[-RADIUS, RADIUS]] * 3).ravel()
    (inputs / "object_bounding_box.txt").write_text(" ".join(map(str, box)))
    spin = cv2.Rodrigues(np.array([0, 0, 0.7]))[0]  # the panoramic camera stood upright
    to_env = np.eye(4)
    to_env[:3, :3] = spin @ turn.T
    np.savetxt(folder / "world_to_env.txt", to_env)
    local = directions_of(128, ([1, 0, 0], [0, 1, 0], [0, 0, 1]))
    write_radiance(folder / "env.hdr", color(local @ spin))
    return root
