"""Settings of the stage `expand`."""

from pydantic import Field

from panokit.settings import Settings

VERSION = "1"


class ExpandSettings(Settings):
    """How an LDR panorama becomes an HDR environment map."""

    model: str = "expand-1"
    """A released model, or an analytic method: "srgb", "reinhard" or "area"."""

    width_px: int = Field(default=1024, ge=16, multiple_of=2)
    """Width of the map; a panorama narrower than this keeps its own width."""
