"""Frames of a video or of a folder of pictures, read when they are asked for.

Nothing is kept but the place that was read last: an hour of 4K takes the memory of one frame.
"""

import re
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, UsageError
from panokit.io.files import storage_error
from panokit.io.images import LDR_SUFFIXES, decode_image

Picture = NDArray[np.uint8]
# Reading on is cheaper than seeking, up to about the distance between two whole frames.
_READ_ON = 48
_CODECS = {
    "av01": "AV1", "avc1": "H.264", "h264": "H.264", "hev1": "H.265", "hvc1": "H.265",
    "hevc": "H.265", "vp08": "VP8", "vp80": "VP8", "vp09": "VP9", "vp90": "VP9", "fmp4": "MPEG-4",
    "mp4v": "MPEG-4", "mjpg": "Motion JPEG", "apch": "ProRes", "apcn": "ProRes",
}  # fmt: skip


class Frames(Protocol):
    """Pictures of one size, one after the other.

    Attributes:
        name: For messages.
        count: How many there are. Of a video it is what the file says, and may be a few off.
        fps: Frames per second, or 0 where nobody says.
        size_px: Width and height.
    """

    name: str
    count: int
    fps: float
    size_px: tuple[int, int]

    def frame(self, number: int) -> Picture:
        """Frame `number`, from 0: (H, W, 3) uint8 RGB.

        Raises:
            UsageError: If there is no such frame.
            ImageError: If it cannot be read.
        """
        ...

    def frames_from(self, number: int) -> Iterator[tuple[int, Picture]]:
        """Frames in order with their numbers, up to the last that can be read."""
        ...


def open_frames(path: str | Path) -> Frames:
    """The frames of a video file, or of a folder of pictures in the order of their names.

    Raises:
        UsageError: If there is nothing at this path.
        ImageError: If it is no video, or not a single frame of it can be read.
    """
    path = Path(path)
    if path.is_dir():
        return FolderFrames(path)
    if not path.is_file():
        raise UsageError(f"There is no video {path}. Name a video file or a folder of pictures.")
    return VideoFrames(path)


def smaller(picture: Picture, width_px: int) -> tuple[Picture, float]:
    """A picture of at most this width, and by how much it was scaled, at most 1."""
    height, width = picture.shape[:2]
    scale = width_px / width
    if scale >= 1:
        return picture, 1.0
    size = (width_px, max(1, round(height * scale)))
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8), scale


class VideoFrames:
    """The frames of a video file; see `open_frames`. May be used from several threads."""

    def __init__(self, path: Path) -> None:
        self.path, self.name = path, path.name
        # One thread of the decoder's own; it would take a frame's memory for each.
        self._video = cv2.VideoCapture(str(path), cv2.CAP_FFMPEG)
        self._lock = threading.Lock()
        self._next = 0
        if not self._video.isOpened():
            raise _no_video(path)
        first = self._read()
        if first is None:
            raise ImageError(
                f"{self.name}: not one frame can be read; its codec is {self.codec}. Re-encode it "
                f"to H.264: ffmpeg -i {self.name} -c:v libx264 -pix_fmt yuv420p out.mp4",
                reason="no-frames",
                values={"codec": self.codec},
            )
        self.size_px = (first.shape[1], first.shape[0])
        said = self._video.get(cv2.CAP_PROP_FRAME_COUNT)
        self.count = max(1, int(said)) if np.isfinite(said) else 1
        fps = self._video.get(cv2.CAP_PROP_FPS)
        self.fps = float(fps) if np.isfinite(fps) and 0 < fps < 1000 else 0.0

    @property
    def codec(self) -> str:
        """What the frames are encoded with, as people call it."""
        number = int(self._video.get(cv2.CAP_PROP_FOURCC))
        letters = "".join(chr((number >> 8 * k) & 255) for k in range(4))
        readable = re.sub(r"[^ -~]", "", letters).strip()
        return _CODECS.get(readable.lower(), f"{readable!r}" if readable else "not known")

    def frame(self, number: int) -> Picture:
        """See `Frames`."""
        if number < 0:
            raise UsageError(f"{self.name} has no frame {number}; frames count from 0.")
        with self._lock:
            picture = self._at(number)
        if picture is None:
            raise (
                UsageError(f"{self.name} has {self.count} frames, from 0; there is no {number}.")
                if number >= self.count
                else ImageError(
                    f"Frame {number} of {self.name} cannot be read. Re-encode the video to H.264, "
                    "or choose another frame.",
                    reason="damaged-frame",
                )
            )
        return picture

    def frames_from(self, number: int) -> Iterator[tuple[int, Picture]]:
        """See `Frames`."""
        while True:
            with self._lock:
                picture = self._at(number)
            if picture is None:
                return
            yield number, picture
            number += 1

    def close(self) -> None:
        """Let go of the file."""
        with self._lock:
            self._video.release()

    def _at(self, number: int) -> Picture | None:
        if not self._next <= number <= self._next + _READ_ON:
            self._video.set(cv2.CAP_PROP_POS_FRAMES, number)
            self._next = number
        while self._next < number:
            if not self._video.grab():
                self._next = -_READ_ON - 1  # wherever it is: seek next time
                return None
            self._next += 1
        return self._read()

    def _read(self) -> Picture | None:
        there, picture = self._video.read()
        if not there or picture is None or picture.ndim != 3:
            self._next = -_READ_ON - 1
            return None
        self._next += 1
        return np.ascontiguousarray(picture[..., ::-1])


