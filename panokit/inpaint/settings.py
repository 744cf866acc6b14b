"""The settings of `inpaint`."""

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from panokit.settings import Settings

VERSION = "1"


class InpaintSettings(Settings):
    """Which holes are filled, and with what."""

    nadir_deg: Annotated[float, Field(gt=0, le=50)] | Literal["auto"] | None = "auto"
    """Fill the cap of this angular radius below the camera; "auto" fills one only where a cap
    is plainly there, "none" never does."""

    method: Literal["texture", "smooth"] = "texture"
    """What holes with detail around them are filled with: copies of that detail, or a smooth
    surface. Holes in a smooth sky and tiny ones are smooth either way."""

    rim_deg: float = Field(default=0.6, gt=0, le=5)
    """Width of the band outside a hole in which the filling fades into the picture."""

    @field_validator("nadir_deg", mode="before")
    @classmethod
    def _none_as_text(cls, nadir_deg: Any) -> Any:
        # Neither TOML nor a command line can say None.
        return None if nadir_deg == "none" else nadir_deg
