"""From a click to two snapshots: select, follow, and stop when the object has moved far enough."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from panokit.equirectangular import read_only
from panokit.errors import ItemError
from panokit.lighting.refine import fitted
from panokit.lighting.select import Box, Mask, Selection, box_of, select_object
from panokit.lighting.settings import SessionSettings
from panokit.lighting.snapshots import Snapshot, StereoPair, stereo_pair
from panokit.lighting.track import Track, TrackedFrame, follow
from panokit.lighting.video import Frames, Picture, smaller

# A mask that was fitted counts if it overlaps the first one, moved along, this much.
_SAME_MASK = 0.6
# With less of the motion that was asked for, the views say nothing of shape.
_LEAST_OF_SHIFT = 0.5
# Masks are fitted at this width of the frame.
_FIT_PX = 640


@dataclass(frozen=True, slots=True, kw_only=True)
class Click:
    """A click on an object, in pixels of a frame."""

    column: float
    row: float
    frame: int = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FoundPair:
    """What came of a click.

    Attributes:
        pair: The two views.
        track: Where the object went between them.
    """

    pair: StereoPair
    track: Track

    @property
    def warnings(self) -> tuple[str, ...]:
        """All that is to be minded, a sentence each."""
        return (*self.track.warnings, *self.pair.warnings)


def find_pair(
    frames: Frames,
    click: Click,
    settings: SessionSettings | None = None,
    *,
    on_frame: Callable[[TrackedFrame], None] | None = None,
) -> FoundPair:
    """Two views of the object that was clicked, as far apart as a network knows.

    Args:
        frames: To look at; read from the click's on, no further than need be.
        click: On the object.
        settings: How.
        on_frame: Called with where the object is, frame by frame.

    Raises:
        UsageError: If there is no such frame, or the click is beside it.
        ImageError: If the click is on the background, or a frame cannot be read.
        ItemError: If the object never moves far enough sideways (`reason` "no-parallax").
    """
    settings = settings or SessionSettings()
    picture = frames.frame(click.frame)
    selection = select_object(picture, (click.column, click.row), settings.select)
    first = Snapshot(number=click.frame, picture=picture, selection=selection)
    return pair_of(frames, first, settings, on_frame=on_frame)


def pair_of(
    frames: Frames,
    first: Snapshot,
    settings: SessionSettings | None = None,
    *,
    on_frame: Callable[[TrackedFrame], None] | None = None,
) -> FoundPair:
    """The same from a first snapshot, whose mask may have been corrected by hand.

    Raises:
        ItemError: If the object never moves far enough sideways (`reason` "no-parallax").
    """
    settings = settings or SessionSettings()
    start = first.selection.box
    wanted = settings.snapshot.shift
    seen: list[TrackedFrame] = []
    best: tuple[float, TrackedFrame, Picture] | None = None
    steps = follow(frames, first.selection, first.number, settings.track, settings.select)
    for one, picture in steps:
        seen.append(one)
        if on_frame is not None:
            on_frame(one)
        if one.state == "lost" or one.number == first.number:
            continue
        moved = abs(one.box.center[0] - start.center[0]) / start.longest
        if best is None or abs(moved - wanted) < abs(best[0] - wanted):
            best = (moved, one, picture)
        if moved >= wanted:
            break
    track = Track(frames=tuple(seen))
    if best is None or best[0] < _LEAST_OF_SHIFT * wanted:
        raise _no_motion(best[0] if best else 0.0, wanted, track)
    _, found, picture = best
    second = selection_at(picture, found.box, first.selection)
    pair = stereo_pair(
        first,
        Snapshot(number=found.number, picture=picture, selection=second),
        settings.snapshot,
    )
    return FoundPair(pair=pair, track=track)


def selection_at(picture: Picture, box: Box, before: Selection) -> Selection:
    """The object in another frame, where it was followed to.

    The mask of before, moved along and fitted to the colors there; just moved along where fitting
    makes something else of it.
    """
    moved = _moved(before, box)
    if moved.any():
        small, scale = smaller(picture, _FIT_PX)
        found = fitted(small, _resized(moved, small) if scale < 1 else moved)
        if scale < 1:
            found = _resized(found, picture)
        shared, both = float((found & moved).sum()), float((found | moved).sum())
        if shared >= _SAME_MASK * both:
            moved = found
    return Selection(
        mask=read_only(moved), box=box_of(moved) if moved.any() else box,
        seed=_seed_in(before, box), tolerance=before.tolerance,
    )  # fmt: skip


def _resized(mask: Mask, like: Picture) -> Mask:
    size = (like.shape[1], like.shape[0])
    share = cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_LINEAR)
    return np.asarray(share > 0.5)


def _moved(before: Selection, box: Box) -> Mask:
    """The mask of before, laid into a box."""
    scale_x = box.width / max(before.box.width, 1e-6)
    scale_y = box.height / max(before.box.height, 1e-6)
    matrix = np.array(
        [
            [scale_x, 0, box.x - scale_x * before.box.x],
            [0, scale_y, box.y - scale_y * before.box.y],
        ]
    )
    height, width = before.mask.shape
    values = before.mask.astype(np.float32)
    laid = cv2.warpAffine(values, matrix, (width, height), flags=cv2.INTER_LINEAR)
    return np.asarray(laid >= 0.5)


def _seed_in(before: Selection, box: Box) -> tuple[float, float]:
    """Where in another box the click would be."""
    across = (before.seed[0] - before.box.x) / max(before.box.width, 1e-6)
    down = (before.seed[1] - before.box.y) / max(before.box.height, 1e-6)
    return box.x + across * box.width, box.y + down * box.height


def _no_motion(moved: float, wanted: float, track: Track) -> ItemError:
    last = track.frames[-1].number if track.frames else 0
    lost = f" {' '.join(track.warnings)}" if track.losses else ""
    return ItemError(
        f"The object moved sideways by {moved:.0%} of its size up to frame {last}; {wanted:.0%} "
        "are needed for a second view. Move the camera sideways past the object, or click it in an "
        f"earlier frame.{lost}",
        reason="lost" if lost else "no-parallax",
        values={"moved": moved, "wanted": wanted, "last": last},
    )
