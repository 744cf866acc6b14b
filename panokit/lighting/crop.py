"""The virtual camera that crops two frames alike, and what it sees of them; see `snapshots`."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.color import srgb_decode_u8, srgb_encode_u8
from panokit.frames import Rotation
from panokit.lighting.background import behind_object
from panokit.lighting.select import Box, Mask
from panokit.lighting.settings import SnapshotSettings
from panokit.lighting.video import Picture
from panokit.stereo import Views

# Left free at the edges of the view, in parts of its width.
_MARGIN = 0.02
# Image axes (right, down, forward) from camera axes (right, up, back).
_IMAGE_FROM_CAMERA = np.diag([1.0, -1.0, -1.0])
# Around the object so much of the view is not believed to be background.
_RIM = 0.02
# Views are made up to so many times as large and then averaged down.
_MOST_OVERSIZE = 3
_SOFT_EDGE_PX = 0.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Crop:
    """What a virtual camera sees of a frame.

    Attributes:
        linear: (N, N, 3) float32 linear radiance; the frame's edge goes on beyond it.
        coverage: (N, N) float32, how much of each pixel the object covers.
        inside: (N, N) bool, what is in the frame.
    """

    linear: NDArray[np.float32]
    coverage: NDArray[np.float32]
    inside: Mask


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VirtualCamera:
    """Looks at the middle between the object's two places, as narrow as shows it large.

    Attributes:
        video_from_view: From its frame to that of the video's camera.
        video_focal_px: Of the video's camera.
        focal_px: Its own.
        size_px: Width and height of what it sees.
        middle_row: Of the video, on which it has the object in both frames.
        shift: How far the object moved sideways, in parts of its larger side.
        level_from_view: From its frame to a level one that looks the same way.
    """

    video_from_view: Rotation
    video_focal_px: float
    focal_px: float
    size_px: int
    middle_row: float
    shift: float
    level_from_view: Rotation

    @property
    def fov_deg(self) -> float:
        """From its left to its right edge."""
        return float(np.rad2deg(2 * np.arctan(self.size_px / 2 / self.focal_px)))

    def see(self, picture: Picture, mask: Mask, row: float) -> Crop:
        """What it sees of a frame whose object's middle lies on `row`."""
        height, width = mask.shape
        finer = int(np.clip(np.ceil(self.video_focal_px / self.focal_px), 1, _MOST_OVERSIZE))
        size = self.size_px * finer
        turned = _IMAGE_FROM_CAMERA @ self.video_from_view.matrix @ _IMAGE_FROM_CAMERA
        # Middles of pixels lie at whole numbers for OpenCV. The rows are brought together.
        down = row - self.middle_row
        video = _intrinsics(self.video_focal_px, width / 2 - 0.5, height / 2 - 0.5 + down)
        view = _intrinsics(self.focal_px * finer, size / 2 - 0.5, size / 2 - 0.5)
        video_from_view = video @ turned @ np.linalg.inv(view)
        # Only what is seen is converted: of a 4K frame that is little.
        left, top, right, bottom = _window(video_from_view, size, width, height)
        part = picture[top:bottom, left:right]
        inner = mask[top:bottom, left:right]
        shrink = min(1.0, finer * self.focal_px / self.video_focal_px)
        shape = (max(1, round(part.shape[1] * shrink)), max(1, round(part.shape[0] * shrink)))
        part_from_video = np.array(
            [[shape[0] / part.shape[1], 0, 0], [0, shape[1] / part.shape[0], 0], [0, 0, 1]]
        ) @ np.array([[1, 0, 0.5 - left], [0, 1, 0.5 - top], [0, 0, 1]])
        part_from_view = np.array([[1, 0, -0.5], [0, 1, -0.5], [0, 0, 1]]) @ (
            part_from_video @ video_from_view
        )

        def seen(values: NDArray[np.float32], border: int) -> NDArray[np.float32]:
            if shrink < 1:
                values = np.asarray(cv2.resize(values, shape, interpolation=cv2.INTER_AREA))
            warped = cv2.warpPerspective(
                values, part_from_view, (size, size),
                flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=border,
            )  # fmt: skip
            small = (self.size_px, self.size_px)
            return np.asarray(cv2.resize(warped, small, interpolation=cv2.INTER_AREA), np.float32)

        return Crop(
            linear=seen(srgb_decode_u8(part), cv2.BORDER_REPLICATE),
            coverage=np.clip(seen(_soft(inner), cv2.BORDER_CONSTANT), 0, 1),
            inside=seen(np.ones(inner.shape, np.float32), cv2.BORDER_CONSTANT) > 0.99,
        )

    def views(self, left: Crop, right: Crop, blur: float) -> Views:
        """The views of what it saw of two frames."""
        rim = max(1, round(_RIM * self.size_px))
        disk = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * rim + 1, 2 * rim + 1))
        pictures, objects, backgrounds = [], [], []
        for crop in (left, right):
            near = cv2.dilate((crop.coverage > 0).astype(np.uint8), disk)
            behind = behind_object(crop.linear, crop.inside & (near == 0), blur)
            alone = crop.linear * crop.coverage[..., None]
            pictures.append(srgb_encode_u8(alone + (1 - crop.coverage[..., None]) * behind))
            objects.append(srgb_encode_u8(alone))
            backgrounds.append(srgb_encode_u8(behind))
        mask = np.asarray(left.coverage > 0.5)
        return Views(
            left=pictures[0], right=pictures[1],
            left_object=objects[0], right_object=objects[1],
            mask=mask, background=backgrounds[0],
            normals=np.zeros((*mask.shape, 3), np.float32), parts=mask.astype(np.uint8),
            fov_deg=self.fov_deg, baseline_m=self.shift, left_level=self.level_from_view,
        )  # fmt: skip


