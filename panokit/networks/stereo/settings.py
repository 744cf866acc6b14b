"""Which stereo network: the choices that the 2018 thesis compares, and those beyond it."""

from typing import Literal

from pydantic import Field, model_validator

from panokit.settings import Settings

ENCODER_BLOCKS = 3
# The decoder starts from no more: fusion narrows views of up to 512 pixels down to that.
_LEAST_MAP_PX = 8


class StereoNetSettings(Settings):
    """A network from two views (and perhaps the background) to an environment map."""

    fusion: Literal["concat", "similarity"] = "similarity"
    """Whether the two views' features are only put side by side, or compared too."""

    weights: Literal["unshared", "shared", "copy-left"] = "shared"
    """Whether both views go through one encoder. "copy-left" trains it on the left view alone,
    as the thesis did."""

    background: Literal["composited", "none", "branch"] = "branch"
    """Whether the object is seen on its background, on zero, or on zero with the background in
    an encoder of its own."""

    similarity: Literal["pointwise", "epipolar", "row", "full"] = "epipolar"
    """What is compared: the same place, places along the row within reach, all of the row, or
    all places."""

    reach: int = Field(default=4, ge=0)
    """How many features to either side "epipolar" compares."""

    pyramid: bool = False
    """Whether the views are compared after each block of the encoder, not only after the last."""

    multi_scale: bool = False
    """Whether early features go to the decoder too."""

    layers: int = Field(default=1, ge=1, le=5)
    """Convolutions in a block: 1 is the thesis's shallow network, 3 its deep one."""

    width: int = Field(default=32, ge=4)
    """Features after the first block; each block of the encoder doubles them."""

    input_px: int = Field(default=128, ge=16)
    """Width and height of the views, a power of two."""

    output_px: int = Field(default=64, ge=8)
    """Width and height of the map, a power of two."""

    wrap: bool = False
    """Whether the decoder's last convolutions close the map in azimuth."""

    coarser: int = Field(default=1, ge=1)
    """How many times smaller the decoder's map is than the output, which is interpolated: a
    network cannot paint in dots what scenes lit by it, or means over windows, do not tell apart."""

    window: bool = False
    """Whether the background goes where the map shows it, too; needs `fov_deg`."""

    fov_deg: float = Field(default=40.0, gt=0, lt=180)
    """Angle of view of the square pictures."""

    lights: int = Field(default=0, ge=0, le=8)
    """Lobes of light that a head adds to the decoder's map, which then has nothing brighter than
    `painted`: lights are lobes, and not pixels here and there."""

    painted: float = Field(default=4.0, gt=0)
    """The brightest radiance that the decoder paints where there are lobes; white is 1."""

    dropout: float = Field(default=0.0, ge=0, lt=1)
    """Share of fused features that are left out in training."""

    @model_validator(mode="after")
    def _fits(self) -> "StereoNetSettings":
        # Blocks halve and double sizes; from any other size they do not arrive at the map's.
        for name in ("input_px", "output_px"):
            if (size := getattr(self, name)) & (size - 1):
                raise ValueError(f"{name} is a power of two, such as 64 or 128, not {size}")
        if self.output_px % self.coarser or self.output_px // self.coarser < _LEAST_MAP_PX:
            raise ValueError(
                f"output_px is a multiple of coarser, and at least {_LEAST_MAP_PX} times as large"
            )
        if self.pyramid and self.fusion == "concat":
            raise ValueError('a pyramid of similarities needs fusion = "similarity"')
        return self
