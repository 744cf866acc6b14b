"""A click becomes an object: what is connected to the clicked pixel and has its color.

The flood fill of the 2018 thesis (appendix A), in CIE LAB. Light and shade change an object's
brightness a lot and its hue little, so brightness counts little, and the chroma that is expected
grows with it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.equirectangular import read_only
from panokit.errors import ImageError, UsageError
from panokit.lighting.refine import fitted, grown, outline_contrast
from panokit.lighting.settings import SelectSettings
from panokit.lighting.video import Picture, smaller

Mask = NDArray[np.bool_]
# Objects are searched at this width of the frame.
_WORK_PX = 640
# The clicked color is the median of so many pixels to either side.
_SEED_RADIUS_PX = 2
# How much a difference of lightness counts, and how far chroma is expected to follow it.
_LIGHTNESS = 0.3
_SHADE = (0.35, 1.8)
# What is tried where no tolerance is set: from 4, each a fifth larger than the last.
_TOLERANCES = tuple(float(t) for t in 4 * 1.22 ** np.arange(12))
# A region that grows faster than this with tolerance has no edge there.
_STEADY = 0.35
_LEAST_PX = 60
_MOST_HOLE = 0.02
# Masks are compared at this size; one is clear that has so much of the clearest one's contrast.
_TRIAL_PX, _CLEAR = 140, 0.65
# What covers more of the frame, or of its rim, is the background.
_MOST_SHARE, _MOST_RIM = 0.45, 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A rectangle in pixels of a frame; edges, not centers, lie at whole numbers."""

    x: float
    y: float
    width: float
    height: float

    @property
    def center(self) -> tuple[float, float]:
        """Column and row of its middle."""
        return self.x + self.width / 2, self.y + self.height / 2

    @property
    def longest(self) -> float:
        """Its larger side."""
        return max(self.width, self.height)

    def scaled(self, factor: float) -> "Box":
        """The same place in a picture that is `factor` times as large."""
        return Box(
            x=self.x * factor, y=self.y * factor,
            width=self.width * factor, height=self.height * factor,
        )  # fmt: skip

    def overlap(self, other: "Box") -> float:
        """Intersection over union."""
        wide = min(self.x + self.width, other.x + other.width) - max(self.x, other.x)
        high = min(self.y + self.height, other.y + other.height) - max(self.y, other.y)
        shared = max(wide, 0.0) * max(high, 0.0)
        whole = self.width * self.height + other.width * other.height - shared
        return shared / whole if whole > 0 else 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Selection:
    """An object in a frame.

    Attributes:
        mask: (H, W) bool at the frame's size, read-only.
        box: Around it.
        seed: Column and row that were clicked.
        tolerance: With which it was filled, 0 where it was drawn by hand.
        problem: Why it is no object to read light from, a sentence; empty if it is one.
    """

    mask: Mask
    box: Box
    seed: tuple[float, float]
    tolerance: float
    problem: str = ""

    @property
    def touches_edge(self) -> bool:
        """Whether the frame cuts it off."""
        mask = self.mask
        return bool(mask[0].any() or mask[-1].any() or mask[:, 0].any() or mask[:, -1].any())


def select_object(
    picture: Picture, click: tuple[float, float], settings: SelectSettings | None = None
) -> Selection:
    """The object that was clicked.

    Args:
        picture: (H, W, 3) uint8 RGB.
        click: Column and row, as pixels from the upper left corner.
        settings: How.

    Raises:
        UsageError: If the picture is no RGB frame, or the click is beside it.
        ImageError: If what was clicked is the background, or too small (`reason` "background" or
            "too-small").
    """
    found = flood(picture, click, settings)
    if found.problem:
        reason = "too-small" if found.mask.mean() < 0.2 else "background"
        raise ImageError(found.problem, reason=reason, values={"share": float(found.mask.mean())})
    return found


