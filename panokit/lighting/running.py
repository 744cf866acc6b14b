"""An estimate kept up over a video: read anew when the light changes, averaged while it does not.

A network is asked again on two occasions only (sections 5.3 and 6.4.3 of the 2018 thesis): when
the brightness of what is seen has changed, and then all older readings are forgotten; and when
the camera has moved on by as far as two views are apart, as then it sees something new. Readings
of the same light are turned into the frame of the video's camera and fused by how sure they are.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from panokit.color import luminance, srgb_decode_u8
from panokit.lighting.estimate import LightEstimate
from panokit.lighting.fuse import fuse_estimates
from panokit.lighting.model import LightingModel
from panokit.lighting.pair import Click, selection_at
from panokit.lighting.select import Selection, select_object
from panokit.lighting.session import level_of
from panokit.lighting.settings import SessionSettings
from panokit.lighting.snapshots import Snapshot, StereoPair, stereo_pair
from panokit.lighting.track import TrackedFrame, follow
from panokit.lighting.video import Frames, Picture, smaller

What = Literal["waiting", "kept", "read", "changed", "lost"]
# Snapshots that a later frame may be paired with; each holds a frame.
_KEPT = 6
# Brightness is metered at this width; what is darker than a thousandth of white counts as that.
_BRIGHTNESS_PX = 160
_DARKEST = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunningState:
    """What is known after a frame.

    Attributes:
        tracked: Where the object is.
        what: "waiting" for a second view, "kept" as nothing changed, "read" anew and averaged,
            "changed" light and all older readings forgotten, or "lost".
        estimate: The light by now, in the frame of the video's camera; None until there is one.
            After a change it is the light of before, scaled by the change, until it is read.
        readings: How many are averaged in it.
    """

    tracked: TrackedFrame
    what: What
    estimate: LightEstimate | None
    readings: int


class RunningLight:
    """Keeps an estimate up while frames come in; see the module.

    Args:
        model: What reads the light.
        first: The frame of the click, with the object.
        settings: How.
    """

    def __init__(
        self, model: LightingModel, first: Snapshot, settings: SessionSettings | None = None
    ) -> None:
        self.settings = settings or SessionSettings()
        self._model = model
        self._selection: Selection = first.selection
        self._snapshots: deque[Snapshot] = deque([first], maxlen=_KEPT)
        self._brightness = brightness(first.picture)
        self._readings: deque[tuple[LightEstimate, StereoPair]] = deque(
            maxlen=self.settings.running.most
        )
        self._estimate: LightEstimate | None = None

    def see(self, tracked: TrackedFrame, picture: Picture) -> RunningState:
        """Take in the next frame and where the object is in it."""
        what: What = "lost"
        if tracked.state == "found":
            what = "changed" if self._has_changed(picture) else "waiting"
            if what == "changed":
                self._forget(picture)
            what = self._look(tracked, picture, what)
        return RunningState(
            tracked=tracked, what=what, estimate=self._estimate, readings=len(self._readings)
        )

    def _has_changed(self, picture: Picture) -> bool:
        ratio = brightness(picture) / self._brightness
        return max(ratio, 1 / ratio) > 1 + self.settings.running.change

    def _forget(self, picture: Picture) -> None:
        """Start anew in another light."""
        now = brightness(picture)
        if self._estimate is not None:
            self._estimate = fuse_estimates([self._estimate], gains=[now / self._brightness])
        self._brightness = now
        self._readings.clear()
        self._snapshots.clear()

    def _look(self, tracked: TrackedFrame, picture: Picture, what: What) -> What:
        wanted = self.settings.snapshot.shift * self._selection.box.longest
        column = tracked.box.center[0]
        # From the latest on, so that the two views are of nearly the same moment.
        partner = next(
            (
                one
                for one in reversed(self._snapshots)
                if abs(one.selection.box.center[0] - column) >= wanted
            ),
            None,
        )
        newest = self._snapshots[-1] if self._snapshots else None
        is_new = newest is None or abs(newest.selection.box.center[0] - column) >= wanted / 2
        if partner is None and not is_new:
            return "kept" if self._readings and what == "waiting" else what
        selection = selection_at(picture, tracked.box, self._selection)
        snapshot = Snapshot(number=tracked.number, picture=picture, selection=selection)
        if partner is None:
            self._snapshots.append(snapshot)
            return "kept" if self._readings and what == "waiting" else what
        self._read(stereo_pair(partner, snapshot, self.settings.snapshot))
        # The next reading waits until this frame is as far behind.
        self._snapshots.clear()
        self._snapshots.append(snapshot)
        return "read"

    def _read(self, pair: StereoPair) -> None:
        self._readings.append((self._model.estimate(pair.views), pair))
        fused = fuse_estimates(
            [one for one, _ in self._readings],
            [pair.video_from_view for _, pair in self._readings],
        )
        self._estimate = level_of(fused, self.settings)


def running_light(
    frames: Frames,
    click: Click,
    model: LightingModel,
    settings: SessionSettings | None = None,
) -> Iterator[RunningState]:
    """The light frame by frame, from the click's on; reads on as one takes.

    Raises:
        ImageError: If the click is on the background, or a frame cannot be read.
    """
    settings = settings or SessionSettings()
    picture = frames.frame(click.frame)
    selection = select_object(picture, (click.column, click.row), settings.select)
    first = Snapshot(number=click.frame, picture=picture, selection=selection)
    running = RunningLight(model, first, settings)
    for tracked, seen in follow(frames, selection, click.frame, settings.track, settings.select):
        yield running.see(tracked, seen)


def brightness(picture: Picture) -> float:
    """The mean of the log of a frame's luminance, as a luminance: what a meter would say."""
    small, _ = smaller(picture, _BRIGHTNESS_PX)
    light = np.maximum(luminance(srgb_decode_u8(small)), _DARKEST)
    return float(np.exp(np.log(light).mean()))