class FolderFrames:
    """The pictures of a folder, in the order of the numbers in their names."""

    def __init__(self, folder: Path) -> None:
        self.name, self.fps = folder.name, 0.0
        try:
            found = [p for p in folder.iterdir() if p.suffix.lower() in LDR_SUFFIXES]
        except OSError as error:
            raise storage_error("read", folder, error) from error
        self._paths = sorted(found, key=_by_number)
        if not self._paths:
            raise ImageError(
                f"{folder} holds no pictures. Frames are {', '.join(LDR_SUFFIXES)} files; videos "
                "are named themselves.",
                reason="no-frames",
            )
        self.count = len(self._paths)
        height, width = self._decoded(self._paths[0]).shape[:2]
        self.size_px = (width, height)

    def frame(self, number: int) -> Picture:
        """See `Frames`."""
        if not 0 <= number < self.count:
            raise UsageError(f"{self.name} has {self.count} frames, from 0; there is no {number}.")
        picture = self._decoded(self._paths[number])
        if (picture.shape[1], picture.shape[0]) != self.size_px:
            raise ImageError(
                f"{self._paths[number].name} is {picture.shape[1]}x{picture.shape[0]}, the first "
                f"frame {self.size_px[0]}x{self.size_px[1]}. Give frames of one camera.",
                reason="other-size",
            )
        return picture

    def frames_from(self, number: int) -> Iterator[tuple[int, Picture]]:
        """See `Frames`."""
        for at in range(max(number, 0), self.count):
            yield at, self.frame(at)

    def _decoded(self, path: Path) -> Picture:
        try:
            return decode_image(path.read_bytes(), what=path.name)
        except OSError as error:
            raise storage_error("read", path, error) from error


def _by_number(path: Path) -> tuple[list[tuple[int, str]], str]:
    """frame2 before frame10."""
    parts = re.split(r"(\d+)", path.stem)
    return [(int(p), "") if p.isdigit() else (-1, p) for p in parts], path.suffix


def _no_video(path: Path) -> ImageError:
    try:
        with path.open("rb") as file:
            start = file.read(8).hex(" ") or "nothing: it is empty"
    except OSError as error:
        raise storage_error("read", path, error) from error
    return ImageError(
        f"{path.name} is no video that can be opened (it begins with {start}). Name an MP4, MOV, "
        "MKV, WebM or AVI file, or a folder of pictures; re-encode to H.264 what other programs "
        "play.",
        reason="not-a-video",
    )
