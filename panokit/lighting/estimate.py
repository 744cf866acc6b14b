"""What is read of the light: a map, how sure it is, and what to mind."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import Anchor, EnvironmentMap
from panokit.equirectangular import read_only
from panokit.errors import ImageError
from panokit.frames import Frame, Rotation
from panokit.lighting.confidence import Confidence
from panokit.lighting.representations import latlong_radiance
from panokit.provenance import Provenance

TARGET_PX = 64
LATLONG_PX = 256


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LightEstimate:
    """The light of a scene as it was read.

    Attributes:
        radiance: (64, 64, 3) float32 linear radiance, at least 0, read-only: a lat-long map twice
            as fine in elevation as in azimuth, in the left camera's frame (center forward, +Y
            up). 1.0 is the white of the pictures.
        level_from_camera: Turns the camera's frame into a level one that looks the same way; the
            identity where the pose is not known.
        confidence: How sure it is, or None where that was not asked for.
        warnings: What to mind, a sentence each.
        model: What read it: the id of a model.
        provenance: How.
    """

    radiance: NDArray[np.float32]
    level_from_camera: Rotation
    confidence: Confidence | None = None
    warnings: tuple[str, ...] = ()
    model: str = ""
    provenance: Provenance = field(default_factory=Provenance)

    def __post_init__(self) -> None:
        radiance = read_only(np.asarray(self.radiance, np.float32))
        if radiance.shape != (TARGET_PX, TARGET_PX, 3):
            raise ImageError(
                f"An estimate is ({TARGET_PX}, {TARGET_PX}, 3), not {radiance.shape}.",
                reason="wrong-shape",
            )
        if not np.isfinite(radiance).all() or radiance.min() < 0:
            raise ImageError(
                "The radiance of an estimate is finite and at least 0; this is not.",
                reason="not-physical",
            )
        object.__setattr__(self, "radiance", radiance)

    @property
    def envmap(self) -> EnvironmentMap:
        """The same light as a 256x128 lat-long map in the left camera's frame, energy kept."""
        return EnvironmentMap(
            radiance=latlong_radiance(self.radiance, LATLONG_PX),
            frame=Frame.CAMERA,
            anchor=Anchor.LDR_WHITE,
            provenance=self.provenance,
        )

    def to_json(self) -> dict[str, Any]:
        """All but the pixels, for `json.dump`."""
        return {
            "model": self.model,
            "confidence": self.confidence and self.confidence.to_json(),
            "warnings": list(self.warnings),
            "level_from_camera": self.level_from_camera.matrix.tolist(),
            "anchor": str(Anchor.LDR_WHITE),
            "provenance": self.provenance.to_json(),
        }
