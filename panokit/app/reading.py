"""What Lighting from video does, without a browser: one video, its clicks, and what comes of them.

A `Reading` belongs to one tab. Its functions are called in threads; one at a time, but for frames,
which the player asks for while anything goes on.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.app.insertion import insert_balls
from panokit.errors import ModelError, UsageError
from panokit.io import encode_jpeg, read_json
from panokit.lighting.estimate import LightEstimate
from panokit.lighting.model import LightingModel
from panokit.lighting.outputs import RECORD
from panokit.lighting.pair import FoundPair, pair_of
from panokit.lighting.select import Selection, box_of, flood, selection_from_mask
from panokit.lighting.session import SessionResult, read_light, write_session
from panokit.lighting.settings import OutputSettings, SelectSettings, SessionSettings
from panokit.lighting.snapshots import Snapshot, StereoPair, stereo_pair
from panokit.lighting.track import TrackedFrame
from panokit.lighting.video import Frames, open_frames, smaller
from panokit.reflectance.light_network import TASK
from panokit.report.entries import light_map
from panokit.report.page import render_viewer
from panokit.weights import released_models

SHOWN_PX = 960
_TINT, _LINE = (64, 156, 255), (255, 255, 255)
SIDES = ("left", "right")


class StoppedError(UsageError):
    """Following was ended by whoever watched."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stroke:
    """A line that was drawn over a mask.

    Attributes:
        points: Columns and rows, in pixels of the frame.
        radius_px: Of the brush.
        adds: Whether it belongs to the object, or not.
    """

    points: tuple[tuple[float, float], ...]
    radius_px: float
    adds: bool


class Reading:
    """A video and how far its reading has come.

    Args:
        path: A video file, or a folder of frames.
        settings: With the model and how the camera was held.

    Raises:
        UsageError: If there is nothing at the path.
        ImageError: If it is no video, or not one frame of it can be read.
    """

    def __init__(self, path: Path, settings: SessionSettings) -> None:
        self.frames: Frames = open_frames(path)
        self.settings = settings
        self.first: Snapshot | None = None
        self.tolerance = 0.0
        self.found: FoundPair | None = None
        self.confirmed: list[FoundPair] = []
        self.stop = threading.Event()

    def close(self) -> None:
        """Let the file go; a frame that is being read is read first."""
        self.stop.set()
        close = getattr(self.frames, "close", None)
        if close is not None:
            close()

    @property
    def fov_deg(self) -> float:
        """What the video shows from its left to its right edge."""
        return self.settings.snapshot.fov_deg

    def jpeg(self, name: str) -> bytes:
        """A frame by its number, as the browser shows it."""
        number = int(name)
        if not 0 <= number < self.frames.count:
            raise UsageError(f"There is no frame {number}; the last is {self.frames.count - 1}.")
        small, _ = smaller(self.frames.frame(number), SHOWN_PX)
        return encode_jpeg(small, quality=84)

    def click(self, number: int, place: tuple[float, float], tolerance: float = 0.0) -> Selection:
        """What is selected by a click; kept, with its `problem` if it is no object.

        Args:
            number: Of the frame.
            place: Column and row in the frame.
            tolerance: How far colors may be from the clicked one; 0 to choose what suits.
        """
        same = self.first is not None and self.first.number == number
        picture = self.first.picture if same and self.first else self.frames.frame(number)
        settings = SelectSettings(tolerance=tolerance, close_px=self.settings.select.close_px)
        selection = flood(picture, place, settings)
        self.first = Snapshot(number=number, picture=picture, selection=selection)
        self.tolerance, self.found = selection.tolerance, None
        return selection

    def tolerate(self, tolerance: float) -> Selection:
        """The same click with another tolerance."""
        if self.first is None:
            raise UsageError("Nothing is selected. Click an object first.")
        return self.click(self.first.number, self.first.selection.seed, tolerance)

    def edit(self, stroke: Stroke) -> Selection:
        """Change the mask of the first snapshot by hand."""
        if self.first is None:
            raise UsageError("Nothing is selected. Click an object first.")
        self.first, self.found = edited(self.first, stroke), None
        return self.first.selection

    def follow(self, on_frame: Callable[[TrackedFrame], None]) -> FoundPair:
        """Follow the object until it has moved far enough for a second view.

        Raises:
            ItemError: If it never does.
            StoppedError: If `stop` was set meanwhile.
        """
        if self.first is None:
            raise UsageError("Nothing is selected. Click an object first.")
        if self.first.selection.problem:
            raise UsageError(self.first.selection.problem)
        self.stop.clear()

        def seen(one: TrackedFrame) -> None:
            if self.stop.is_set():
                raise StoppedError("Following was stopped. Click the object in another frame.")
            on_frame(one)

        self.found = pair_of(self.frames, self.first, self.settings, on_frame=seen)
        return self.found

    def edit_view(self, side: str, stroke: Stroke) -> StereoPair:
        """Change the mask of one of the two snapshots by hand."""
        if self.found is None:
            raise UsageError("There are no snapshots yet. Follow the object first.")
        pair = self.found.pair
        views = {one: getattr(pair, one) for one in SIDES}
        views[side] = edited(views[side], stroke)
        remade = stereo_pair(views["left"], views["right"], self.settings.snapshot)
        self.found = replace(self.found, pair=remade)
        return remade

    def read(self, model: LightingModel) -> SessionResult:
        """The light of all that was confirmed, and of what is being looked at."""
        if self.found is None:
            raise UsageError("There are no snapshots yet. Follow the object first.")
        founds = [*self.confirmed, self.found]
        each, estimate = read_light([one.pair for one in founds], model, self.settings)
        more = tuple(text for one in founds for text in one.track.warnings)
        told = tuple(dict.fromkeys((*more, *estimate.warnings)))
        return SessionResult(
            estimate=replace(estimate, warnings=told), each=each, found=tuple(founds)
        )

    def keep_and_go_on(self) -> None:
        """Keep the object that was read, and begin with another."""
        if self.found is not None:
            self.confirmed.append(self.found)
        self.first = self.found = None

    def shown(self, result: SessionResult) -> tuple[bytes, bytes]:
        """JPEG: the frame as it is, and with relit balls beside the object."""
        snapshot = result.found[-1].pair.left
        small, scale = smaller(snapshot.picture, SHOWN_PX)
        mask = snapshot.selection.mask
        if scale < 1:
            size = (small.shape[1], small.shape[0])
            mask = np.asarray(cv2.resize(mask.astype(np.uint8), size) > 0)
        with_balls = insert_balls(
            small,
            mask,
            np.asarray(result.estimate.envmap.radiance),
            result.estimate.level_from_camera,
            self.fov_deg,
        )
        return encode_jpeg(small, quality=88), encode_jpeg(with_balls, quality=88)


