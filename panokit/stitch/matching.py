"""Where photos with unknown poses look: features, matches and bundle adjustment by OpenCV.

SIFT features, matches between all pairs, the largest group of photos that match with
confidence, and a bundle adjustment of their rotations and focal lengths about one center
(Brown and Lowe 2007, "Automatic panoramic image stitching using invariant features"). What
comes out are views with poses, for `stitch_views`; their common heading is not known, and up
is the mean of the photos' own.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.capture import View
from panokit.errors import ImageError
from panokit.frames import Rotation
from panokit.stitch.layout import reposed

# A lower confidence lets false matches in, which bend everything (OpenCV's own default is 1).
_CONFIDENCE, _MATCH_SHARE = 1.0, 0.3
_FEATURE_PX = 1000
_LEAST_FEATURES, _LEAST_INLIERS = 8, 20
# cv2's camera looks along +Z with +Y down, ours along -Z with +Y up.
_FLIP = Rotation(np.diag([1.0, -1.0, -1.0]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Matched:
    """Photos whose poses were found.

    Attributes:
        views: Of the photos that match, in the order given.
        kept: Their numbers among all photos.
        left_out: Names of the others.
    """

    views: tuple[View, ...]
    kept: tuple[int, ...]
    left_out: tuple[str, ...]


def match_photos(photos: Sequence[NDArray[np.uint8]], names: Sequence[str]) -> Matched:
    """Find where overlapping photos from one place look.

    Raises:
        ImageError: If there is only one ("one-view"), or fewer than two match
            ("too-few-matches").
    """
    if len(photos) < 2:
        raise ImageError(
            "One photo alone has nothing to match with. Add those that overlap it, or write "
            "its heading, pitch and field of view into the views' file.",
            reason="one-view",
        )
    found = [_features(photo) for photo in photos]
    rich = [i for i, f in enumerate(found) if len(f.getKeypoints()) >= _LEAST_FEATURES]
    kept: list[int] = []
    if len(rich) >= 2:
        # The matcher fails on a photo without features, so they stay outside.
        some = [found[i] for i in rich]
        pairs = _pairs(some)
        linked = _linked(pairs, len(some))
        kept = [rich[i] for i in linked]
    if len(kept) < 2:
        counts = ", ".join(
            f"{n}: {len(f.getKeypoints())}" for n, f in zip(names, found, strict=True)
        )
        raise ImageError(
            f"None of the {len(photos)} photos match with confidence (features {counts}). They "
            "must overlap by a third and show more than sky or plain walls; where poses are "
            "known, give them.",
            reason="too-few-matches",
            values={"photos": len(photos)},
        )
    views = _adjusted(photos, names, found, kept)
    left_out = tuple(name for i, name in enumerate(names) if i not in kept)
    return Matched(views=views, kept=tuple(kept), left_out=left_out)


def _scale(photo: NDArray[np.uint8]) -> float:
    return min(1.0, _FEATURE_PX / max(photo.shape[:2]))


def _features(photo: NDArray[np.uint8]) -> "cv2.detail.ImageFeatures":
    scale = _scale(photo)
    small = cv2.resize(photo, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    sift = cv2.SIFT_create(2000)  # type: ignore[attr-defined]
    return cv2.detail.computeImageFeatures2(sift, small)


def _pairs(found: Sequence["cv2.detail.ImageFeatures"]) -> list["cv2.detail.MatchesInfo"]:
    for number, one in enumerate(found):
        one.img_idx = number
    matcher = cv2.detail.BestOf2NearestMatcher(False, _MATCH_SHARE)
    pairs = list(matcher.apply2(found))
    matcher.collectGarbage()
    for pair in pairs:
        # OpenCV takes a confidence above 3 for two copies of one picture and makes it 0, which
        # loses photos that overlap by two thirds.
        if pair.confidence == 0 and pair.num_inliers > _LEAST_INLIERS:
            matches = len(pair.getMatches())
            pair.confidence = min(pair.num_inliers / (8 + 0.3 * matches), 3.0)
    return pairs


def _linked(pairs: Sequence["cv2.detail.MatchesInfo"], count: int) -> list[int]:
    """The largest group of photos in which each matches another with confidence."""
    group = list(range(count))
    for pair in pairs:
        first, second = pair.src_img_idx, pair.dst_img_idx
        if first >= 0 and second >= 0 and pair.confidence > _CONFIDENCE:
            old, new = group[second], group[first]
            group = [new if g == old else g for g in group]
    largest = max(set(group), key=lambda g: (group.count(g), -g))
    return [i for i in range(count) if group[i] == largest] if group.count(largest) > 1 else []


def _adjusted(
    photos: Sequence[NDArray[np.uint8]],
    names: Sequence[str],
    found: Sequence["cv2.detail.ImageFeatures"],
    kept: Sequence[int],
) -> tuple[View, ...]:
    some = [found[i] for i in kept]
    pairs = _pairs(some)
    estimator = cv2.detail_HomographyBasedEstimator()  # type: ignore[attr-defined]
    good, cameras = estimator.apply(some, pairs, None)
    if good:
        for camera in cameras:
            camera.R = camera.R.astype(np.float32)
        adjuster = cv2.detail_BundleAdjusterRay()  # type: ignore[attr-defined]
        adjuster.setConfThresh(_CONFIDENCE)
        good, cameras = adjuster.apply(some, pairs, cameras)
    focal = [camera.focal for camera in cameras] if good else []
    if not good or not np.all(np.isfinite(focal)) or min(focal) <= 0:
        raise ImageError(
            f"The poses of {len(kept)} matching photos contradict each other. Were they taken "
            "from one place, without zooming?",
            reason="too-few-matches",
            values={"photos": len(photos)},
        )
    turns = cv2.detail.waveCorrect(
        [np.asarray(camera.R, np.float32) for camera in cameras], cv2.detail.WAVE_CORRECT_HORIZ
    )
    views = []
    middle = turns[len(turns) // 2]
    forward = _FLIP.apply(np.asarray(middle, np.float64) @ np.array([0.0, 0, 1]))
    heading = float(np.arctan2(forward[0], -forward[2]))
    facing = Rotation.from_heading_pitch_roll(-heading)
    for number, camera, turn in zip(kept, cameras, turns, strict=True):
        photo = photos[number]
        height, width = photo.shape[:2]
        u, _, v = np.linalg.svd(np.asarray(turn, np.float64))
        pose = facing @ _FLIP @ Rotation(u @ v) @ _FLIP
        fov = 2 * np.arctan(width * _scale(photo) / 2 / camera.focal)
        plain = View(name=names[number], heading_deg=0.0, pitch_deg=0.0,
                     fov_deg=float(np.rad2deg(fov)), width_px=width, height_px=height)  # fmt: skip
        views.append(reposed(plain, pose))
    return tuple(views)