def flood(
    picture: Picture, click: tuple[float, float], settings: SelectSettings | None = None
) -> Selection:
    """What `select_object` finds, also where it is no object: then `problem` says why.

    Raises:
        UsageError: If the picture is no RGB frame, or the click is beside it.
    """
    settings = settings or SelectSettings()
    if picture.ndim != 3 or picture.shape[2] != 3 or picture.dtype != np.uint8 or not picture.size:
        raise UsageError(
            f"A frame is (H, W, 3) uint8 RGB, not {picture.shape} {picture.dtype}. Convert it."
        )
    height, width = picture.shape[:2]
    if not (0 <= click[0] < width and 0 <= click[1] < height):
        raise UsageError(
            f"The click at {click[0]:g},{click[1]:g} lies beside the frame of {width}x{height}. "
            "Count its pixels from the upper left corner."
        )
    small, scale = smaller(picture, _WORK_PX)
    seed = (
        min(int(click[0] * scale), small.shape[1] - 1),
        min(int(click[1] * scale), small.shape[0] - 1),
    )
    away = color_distance(small, seed)
    if settings.tolerance > 0:
        chosen = settings.tolerance
        region, problem = _region(away, seed, chosen), ""
    else:
        chosen, region, problem = _steadiest(away, seed)
    region = closed(region, settings.close_px)
    problem = problem or _problem(region)
    if settings.tolerance == 0 and settings.grow and not problem and region.any():
        chosen, region = _clearest(small, away, seed, settings.close_px) or (chosen, region)
        whole = fitted(small, closed(grown(small, region, rounds=2), settings.close_px))
        # What ran out into the background is no better than what was filled.
        region = region if _problem(whole) else whole
    mask = region
    if scale < 1:
        shares = cv2.resize(region.astype(np.float32), (width, height))
        mask = np.asarray(shares >= 0.5)
    return Selection(
        mask=read_only(mask), box=box_of(mask), seed=(float(click[0]), float(click[1])),
        tolerance=chosen, problem=problem,
    )  # fmt: skip


def selection_from_mask(mask: Mask) -> Selection:
    """A mask that was drawn or corrected by hand, as a selection.

    Raises:
        ImageError: If nothing is in it.
    """
    mask = np.asarray(mask, bool)
    if mask.ndim != 2 or not mask.any():
        raise ImageError("The mask is empty. Paint over the object.", reason="too-small")
    rows, columns = np.nonzero(mask)
    middle = int(np.argmin(np.hypot(rows - rows.mean(), columns - columns.mean())))
    return Selection(
        mask=read_only(mask), box=box_of(mask), tolerance=0.0, problem=_problem(mask),
        seed=(float(columns[middle]), float(rows[middle])),
    )  # fmt: skip


def color_distance(picture: Picture, seed: tuple[int, int]) -> NDArray[np.float32]:
    """How far each pixel's color is from the seed's, (H, W) float32, in units of CIE LAB.

    Lightness counts 0.3; a and b are compared with those of the seed made lighter or darker:
    both grow in proportion to L where only the light on a surface changes.
    """
    calm = cv2.medianBlur(picture, 3)
    lab = cv2.cvtColor(calm.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2LAB)
    x, y = seed
    around = _SEED_RADIUS_PX
    patch = lab[max(0, y - around) : y + around + 1, max(0, x - around) : x + around + 1]
    light, *chroma = np.median(patch.reshape(-1, 3), axis=0)
    shade = np.clip(lab[..., 0] / max(float(light), 1.0), *_SHADE)
    off = [lab[..., k + 1] - chroma[k] * shade for k in range(2)]
    away = np.sqrt((_LIGHTNESS * (lab[..., 0] - light)) ** 2 + off[0] ** 2 + off[1] ** 2)
    return np.asarray(away, np.float32)


