"""The settings of `inpaint`."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from panokit.settings import Settings

VERSION = "3"


class InpaintSettings(Settings):
    """Which holes are filled, and with what."""

    nadir_deg: Annotated[float, Field(gt=0, le=50)] | Literal["auto"] | None = "auto"
    """Fill the cap of this angular radius below the camera; "auto" fills one only where a cap
    is plainly there, "none" never does."""

    fill_black: bool = True
    """Fill large black rectangles: tiles that never came, bars of a grid of the wrong size."""

    fill_blurred_ground: bool = False
    """Fill ground that was blurred far beyond a cap, as in much street imagery; without, it is
    only reported."""

    watermark_tile_px: Annotated[int, Field(ge=64, le=4096)] | None = None
    """Look for a mark that is repeated at the same place in every tile of this size."""

    method: Literal[
        "texture", "smooth", "telea", "navier-stokes", "shift-map", "fsr", "network"
    ] = "texture"
    """What holes with detail around them are filled with: copies of that detail, or a smooth
    surface; then OpenCV's four; or a network of yours. With "texture", holes in a smooth sky
    and tiny ones are smooth all the same."""

    network: Path | None = None
    """An inpainting network as an .onnx file, for the method "network"."""

    rim_deg: float = Field(default=0.6, gt=0, le=5)
    """Width of the band outside a hole in which the filling fades into the picture."""

    @field_validator("nadir_deg", mode="before")
    @classmethod
    def _none_as_text(cls, nadir_deg: Any) -> Any:
        # Neither TOML nor a command line can say None.
        return None if nadir_deg == "none" else nadir_deg

    @model_validator(mode="after")
    def _network_and_its_method(self) -> "InpaintSettings":
        if (self.method == "network") != (self.network is not None):
            raise ValueError("method network and a network file go together: give both or neither")
        return self
