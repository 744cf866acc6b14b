"""A stereo sample as an evaluator sees it: what was seen, and apart from that the truth."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.storage.read import StereoDataset
from panokit.frames import Rotation

MEMBERS = (
    "left.png", "right.png", "left_object.png", "right_object.png", "left_mask.png",
    "background.png", "left_normal.exr", "env64.exr", "meta.json",
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Views:
    """What a predictor may look at.

    Attributes:
        left: (H, W, 3) uint8, display-encoded: the object on its background.
        right: The other view.
        left_object: (H, W, 3) uint8, the object on black.
        right_object: The other view.
        mask: (H, W) bool, the object in the left view.
        background: (H, W, 3) uint8, what is behind the object in the left view.
        normals: (H, W, 3) float32 in the left camera's frame. True normals: only methods that
            are said to know them may use them.
        fov_deg: From the left to the right edge.
        baseline_m: Between the cameras.
        left_level: Turns directions of the left camera's frame into a level frame that looks the
            same way; what a phone's sense of gravity tells.
    """

    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    left_object: NDArray[np.uint8]
    right_object: NDArray[np.uint8]
    mask: NDArray[np.bool_]
    background: NDArray[np.uint8]
    normals: NDArray[np.float32]
    fov_deg: float
    baseline_m: float
    left_level: Rotation

    @property
    def focal_px(self) -> float:
        """The focal length in pixels."""
        return float(self.mask.shape[1] / 2 / np.tan(np.deg2rad(self.fov_deg) / 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StereoSample:
    """One sample with its truth.

    Attributes:
        key: Of the sample.
        views: What a predictor may look at.
        truth: (64, 64, 3) float32 linear radiance, anamorphic, in the left camera's frame; 1.0
            is the white of the pictures.
        meta: What the dataset says of the sample.
    """

    key: str
    views: Views
    truth: NDArray[np.float32]
    meta: dict[str, Any]


def read_sample(dataset: StereoDataset, number: int) -> StereoSample:
    """A sample of a dataset that was opened with `MEMBERS`."""
    return sample_of(dataset[number])


def sample_of(files: Mapping[str, Any]) -> StereoSample:
    """A sample from its decoded members, as `StereoDataset` gives them."""
    meta = files["meta"]
    camera = meta["views"]["left"]
    world_from_camera = Rotation(np.array(camera["world_from_camera"]))
    heading = world_from_camera.heading_pitch_roll()[0]
    return StereoSample(
        key=files["key"],
        views=Views(
            left=files["left"],
            right=files["right"],
            left_object=files["left_object"],
            right_object=files["right_object"],
            mask=files["left_mask"] >= 128,
            background=files["background"],
            normals=files["left_normal"],
            fov_deg=camera["fov_deg"],
            baseline_m=meta["baseline_m"],
            left_level=Rotation.from_heading_pitch_roll(heading).inverse @ world_from_camera,
        ),
        truth=files["env64"],
        meta=meta,
    )


def open_samples(folder: Path, split: str = "test") -> StereoDataset:
    """The split of a dataset with everything that `read_sample` needs."""
    return StereoDataset(folder, split, members=MEMBERS)


def iterate_samples(folder: Path, split: str = "test", count: int = 0) -> Iterator[StereoSample]:
    """The samples of a split, in order; the first `count` of them if that is not 0."""
    dataset = open_samples(folder, split)
    for number in range(min(count, len(dataset)) if count else len(dataset)):
        yield read_sample(dataset, number)
