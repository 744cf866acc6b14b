"""What is going on: the steps of a longer work, one after the other, and errors in words."""

import asyncio
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress

from nicegui import ui

from panokit.app.widgets import box, say, words
from panokit.app.work import in_words

_TICK_S = 0.5


class Progress:
    """A place in the page for the steps of a work, and for what went wrong with it.

    While one work is going on the next is not begun; `busy` tells.
    """

    def __init__(self) -> None:
        self.busy = False
        self._place = box("progress")
        self._place.props["aria-live"] = "polite"
        self._line: ui.html | None = None
        self._begun = 0.0
        self._text = ""
        self._share: float | None = None

    def step(self, text: str, share: float | None = None) -> None:
        """Tell of the next step; with a share from 0 to 1 if that is known."""
        self._text, self._begun, self._share = text, time.monotonic(), share
        self._place.clear()
        with self._place, box("step"):
            self._line = words("span", text + " …", "step-text")
            self._bar = ui.element("progress")
            self._bar.props["aria-label"] = text
            if share is not None:
                self._bar.props["value"] = share

    def at(self, share: float, text: str = "") -> None:
        """Move the bar of the step."""
        self._share = share
        self._bar.props["value"] = round(share, 3)
        self._bar.update()
        if text:
            self._text = text

    def fail(self, text: str) -> None:
        """Tell what went wrong and what to do."""
        self._place.clear()
        with self._place:
            words("p", text, "notice fail").props('role="alert"')

    def clear(self) -> None:
        """Nothing is going on."""
        self._place.clear()
        self._line = None

    async def run(self, work: Callable[[], Awaitable[None]], first: str) -> bool:
        """Do a work with its steps shown; whether it went well.

        Args:
            work: It calls `step` as it goes.
            first: What its first step is called.
        """
        if self.busy:
            return False
        self.busy = True
        self.step(first)
        ticking = asyncio.create_task(self._tick())
        try:
            await work()
        except Exception as error:
            # Whatever it is, the tab goes on and its user is told.
            self.fail(in_words(error))
            return False
        else:
            self.clear()
            return True
        finally:
            self.busy = False
            ticking.cancel()
            with suppress(asyncio.CancelledError):
                await ticking

    async def _tick(self) -> None:
        """The seconds that a step takes, once it takes longer than one."""
        while True:
            await asyncio.sleep(_TICK_S)
            seconds = time.monotonic() - self._begun
            if self._line is not None and seconds > 1:
                say(self._line, f"{self._text} … {seconds:.0f} s")