def edited(snapshot: Snapshot, stroke: Stroke) -> Snapshot:
    """A snapshot with its mask changed by hand."""
    canvas = snapshot.selection.mask.astype(np.uint8)
    points = np.rint(np.array(stroke.points, np.float64).reshape(-1, 1, 2)).astype(np.int32)
    if len(points) == 0 or not np.isfinite(stroke.radius_px):
        return snapshot
    value = int(stroke.adds)
    radius = int(np.clip(round(stroke.radius_px), 1, max(canvas.shape)))
    cv2.polylines(canvas, [points], False, value, thickness=2 * radius, lineType=cv2.LINE_8)
    for point in points[:, 0]:
        cv2.circle(canvas, (int(point[0]), int(point[1])), radius, value, -1)
    mask = canvas > 0
    if not mask.any():
        selection = replace(
            snapshot.selection,
            mask=mask,
            box=box_of(mask),
            problem="Nothing is selected any more. Add to the mask, or click the object again.",
        )
    else:
        selection = selection_from_mask(mask)
    return replace(snapshot, selection=selection)


def overlay(mask: NDArray[np.bool_]) -> bytes:
    """A mask as a PNG to lie over its frame: a tint with an outline, clear elsewhere."""
    height, width = mask.shape
    scale = min(1.0, SHOWN_PX / width)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    small = cv2.resize(mask.astype(np.uint8), size, interpolation=cv2.INTER_AREA)
    picture = np.zeros((size[1], size[0], 4), np.uint8)
    picture[small > 0] = (*_TINT[::-1], 105)
    lines, _ = cv2.findContours(small, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(picture, lines, -1, (*_TINT[::-1], 255), 3, cv2.LINE_AA)
    cv2.drawContours(picture, lines, -1, (*_LINE, 255), 1, cv2.LINE_AA)
    _, data = cv2.imencode(".png", picture)
    return bytes(data)


def snapshot_jpeg(snapshot: Snapshot) -> bytes:
    """The picture of a snapshot, as the browser shows it."""
    return encode_jpeg(smaller(snapshot.picture, SHOWN_PX)[0], quality=86)


def light_page(estimate: LightEstimate) -> bytes:
    """The HDR viewer with what was read, as a page."""
    entry = light_map(estimate.envmap, "The light that was read", label="Light", width_px=512)
    return render_viewer(entry).encode()


def write_results(result: SessionResult, out: Path, width_px: int) -> dict[str, Any]:
    """All files of a result, as `panokit lighting` writes them; the record of the outputs."""
    write_session(result, out, OutputSettings(width_px=width_px))
    return dict(read_json(out / RECORD))


def lighting_models() -> list[str]:
    """The ids of the installed models that read light."""
    return [model.id for model in released_models() if model.task == TASK]


def chosen_model(asked: str | None) -> str:
    """The model to read with: the one asked for, else the usual one, else any there is.

    Raises:
        ModelError: If there is none.
    """
    if asked:
        return asked
    there, usual = lighting_models(), SessionSettings().model
    if usual in there:
        return usual
    if there:
        return there[-1]
    raise ModelError(
        "No model that reads light is installed. Install a release of panokit that has one, or "
        "train one and start the application with --lighting-model FOLDER."
    )


@lru_cache(maxsize=2)
def loaded_model(model: str) -> LightingModel:
    """A model, loaded once for all tabs.

    Raises:
        ModelError: If there is no such model.
    """
    return LightingModel(model)
