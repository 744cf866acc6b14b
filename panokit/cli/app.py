"""`panokit app`: the local web application."""

from typing import Annotated

from cyclopts import Parameter

from panokit.app.settings import AppSettings
from panokit.console import Console


def app(
    *,
    settings: Annotated[AppSettings, Parameter(name="*")] = AppSettings(),
    show: Annotated[bool, Parameter(name="--show", negative="--no-show")] = True,
) -> int:
    """Open the application in the browser: lighting from a video, panoramas, the library.

    It answers to this machine alone, until it is ended with Ctrl-C.

    Parameters
    ----------
    show
        Open it in the browser; else only tell its address.
    """
    from panokit.app.server import serve

    console = Console()
    try:
        serve(
            settings,
            lambda address: console.result(f"panokit is at {address}  (Ctrl-C ends it)"),
            show=show,
        )
    except KeyboardInterrupt:
        # That is how it is ended.
        console.note("Ended; the files of its tabs are removed.")
    return 0
