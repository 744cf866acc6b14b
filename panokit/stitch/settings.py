"""The settings of `stitch`."""

from typing import Any, Literal

from pydantic import Field, field_validator

from panokit.settings import Settings

VERSION = "2"


class StitchSettings(Settings):
    """How stored tiles, views or photos become a panorama."""

    width_px: int | None = Field(default=4096, ge=16)
    """Width of the result; a smaller picture stays as it is. "none" keeps the native size."""

    level: bool = True
    """Turn the picture level and north to its center."""

    upright: Literal["auto", "metadata", "picture"] = "auto"
    """Where pitch and roll come from: the metadata, the picture's own vertical lines, or
    whichever is to be trusted more."""

    deblock: bool = False
    """Soften the step between two tiles by one pixel on either side."""

    blend: Literal["feather", "bands"] = "feather"
    """How views are laid over one another: a weighted mean, or the best view with seams that
    are as wide as the detail is (Laplacian bands)."""

    exposure: bool = True
    """Even out the exposure and vignetting of views."""

    refine: Literal["auto", "always", "none"] = "auto"
    """Improve the poses of views: where they overlap, always, or never."""

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