def camera_for(
    size_px: tuple[int, int], left: Box, right: Box, settings: SnapshotSettings
) -> VirtualCamera:
    """The virtual camera for an object that is in two boxes in frames of this size."""
    width, height = size_px
    focal = width / 2 / np.tan(np.deg2rad(settings.fov_deg) / 2)
    column, row = (np.mean([box.center[k] for box in (left, right)]) for k in range(2))
    right_by, up_by = (column - width / 2) / focal, (height / 2 - row) / focal
    turn = Rotation.from_heading_pitch_roll(
        float(np.arctan(right_by)), float(np.arctan2(up_by, np.hypot(1.0, right_by))), 0.0
    )
    extent = max(left.longest, right.longest)
    moved = abs(left.center[0] - right.center[0])
    # Wide enough that the object is whole in both.
    wide = max(left.width, right.width) + moved
    fill = min(settings.fill, (1 - 2 * _MARGIN) * extent / max(wide, extent))
    level = Rotation.from_heading_pitch_roll(
        0.0, float(np.deg2rad(settings.pitch_deg)), float(np.deg2rad(settings.roll_deg))
    )
    _, pitch, roll = (level @ turn).heading_pitch_roll()
    return VirtualCamera(
        video_from_view=turn,
        video_focal_px=float(focal),
        focal_px=float(focal * fill * settings.size_px / extent),
        size_px=settings.size_px,
        middle_row=float(row),
        shift=float(moved / extent),
        level_from_view=Rotation.from_heading_pitch_roll(0.0, pitch, roll),
    )


def _window(
    video_from_view: NDArray[np.float64], size: int, width: int, height: int
) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of what is seen of the frame, with two pixels to spare."""
    corners = np.array([[0, 0, 1], [size, 0, 1], [0, size, 1], [size, size, 1]], float)
    seen = corners @ video_from_view.T
    columns, rows = seen[:, 0] / seen[:, 2], seen[:, 1] / seen[:, 2]
    left = int(np.clip(np.floor(columns.min()) - 2, 0, width - 2))
    top = int(np.clip(np.floor(rows.min()) - 2, 0, height - 2))
    right = int(np.clip(np.ceil(columns.max()) + 3, left + 2, width))
    bottom = int(np.clip(np.ceil(rows.max()) + 3, top + 2, height))
    return left, top, right, bottom


def _soft(mask: Mask) -> NDArray[np.float32]:
    """A mask without the mixed pixels of its outline."""
    inner = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8))
    return np.asarray(cv2.GaussianBlur(inner.astype(np.float32), (0, 0), _SOFT_EDGE_PX))


def _intrinsics(focal_px: float, column: float, row: float) -> NDArray[np.float64]:
    return np.array([[focal_px, 0, column], [0, focal_px, row], [0, 0, 1]])
