"""What belongs to one open tab: its folder, its files, and what it may fetch.

No tab sees another's.

A tab's address holds a random token. What is published under it has a random name too, so that
pages can be told to fetch it, and everything goes when the tab is closed.
"""

import secrets
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from panokit.app.settings import AppSettings
from panokit.app.uploads import Inbox
from panokit.errors import UsageError

# What the folder of all tabs is called in the system's temporary folder, before its random part.
TAB_FOLDERS = "panokit-app-"
Provider = Callable[[str], bytes]


@dataclass(frozen=True, slots=True, kw_only=True)
class Published:
    """Something that the browser may fetch.

    Attributes:
        content: A file, or bytes.
        media_type: Of it.
        filename: Under which the browser stores it; "" for what it shows.
    """

    content: Path | bytes
    media_type: str
    filename: str = ""


@dataclass(slots=True, kw_only=True)
class Desk:
    """One tab's things.

    Attributes:
        token: Its name in addresses.
        folder: Its own, removed with it.
        inbox: What the browser sends.
        published: Key -> what the browser may fetch.
        pictures: Kind -> the function that makes a JPEG or PNG by its name, such as a frame.
    """

    token: str
    folder: Path
    inbox: Inbox
    published: dict[str, Published] = field(default_factory=dict)
    pictures: dict[str, Provider] = field(default_factory=dict)

    def publish(
        self, content: Path | bytes, media_type: str, *, filename: str = "", key: str = ""
    ) -> str:
        """Let the browser fetch something; its address.

        Args:
            content: A file, or bytes.
            media_type: Of it.
            filename: To offer it as a download.
            key: To replace what was published under it before; a new address each time all the
                same, so that no browser shows the old one.
        """
        if key:
            self.withdraw(key)
        name = f"{key}.{secrets.token_urlsafe(9)}" if key else secrets.token_urlsafe(12)
        self.published[name] = Published(content=content, media_type=media_type, filename=filename)
        return f"/desk/{self.token}/thing/{name}"

    def withdraw(self, key: str) -> None:
        """Take back what was published under a key."""
        for name in [name for name in self.published if name.split(".")[0] == key]:
            del self.published[name]

    def picture(self, kind: str, name: str) -> bytes:
        """A picture by its kind and name.

        Raises:
            UsageError: If there is no such kind.
        """
        provider = self.pictures.get(kind)
        if provider is None:
            raise UsageError(f"There are no pictures of the kind {kind!r}.")
        return provider(name)

    def room(self, name: str) -> Path:
        """An empty folder of this tab's own for one purpose."""
        room = self.folder / name
        shutil.rmtree(room, ignore_errors=True)
        room.mkdir(parents=True)
        return room

    def clear(self) -> None:
        """Remove everything."""
        self.published.clear()
        self.pictures.clear()
        shutil.rmtree(self.folder, ignore_errors=True)


class Desks:
    """All open tabs.

    Args:
        settings: With the limits of uploads.
        root: The folder for their folders; a temporary one if not given.
    """

    def __init__(self, settings: AppSettings, root: Path | None = None) -> None:
        self.settings = settings
        self._root = root or Path(tempfile.mkdtemp(prefix=TAB_FOLDERS))
        self._desks: dict[str, Desk] = {}

    def __len__(self) -> int:
        return len(self._desks)

    def open(self) -> Desk:
        """A desk for a new tab."""
        token = secrets.token_urlsafe(18)
        folder = self._root / secrets.token_hex(8)
        inbox = folder / "inbox"
        inbox.mkdir(parents=True)
        limits = self.settings
        desk = Desk(
            token=token,
            folder=folder,
            inbox=Inbox(
                folder=inbox,
                largest_picture_mb=limits.largest_picture_mb,
                largest_video_mb=limits.largest_video_mb,
                most_files=limits.most_files,
            ),
        )
        self._desks[token] = desk
        return desk

    def find(self, token: str) -> Desk | None:
        """The desk of a token, or None where there is none."""
        return self._desks.get(token)

    def close(self, desk: Desk) -> None:
        """Remove a tab's things."""
        self._desks.pop(desk.token, None)
        desk.clear()

    def close_all(self) -> None:
        """Remove everything, at the end."""
        for desk in list(self._desks.values()):
            self.close(desk)
        shutil.rmtree(self._root, ignore_errors=True)
