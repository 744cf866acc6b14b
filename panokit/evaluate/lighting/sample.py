"""A stereo sample as an evaluator sees it: what was seen, and apart from that the truth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.storage.read import StereoDataset
from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.stereo import Views

MEMBERS = (
    "left.png", "right.png", "left_object.png", "right_object.png", "left_mask.png",
    "background.png", "left_normal.exr", "env64.exr", "meta.json",
)  # fmt: skip
# What not every dataset has.
_MORE = ("left_material.png", "reflectance.exr", "reflectance_1.exr")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StereoSample:
    """One sample with its truth.

    Attributes:
        key: Of the sample.
        views: What a predictor may look at.
        truth: (64, 64, 3) float32 linear radiance, anamorphic, in the left camera's frame; 1.0
            is the white of the pictures.
        meta: What the dataset says of the sample.
        reflectance: (64, 64, 3) float32, the dense reflectance map of the object's first
            material, on the grid of `panokit.reflectance.hemisphere_normals`; None if the
            dataset has none.
    """

    key: str
    views: Views
    truth: NDArray[np.float32]
    meta: dict[str, Any]
    reflectance: NDArray[np.float32] | None = None


def read_sample(dataset: StereoDataset, number: int) -> StereoSample:
    """A sample of a dataset that was opened with `MEMBERS`."""
    there = dataset.names(number)
    more = {
        name.rpartition(".")[0]: dataset.decoded(number, name) for name in _MORE if name in there
    }
    return sample_of(dataset[number] | more)


def sample_of(files: Mapping[str, Any]) -> StereoSample:
    """A sample from its decoded members, as `StereoDataset` gives them."""
    meta = files["meta"]
    camera = meta["views"]["left"]
    world_from_camera = Rotation(np.array(camera["world_from_camera"]))
    mask = files["left_mask"] >= 128
    numbers = np.maximum(files.get("left_material", np.uint8(1)), 1)
    return StereoSample(
        key=files["key"],
        views=Views(
            left=files["left"],
            right=files["right"],
            left_object=files["left_object"],
            right_object=files["right_object"],
            mask=mask,
            background=files["background"],
            normals=files["left_normal"],
            parts=np.asarray(mask * numbers, np.uint8),
            fov_deg=camera["fov_deg"],
            baseline_m=meta["baseline_m"],
            left_level=level_from_camera(world_from_camera),
        ),
        truth=files["env64"],
        meta=meta,
        reflectance=files.get("reflectance", files.get("reflectance_1")),
    )


def level_from_camera(world_from_camera: Rotation) -> Rotation:
    """From a camera's frame to a level one that looks the same way: its pitch and roll alone."""
    heading = world_from_camera.heading_pitch_roll()[0]
    return Rotation.from_heading_pitch_roll(heading).inverse @ world_from_camera


def open_samples(folder: Path, split: str = "test") -> StereoDataset:
    """The split of a dataset with everything that `read_sample` needs."""
    return StereoDataset(folder, split, members=MEMBERS)


class Samples(Sequence[StereoSample]):
    """The first samples of a split, each read when it is asked for.

    Args:
        folder: Of the dataset.
        split: "train", "validation" or "test".
        count: At most so many; all if 0.
    """

    def __init__(self, folder: Path, split: str = "test", count: int = 0) -> None:
        self._dataset = open_samples(folder, split)
        there = len(self._dataset)
        self.keys = [str(key) for key in self._dataset.keys[: min(count, there) or there]]
        if not self.keys:
            raise UsageError(f"{folder} has no samples of the split {split!r}. Choose another.")

    def __len__(self) -> int:
        return len(self.keys)

    @overload
    def __getitem__(self, number: int) -> StereoSample: ...

    @overload
    def __getitem__(self, number: slice) -> list[StereoSample]: ...

    def __getitem__(self, number: int | slice) -> StereoSample | list[StereoSample]:
        if isinstance(number, slice):
            return [self[one] for one in range(len(self))[number]]
        return read_sample(self._dataset, range(len(self))[number])
