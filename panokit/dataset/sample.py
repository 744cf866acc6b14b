"""A sample: what is drawn for it from its number, and what is written of it.

Everything random about sample i comes from the dataset's seed and i, so any sample can be
made again alone. A `SamplePlan` holds what was drawn; a `Sample` holds the finished files.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from panokit.dataset.scene import Material, View

SPLITS = ("train", "validation", "test")
SCHEMA = "panokit.sample/1"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SamplePlan:
    """What was drawn for one sample.

    Attributes:
        index: Its number, from 0.
        attempt: 0, or how many plans before it were rejected.
        split: One of `SPLITS`; its place and its object belong to this split only.
        object_id: Of the catalog of objects.
        probe_id: Of the source of light.
        materials: What the object is made of.
        material_of_part: For each part of the object, the number of its material.
        yaw_deg: By which the map is turned about the vertical, clockwise from above.
        tilt_deg: By which it is then tilted.
        tilt_toward_deg: The azimuth toward which its zenith is tilted.
        exposure_stops: Exposure relative to what metering chooses.
        on_floor: Whether the object stands on a floor.
        object_turn_deg: By which the object is turned about the vertical.
        baseline_m: Between the cameras.
        fill: The share of the picture that the object is to span.
        pitch_deg: Of the cameras, positive looking up.
        roll_deg: Of the cameras, positive leaning to their right.
        render_seed: For the renderer.
    """

    index: int
    attempt: int
    split: str
    object_id: str
    probe_id: str
    materials: tuple[Material, ...]
    material_of_part: tuple[int, ...]
    yaw_deg: float
    tilt_deg: float
    tilt_toward_deg: float
    exposure_stops: float
    on_floor: bool
    object_turn_deg: float
    baseline_m: float
    fill: float
    pitch_deg: float
    roll_deg: float
    render_seed: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sample:
    """One finished sample.

    Attributes:
        key: Its name in the shards: the index with nine digits.
        split: One of `SPLITS`.
        members: File name without the key ("left.png", "env64.exr", "meta.json") -> bytes, in
            the order in which they are written.
        meta: What meta.json says.
        views: The two cameras.
        figures: What the checks on a sample look at: "mask_share", "over_share", ...
    """

    key: str
    split: str
    members: Mapping[str, bytes]
    meta: Mapping[str, Any]
    views: tuple[View, ...]
    figures: Mapping[str, float] = field(default_factory=dict)


def sample_key(index: int) -> str:
    """The name of sample `index` in shards and tables."""
    return f"{index:09d}"
