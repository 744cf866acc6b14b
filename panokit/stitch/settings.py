"""The settings of `stitch`."""

from typing import Any

from pydantic import Field, field_validator

from panokit.settings import Settings

VERSION = "1"


class StitchSettings(Settings):
    """How stored tiles become a panorama."""

    width_px: int | None = Field(default=4096, ge=16)
    """Width of the result; a smaller picture stays as it is. "none" keeps the native size."""

    level: bool = True
    """Turn the picture level and north to its center, as far as its metadata tells."""

    @field_validator("width_px", mode="before")
    @classmethod
    def _none_as_text(cls, width_px: Any) -> Any:
        # Neither TOML nor a command line can say None.
        return None if width_px == "none" else width_px

    @field_validator("width_px")
    @classmethod
    def _even(cls, width_px: int | None) -> int | None:
        if width_px is not None and width_px % 2:
            raise ValueError(f"a panorama is twice as wide as high: {width_px} is odd")
        return width_px
