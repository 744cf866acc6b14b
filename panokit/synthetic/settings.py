"""Settings of the synthetic city and of the look-alike server."""

from typing import Literal

from pydantic import Field

from panokit.settings import Settings

VERSION = "2"


class CitySettings(Settings):
    """How panoramas of the synthetic city are rendered."""

    count: int = Field(default=8, ge=1)
    """How many panoramas to render."""
    seed: int = Field(default=1, ge=0)
    """Another seed gives another city; panorama i of a seed is always the same."""
    width_px: int = Field(default=2048, ge=16, le=16384, multiple_of=4)
    """Width of the pictures; they are half as high."""
    truth_width_px: int = Field(default=512, ge=16, le=4096, multiple_of=4)
    """Width of the true radiance maps."""
    samples: int = Field(default=12, ge=1, le=4096)
    """Light paths through each pixel of a picture."""
    truth_samples: int = Field(default=64, ge=1, le=4096)
    """Light paths through each pixel of a truth, which is rendered at twice its width."""
    denoise: bool = True
    """Clean up what the light paths leave noisy."""
    weather: Literal["mixed", "clear", "cloudy", "overcast", "night"] = "mixed"
    """The same weather for all, or half sun, a quarter overcast and a quarter night."""
    jpeg_quality: int = Field(default=88, ge=50, le=100)
    """Of the pictures."""


class ServeSettings(Settings):
    """How the look-alike server behaves."""

    port: int = Field(default=8765, ge=0, le=65535)
    """To listen on, at 127.0.0.1; 0 takes a free one."""
    key: str = "panokit"
    """The Google API key that the look-alike accepts."""
    token: str = "MLY|panokit"
    """The Mapillary token that it accepts."""
    faults: str = ""
    """What to do wrong: "429 10% delay=1, 500 5%, slow 1%, session-uses=300, seed=7"."""
