"""Where files are dropped or chosen."""

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from nicegui.element import Element

from panokit.app.desks import Desk
from panokit.app.routes import uploaded
from panokit.errors import PanokitError


class Drop(Element, component="assets/drop.js"):
    """A field for files; they are sent to the tab's inbox, with a bar.

    Args:
        desk: Of the tab.
        kind: "picture" or "video"; what a file alone may be.
        words: title, hint, button, and folderButton where folders of frames may be dropped too.
        on_file: Called with the file, or with the folder of frames, and its name.
        on_error: Called with what is wrong.
    """

    def __init__(
        self,
        desk: Desk,
        kind: str,
        words: dict[str, str],
        on_file: Callable[[Path, str], Awaitable[None]],
        on_error: Callable[[str], None],
    ) -> None:
        super().__init__()
        accept = {"picture": "image/*", "video": "video/*"}[kind]
        self._props.update(
            {
                "address": f"/desk/{desk.token}/upload",
                "kind": kind,
                "mostMegabytes": _limit(desk, kind),
                "accept": accept,
                **words,
                **({"folderKind": "frames"} if "folderButton" in words else {}),
            }
        )

        async def sent(event: Any) -> None:
            said = event.args
            try:
                path = uploaded(desk, said.get("file"))
            except PanokitError as error:
                on_error(str(error))
                return
            is_folder = bool(said.get("folder"))
            await on_file(path.parent if is_folder else path, str(said.get("name", path.name)))

        self.on("sent", sent)
        self.on("failed", lambda event: on_error(str(event.args)))


def _limit(desk: Desk, kind: str) -> int:
    inbox = desk.inbox
    return inbox.largest_video_mb if kind == "video" else inbox.largest_picture_mb
