"""Settings of `panokit app`; imports nothing heavy."""

from pathlib import Path

from pydantic import Field

from panokit.expand.settings import ExpandSettings
from panokit.settings import Settings

HOST = "127.0.0.1"


class AppSettings(Settings):
    """What the local web application offers, and what it takes."""

    port: int = Field(default=8710, ge=1024, le=65535)
    """Where it listens on 127.0.0.1; if another program is there, the next free port is taken."""

    library: Path | None = None
    """The probe library to show; another can be opened in the application."""

    model: str = ExpandSettings().model
    """The expansion method that is chosen at first: a released model, or srgb, reinhard or area."""

    lighting_model: str | None = None
    """The model that reads light from a video: a released one, or a folder of your own. If not
    given, the one that `panokit lighting` uses, or another that is installed."""

    largest_picture_mb: int = Field(default=200, ge=1)
    """Largest picture that may be dropped into the application."""

    largest_video_mb: int = Field(default=4000, ge=1)
    """Largest video that may be dropped; longer ones are opened by their path, without a copy."""

    most_files: int = Field(default=2000, ge=1)
    """Most files of one tab, for folders of frames."""
