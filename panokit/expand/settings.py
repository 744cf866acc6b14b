"""Settings of the stage `expand`."""

from typing import Literal

from pydantic import Field, model_validator

from panokit.settings import Settings

VERSION = "4"

ANCHORS = ("anchor_white_cd_m2", "anchor_sky_cd_m2", "anchor_sun_lx", "anchor_sun_w_m2")


class ExpandSettings(Settings):
    """How an LDR panorama becomes an HDR environment map."""

    model: str = "expand-2"
    """A released model, or an analytic method: "srgb", "reinhard" or "area"."""

    width_px: int = Field(default=1024, ge=16, multiple_of=2)
    """Width of the map; a panorama narrower than this keeps its own width."""

    # Where it is computed is no part of what is computed, so the digest leaves it out.
    device: Literal["auto", "cpu", "cuda"] = Field(default="auto", exclude=True)
    """Where the network runs: "cuda" is an NVIDIA GPU; "auto" takes it if ONNX Runtime can."""

    anchor_white_cd_m2: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    """Luminance at which the picture clipped; the map is then in cd/m2. Without any anchor a
    radiance of 1 is where the picture clipped."""

    anchor_sky_cd_m2: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    """Mean luminance of the sky without its lights; the map is then in cd/m2."""

    anchor_sun_lx: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    """Illuminance by the sun of a surface that faces it; the map is then in cd/m2."""

    anchor_sun_w_m2: float | None = Field(default=None, gt=0, allow_inf_nan=False)
    """Irradiance by the sun of a surface that faces it; the map is then in W/(sr m2)."""

    harmonics_order: int = Field(default=2, ge=0, le=4)
    """Highest degree of the spherical harmonics in the record: 2 is enough for matte surfaces."""

    most_lights: int = Field(default=8, ge=0, le=64)
    """How many light sources the record lists, strongest first."""

    compare: bool = False
    """Also write the analytic methods' maps and a picture of all side by side, to
    NAME.compare."""

    @model_validator(mode="after")
    def _one_anchor(self) -> "ExpandSettings":
        given = [name for name in ANCHORS if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"only one anchor can be given, not {' and '.join(given)}")
        return self