def box_of(mask: Mask) -> Box:
    """The rectangle around a mask, empty at the origin if nothing is in it."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return Box(x=0, y=0, width=0, height=0)
    return Box(
        x=float(columns[0]), y=float(rows[0]),
        width=float(columns[-1] - columns[0] + 1), height=float(rows[-1] - rows[0] + 1),
    )  # fmt: skip


def _region(away: NDArray[np.float32], seed: tuple[int, int], tolerance: float) -> Mask:
    """What is connected to the seed within a tolerance."""
    height, width = away.shape
    fits = np.zeros((height + 2, width + 2), np.uint8)
    fits[1:-1, 1:-1] = away > tolerance
    # The clicked pixel itself may be a speck that the others are not like.
    x, y = seed
    fits[y + 1, x + 1] = 0
    flags = 4 | (2 << 8) | cv2.FLOODFILL_MASK_ONLY
    cv2.floodFill(np.zeros((height, width), np.uint8), fits, seed, 0, flags=flags)
    return np.asarray(fits[1:-1, 1:-1] == 2)


def _steadiest(away: NDArray[np.float32], seed: tuple[int, int]) -> tuple[float, Mask, str]:
    """The tolerance at which the region's edge is the object's.

    Of the tolerances before the region runs out into the background, the last at which it grows
    little, as of maximally stable regions (Matas et al. 2002).
    """
    regions: list[Mask] = []
    for tolerance in _TOLERANCES:
        region = _region(away, seed, tolerance)
        if _problem(region, smallest=0):
            break
        regions.append(region)
    if not regions:
        return _TOLERANCES[0], region, ""
    areas = np.log([max(float(one.sum()), 1.0) for one in regions])
    growth = np.diff(areas)
    steady = [
        k for k in range(len(growth)) if growth[k] < _STEADY and np.exp(areas[k]) >= _LEAST_PX
    ]
    if len(regions) < len(_TOLERANCES) and not steady:
        return (
            _TOLERANCES[len(regions)], region,
            "The click is on the background: what has its color has no edge. Click the object "
            "itself, or set a tolerance.",
        )  # fmt: skip
    at = steady[-1] if steady else int(np.argmax(areas))
    return _TOLERANCES[at], regions[at], ""


def _clearest(
    picture: Picture, away: NDArray[np.float32], seed: tuple[int, int], close_px: int
) -> tuple[float, Mask] | None:
    """The least tolerance from which a mask grows that ends where colors change."""
    found: list[tuple[float, float, Mask]] = []
    for tolerance in _TOLERANCES[::2]:
        region = _region(away, seed, tolerance)
        if _problem(region, smallest=0):
            break
        region = closed(region, close_px)
        if region.sum() < _LEAST_PX:
            continue
        whole = closed(grown(picture, region, rounds=3, work_px=_TRIAL_PX), close_px)
        if not _problem(whole):
            found.append((outline_contrast(picture, whole), tolerance, whole))
    if not found:
        return None
    clear = _CLEAR * max(contrast for contrast, _, _ in found)
    return next((tolerance, whole) for contrast, tolerance, whole in found if contrast >= clear)


def closed(region: Mask, close_px: int) -> Mask:
    """Without gaps, holes and threads."""
    cells = region.astype(np.uint8)
    if close_px > 1:
        disk = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (close_px, close_px))
        cells = np.asarray(cv2.morphologyEx(cells, cv2.MORPH_CLOSE, disk), np.uint8)
    # Small holes are highlights; through large ones, as of a handle, one sees the background.
    count, labels, stats, _ = cv2.connectedComponentsWithStats(1 - cells, connectivity=4)
    most = _MOST_HOLE * float(cells.sum())
    for number in range(1, count):
        x, y, wide, high, area = stats[number]
        at_edge = x == 0 or y == 0 or x + wide == cells.shape[1] or y + high == cells.shape[0]
        if area < most and not at_edge:
            cells[labels == number] = 1
    opened = cv2.morphologyEx(cells, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(np.asarray(opened, np.uint8))
    if count < 2:
        return np.asarray(cells > 0)
    return np.asarray(labels == 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA])))


def _problem(mask: Mask, smallest: float = _LEAST_PX) -> str:
    """Why a mask is no object to read light from, with what to do; "" if it is one."""
    width = mask.shape[1]
    share = float(mask.mean())
    rim = np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])
    across = (mask[:, 0].any() and mask[:, -1].any()) or (mask[0].any() and mask[-1].any())
    if share > _MOST_SHARE or float(rim.mean()) > _MOST_RIM or across:
        return (
            f"The click is on the background: what has its color covers {share:.0%} of the frame. "
            "Click the object itself, or lower the tolerance."
        )
    if float(mask.sum()) < smallest * (width / _WORK_PX) ** 2:
        return (
            "What was clicked is too small to read light from. Raise the tolerance, go nearer, or "
            "click another object."
        )
    return ""
