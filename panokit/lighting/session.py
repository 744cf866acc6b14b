"""The whole way: a video and clicks in, the light of the scene out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.io import encode_png, write_bytes, write_json
from panokit.lighting.estimate import LightEstimate
from panokit.lighting.fuse import fuse_estimates
from panokit.lighting.model import LightingModel
from panokit.lighting.outputs import write_outputs
from panokit.lighting.pair import Click, FoundPair, find_pair
from panokit.lighting.settings import OutputSettings, SessionSettings
from panokit.lighting.snapshots import StereoPair
from panokit.lighting.track import TrackedFrame
from panokit.lighting.video import Frames

SCHEMA = "panokit.light-session/1"
RECORD = "session.json"
VIEWS = "views"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SessionResult:
    """The light that was read.

    Attributes:
        estimate: Of all clicks together, in the frame of the video's camera.
        each: Of each click, in the frame of its own view.
        found: The views of each click, and where its object went.
    """

    estimate: LightEstimate
    each: tuple[LightEstimate, ...]
    found: tuple[FoundPair, ...]


def light_from_video(
    frames: Frames,
    clicks: Sequence[Click],
    settings: SessionSettings | None = None,
    *,
    model: LightingModel | None = None,
    on_frame: Callable[[TrackedFrame], None] | None = None,
) -> SessionResult:
    """The light of a scene from clicks on one or several objects in a video.

    Args:
        frames: Of a camera that moves sideways and does not turn.
        clicks: At least one.
        settings: How.
        model: If it is loaded already; else the one that the settings name.
        on_frame: Called with where the object is, frame by frame.

    Raises:
        UsageError: If there is no click, or one is beside its frame.
        ImageError: If a click is on the background.
        ItemError: If an object never moves far enough sideways.
        ModelError: If there is no such model.
    """
    settings = settings or SessionSettings()
    if not clicks:
        raise UsageError("There is no click. Say where the object is: --click X,Y")
    model = model or LightingModel(settings.model, settings.estimate)
    found = tuple(find_pair(frames, click, settings, on_frame=on_frame) for click in clicks)
    each, estimate = read_light([one.pair for one in found], model, settings)
    more = tuple(text for one in found for text in one.track.warnings)
    estimate = replace(estimate, warnings=(*more, *estimate.warnings))
    return SessionResult(estimate=estimate, each=each, found=found)


def read_light(
    pairs: Sequence[StereoPair], model: LightingModel, settings: SessionSettings | None = None
) -> tuple[tuple[LightEstimate, ...], LightEstimate]:
    """The light of each of several pairs of one video, and of all together.

    Each is read in the frame of its own view, turned into that of the video's camera, and counts
    as much as it is sure.

    Returns:
        Those of each pair, in the frames of their views, and the one in the camera's frame.
    """
    settings = settings or SessionSettings()
    each = []
    for pair in pairs:
        one = model.estimate(pair.views)
        told = tuple(dict.fromkeys((*pair.warnings, *one.warnings)))
        each.append(replace(one, warnings=told))
    fused = fuse_estimates(each, [pair.video_from_view for pair in pairs])
    return tuple(each), level_of(fused, settings)


def level_of(estimate: LightEstimate, settings: SessionSettings) -> LightEstimate:
    """An estimate in the frame of the video's camera, which knows how the camera was held."""
    held = settings.snapshot
    level = Rotation.from_heading_pitch_roll(
        0.0, float(np.deg2rad(held.pitch_deg)), float(np.deg2rad(held.roll_deg))
    )
    return replace(estimate, level_from_camera=level)


def write_session(
    result: SessionResult, out: Path, settings: OutputSettings | None = None
) -> dict[str, Any]:
    """Write the light, the views it was read from, and where the objects went.

    Beside the files of `panokit.lighting.write_outputs` lie `views/K_left.png` and so on for
    click K from 1, and `session.json`.

    Returns:
        The record of the session.

    Raises:
        StorageError: If the folder cannot be written.
    """
    out = Path(out)
    for number, one in enumerate(result.found, start=1):
        views = one.pair.views
        pictures = {
            "left": views.left,
            "right": views.right,
            "left_object": views.left_object,
            "right_object": views.right_object,
            "background": views.background,
        }
        for name, picture in pictures.items():
            write_bytes(out / VIEWS / f"{number}_{name}.png", encode_png(picture))
    record = session_record(result)
    write_json(out / RECORD, record)
    write_outputs(result.estimate, out, settings)
    return record


def session_record(result: SessionResult) -> dict[str, Any]:
    """What happened, for `json.dump`."""
    confidence = result.estimate.confidence
    return {
        "schema": SCHEMA,
        "model": result.estimate.model,
        "warnings": list(result.estimate.warnings),
        "confidence": confidence and confidence.to_json(),
        "objects": [_object_record(one) for one in result.found],
    }


def _object_record(found: FoundPair) -> dict[str, Any]:
    pair = found.pair
    return {
        "frames": {"left": pair.left.number, "right": pair.right.number},
        "shift": round(pair.shift, 4),
        "fov_deg": round(pair.views.fov_deg, 2),
        "tolerance": round(pair.left.selection.tolerance, 2),
        "video_from_view": pair.video_from_view.matrix.round(6).tolist(),
        "losses": [list(span) for span in found.track.losses],
        "track": [
            {
                "frame": one.number,
                "box": [round(v, 1) for v in (one.box.x, one.box.y, one.box.width, one.box.height)],
                "state": one.state,
                "likeness": one.likeness,
            }
            for one in found.track.frames
        ],
    }
