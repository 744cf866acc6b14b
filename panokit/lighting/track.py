"""The object followed from frame to frame, and every loss told.

A correlation filter follows the box: KCF (Henriques et al. 2015) or CSRT (Lukezic et al. 2017).
Neither is believed blindly: a box whose colors are not the object's any more, or that has left
the frame, is lost, whatever the filter says. The clicked color, filled anew around the box, keeps
the box on the object where that is clear.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.lighting.select import Box, Selection, flood
from panokit.lighting.settings import SelectSettings, TrackSettings
from panokit.lighting.video import Frames, Picture, smaller

State = Literal["found", "lost"]
# What is filled anew counts as the same object if its box and its area agree this well.
_SAME_BOX, _SAME_AREA = 0.7, 1.3
# What was filled at the click must be most of the object to be a sign of it.
_MOST_OF_IT = 0.6
# Further than this off what was filled, the filter starts anew there.
_DRIFT = 0.82
# Of the box in the frame, less is lost; and frames that differ in brightness by more are evened.
_INSIDE, _DIMMED = 0.7, 1.12
# Of a histogram in LAB.
_BINS = (8, 12, 12)
_MAKERS: dict[str, Callable[[], Any]] = {
    "kcf": cv2.TrackerKCF_create,  # type: ignore[attr-defined]
    "csrt": cv2.TrackerCSRT_create,  # type: ignore[attr-defined]
}


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackedFrame:
    """Where the object is in one frame.

    Attributes:
        number: Of the frame.
        box: In pixels of the frame; where it was last seen if it is lost.
        state: "found" or "lost".
        likeness: How like the object the colors in the box are, 0 to 1.
    """

    number: int
    box: Box
    state: State
    likeness: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """Where the object went.

    Attributes:
        frames: In order, the frame of the click first.
        losses: First and last frame of each stretch where it was lost.
    """

    frames: tuple[TrackedFrame, ...]
    losses: tuple[tuple[int, int], ...] = field(init=False)

    def __post_init__(self) -> None:
        losses: list[tuple[int, int]] = []
        before: TrackedFrame | None = None
        for one in self.frames:
            if one.state == "lost":
                goes_on = before is not None and before.state == "lost"
                losses = [*losses[:-1], (losses[-1][0], one.number)] if goes_on else [
                    *losses, (one.number, one.number),
                ]  # fmt: skip
            before = one
        object.__setattr__(self, "losses", tuple(losses))

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each loss."""
        last = self.frames[-1].number if self.frames else 0
        return tuple(
            f"The object was lost in frame {start}"
            + (" and not found again." if end == last else f" and found again in {end + 1}.")
            for start, end in self.losses
        )


class Follower:
    """Follows an object through frames that it is shown one after the other.

    Args:
        picture: The frame of the click.
        selection: The object in it.
        settings: How.
        select: How the object was selected.

    Raises:
        UsageError: If mask and frame differ in size.
    """

    def __init__(
        self,
        picture: Picture,
        selection: Selection,
        settings: TrackSettings | None = None,
        select: SelectSettings | None = None,
    ) -> None:
        self.settings = settings or TrackSettings()
        if selection.mask.shape != picture.shape[:2]:
            raise UsageError(
                f"The object was selected in a frame of another size, {selection.mask.shape} and "
                f"not {picture.shape[:2]}. Select it in a frame of this video."
            )
        small, self._scale = smaller(picture, self.settings.width_px)
        size = (small.shape[1], small.shape[0])
        mask = cv2.resize(selection.mask.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)
        self._box = self._box_first = selection.box.scaled(self._scale)
        self._level = _level(small)
        self._colors = _histogram(small, self._box, np.asarray(mask, np.uint8))
        self._inner = _histogram(small, self._box)
        # Where in the box the click was; the color is filled from there again.
        self._seed = tuple(
            (value * self._scale - start) / max(length, 1e-6)
            for value, start, length in zip(
                selection.seed, (self._box.x, self._box.y),
                (self._box.width, self._box.height), strict=True,
            )
        )  # fmt: skip
        keep = select or SelectSettings()
        self._fill = keep.model_copy(update={"tolerance": selection.tolerance})
        self._filled_first = self._flooded(small, self._box)
        if self._filled_first is not None and (
            self._filled_first[0].overlap(self._box) < _MOST_OF_IT
        ):
            self._filled_first = None
        self._area = self._filled_first[1] if self._filled_first else 0.0
        self._filter = self._started(small, self._box)

    def see(self, number: int, picture: Picture) -> TrackedFrame:
        """Find the object in the next frame."""
        small = self._as_bright(smaller(picture, self.settings.width_px)[0])
        there, found = self._filter.update(small[..., ::-1])
        box = Box(**dict(zip(("x", "y", "width", "height"), map(float, found), strict=True)))
        if not there or box.width < 1:
            box = self._box
        filled = self._filled(small, box)
        likeness = self._likeness(small, box)
        if filled is not None:
            there = True
            likeness = max(likeness, self._likeness(small, filled))
            if filled.overlap(box) < _DRIFT:
                self._filter = self._started(small, filled)
            box = filled
        is_found = there and likeness >= self.settings.likeness and _is_inside(small, box)
        if is_found:
            self._box = box
        return TrackedFrame(
            number=number, box=self._box.scaled(1 / self._scale),
            state="found" if is_found else "lost", likeness=round(likeness, 3),
        )  # fmt: skip

    def _as_bright(self, small: Picture) -> Picture:
        """A frame as bright as the first: where all of it dims, the object is not another."""
        gain = self._level / _level(small)
        if 1 / _DIMMED < gain < _DIMMED:
            return small
        return np.asarray(np.clip(small * np.clip(gain, 0.2, 5.0), 0, 255), np.uint8)

    def _started(self, small: Picture, box: Box) -> Any:
        made = _MAKERS[self.settings.tracker]()
        left, top = max(0, int(box.x)), max(0, int(box.y))
        right = min(small.shape[1], int(np.ceil(box.x + box.width)))
        bottom = min(small.shape[0], int(np.ceil(box.y + box.height)))
        made.init(
            np.ascontiguousarray(small[..., ::-1]),
            (left, top, max(2, right - left), max(2, bottom - top)),
        )
        return made

    def _filled(self, small: Picture, box: Box) -> Box | None:
        """The box by the color filled around it, if it is the same object by all signs."""
        if self._filled_first is None:
            return None
        now = self._flooded(small, box)
        if now is None:
            return None
        (first, _), (found, area) = self._filled_first, now
        if not self._area / _SAME_AREA < area < self._area * _SAME_AREA:
            return None
        # What is filled was a part of the box at the click, and is the same part now.
        start = self._box_first
        wide, high = found.width / first.width, found.height / first.height
        moved = Box(
            x=found.x + (start.x - first.x) * wide, y=found.y + (start.y - first.y) * high,
            width=start.width * wide, height=start.height * high,
        )  # fmt: skip
        if moved.overlap(box) < _SAME_BOX:
            return None
        # It may come nearer, but not become another one at once.
        self._area = area
        return moved

    def _flooded(self, small: Picture, box: Box) -> tuple[Box, float] | None:
        """Box and area of the clicked color around a box."""
        if self._fill.tolerance <= 0:
            return None
        x = box.x + self._seed[0] * box.width
        y = box.y + self._seed[1] * box.height
        left, top, right, bottom = _window(small, box, 1.0)
        if not (left <= x < right and top <= y < bottom):
            return None
        part = np.ascontiguousarray(small[top:bottom, left:right])
        found = flood(part, (x - left, y - top), self._fill)
        if found.box.width < 1:
            return None
        at = Box(
            x=found.box.x + left, y=found.box.y + top,
            width=found.box.width, height=found.box.height,
        )  # fmt: skip
        return at, float(found.mask.sum())

    def _likeness(self, small: Picture, box: Box) -> float:
        """One minus the distance of Bhattacharyya, of the colors within the box."""
        seen = _histogram(small, box)
        distance = min(
            cv2.compareHist(kept, seen, cv2.HISTCMP_BHATTACHARYYA)
            for kept in (self._inner, self._colors)
        )
        return float(1 - distance)


