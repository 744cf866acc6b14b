"""Small videos made here: a shaded ball before a patterned wall, and a camera that moves."""

from pathlib import Path

import cv2
import numpy as np

SIZE = (320, 180)
RADIUS = 32
COLOR = np.array([200, 70, 40], float)


def wall(seed: int = 0) -> np.ndarray:
    """(180, 640, 3), blotches of gray and blue."""
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(70, 170, (12, 40, 1)) * np.array([0.9, 1.0, 1.1])
    return np.clip(cv2.resize(coarse, (640, 180), interpolation=cv2.INTER_CUBIC), 0, 255)


def frame(
    x: float = 160, y: float = 90, radius: float = RADIUS, *, slide: float = 0.0, gain: float = 1.0
) -> np.ndarray:
    """One frame with the ball at (x, y), lit from the upper left; the wall is moved by `slide`."""
    shift = np.array([[1, 0, slide - 160], [0, 1, 0]], float)
    picture = cv2.warpAffine(wall(), shift, SIZE, borderMode=cv2.BORDER_REFLECT)
    column, row = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    across, down = (column - x) / radius, (row - y) / radius
    inside = across**2 + down**2 < 1
    deep = np.sqrt(np.clip(1 - across**2 - down**2, 0, 1))
    shade = np.clip(-0.5 * across - 0.5 * down + 0.7 * deep, 0, None) * 0.75 + 0.3
    ball = COLOR * np.minimum(shade, 1.2)[..., None]
    whole = np.where(inside[..., None], ball, picture) * gain
    return np.clip(np.rint(whole), 0, 255).astype(np.uint8)


def sideways(count: int = 24, speed: float = 2.0, **more) -> list[np.ndarray]:
    """The camera moves to the right: the ball goes left, the wall hardly at all."""
    return [frame(200 - speed * k, slide=-0.1 * speed * k, **more) for k in range(count)]


def write_video(path: Path, frames: list[np.ndarray], codec: str = "mp4v") -> Path:
    size = (frames[0].shape[1], frames[0].shape[0])
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*codec), 25, size)
    assert writer.isOpened()
    for one in frames:
        writer.write(np.ascontiguousarray(one[..., ::-1]))
    writer.release()
    return path


def write_folder(folder: Path, frames: list[np.ndarray]) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for number, one in enumerate(frames):
        cv2.imwrite(str(folder / f"frame{number}.png"), one[..., ::-1])
    return folder
