"""Frames of a video as pictures, with what is selected in them."""

from collections.abc import Awaitable, Callable, Mapping
from typing import Any, Literal

from nicegui.element import Element

from panokit.app.reading import Stroke

Mode = Literal["look", "pick", "add", "remove"]
# Of a brush, in parts of the frame's width.
_BRUSH = 0.018
_MOST_POINTS = 5000


class Film(Element, component="assets/film.js"):
    """A player that can be clicked and drawn on; of one frame alone, a picture that can.

    Args:
        address: Of the frames' pictures; their numbers are appended.
        count: How many frames there are.
        size_px: Width and height of a frame.
        label: What it shows.
        fps: Frames per second, or 0 where nobody knows.
        start: The frame to begin with.
        mode: What a pointer does.
        hint_id: Of the element that says how it is used.
    """

    def __init__(
        self,
        address: str,
        count: int,
        size_px: tuple[int, int],
        label: str,
        *,
        fps: float = 0.0,
        start: int = 0,
        mode: Mode = "pick",
        hint_id: str = "",
    ) -> None:
        super().__init__()
        self.count, self.size_px = count, size_px
        self._props.update(
            {
                "address": address,
                "count": count,
                "width": size_px[0],
                "height": size_px[1],
                "label": label,
                "fps": fps,
                "start": start,
                "mode": mode,
                "hintId": hint_id,
                "mask": "",
                "maskFrame": -1,
                "boxes": {},
                "brush": _BRUSH,
            }
        )

    def on_pick(self, take: Callable[[int, float, float], Awaitable[None]]) -> None:
        """Call with frame, column and row when an object is clicked."""

        async def picked(event: Any) -> None:
            said = event.args
            await take(int(said["frame"]), float(said["x"]), float(said["y"]))

        self.on("pick", picked)

    def on_stroke(self, take: Callable[[Stroke], Awaitable[None]]) -> None:
        """Call with a line that was drawn over the mask."""

        async def drawn(event: Any) -> None:
            said = event.args
            points = tuple((float(x), float(y)) for x, y in said["points"][:_MOST_POINTS])
            await take(
                Stroke(points=points, radius_px=float(said["radius"]), adds=bool(said["adds"]))
            )

        self.on("stroke", drawn)

    def set_mode(self, mode: Mode) -> None:
        """What a pointer does from now on."""
        self._props["mode"] = mode
        self.update()

    def set_mask(self, address: str, frame: int) -> None:
        """Show a mask over one frame; none if the address is empty."""
        self._props["mask"] = address
        self._props["maskFrame"] = frame
        self.update()

    def set_boxes(self, boxes: Mapping[int, tuple[float, float, float, float, str]]) -> None:
        """Where the object is, frame by frame: left, top, width, height and "found" or "lost"."""
        self._props["boxes"] = {str(number): list(box) for number, box in boxes.items()}
        self.update()

    def show(self, frame: int) -> None:
        """Show a frame."""
        self.run_method("show", frame)