def follow(
    frames: Frames,
    selection: Selection,
    number: int,
    settings: TrackSettings | None = None,
    select: SelectSettings | None = None,
) -> Iterator[tuple[TrackedFrame, Picture]]:
    """Each frame from the click's on, with where the object is in it; reads on as one takes.

    Args:
        frames: To follow in.
        selection: The object in frame `number`.
        number: The frame of the click.
        settings: How to follow.
        select: How it was selected.
    """
    follower: Follower | None = None
    for at, picture in frames.frames_from(number):
        if follower is None:
            follower = Follower(picture, selection, settings, select)
            first = TrackedFrame(number=at, box=selection.box, state="found", likeness=1.0)
            yield first, picture
        else:
            yield follower.see(at, picture), picture


def track_object(
    frames: Frames,
    selection: Selection,
    number: int = 0,
    settings: TrackSettings | None = None,
    *,
    last: int | None = None,
) -> Track:
    """Where the object is in all frames from `number` to `last`, or to the end."""
    found = []
    for one, _ in follow(frames, selection, number, settings):
        found.append(one)
        if last is not None and one.number >= last:
            break
    return Track(frames=tuple(found))


def _histogram(
    small: Picture, box: Box, mask: NDArray[np.uint8] | None = None
) -> NDArray[np.float32]:
    left, top, right, bottom = _window(small, box, -0.1)
    if right - left < 1 or bottom - top < 1:
        return np.zeros(_BINS, np.float32)
    part = np.ascontiguousarray(small[top:bottom, left:right])
    lab = cv2.cvtColor(part, cv2.COLOR_RGB2LAB)
    inside = None if mask is None else np.ascontiguousarray(mask[top:bottom, left:right])
    counts = cv2.calcHist([lab], [0, 1, 2], inside, _BINS, [0, 256, 64, 192, 64, 192])
    # Neighboring bins share a little: a change of light moves colors by less than a bin.
    soft = np.asarray(counts, np.float32)
    for axis in range(3):
        soft = 0.5 * soft + 0.25 * (np.roll(soft, 1, axis) + np.roll(soft, -1, axis))
    return np.asarray(soft / max(float(soft.sum()), 1e-6), np.float32)


def _level(small: Picture) -> float:
    """How bright a frame is, in coded values."""
    return max(float(small[::4, ::4].mean()), 1.0)


def _window(small: Picture, box: Box, margin: float) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of a box made larger by a part of its sides, in the picture."""
    wide, high = margin * box.width, margin * box.height
    height, width = small.shape[:2]
    left, top = max(0, int(box.x - wide)), max(0, int(box.y - high))
    right = min(width, int(np.ceil(box.x + box.width + wide)))
    bottom = min(height, int(np.ceil(box.y + box.height + high)))
    return left, top, right, bottom


def _is_inside(small: Picture, box: Box) -> bool:
    """Whether most of a box is in the frame."""
    left, top, right, bottom = _window(small, box, 0.0)
    seen = max(right - left, 0) * max(bottom - top, 0)
    return seen >= _INSIDE * box.width * box.height
