"""A released network in use: two views in, an estimate of the light out."""

from pathlib import Path
from typing import Literal

from panokit.errors import ModelError
from panokit.lighting.assumptions import view_warnings
from panokit.lighting.confidence import confidence_of
from panokit.lighting.estimate import LightEstimate
from panokit.lighting.settings import VERSION, EstimateSettings
from panokit.provenance import Provenance, Step
from panokit.reflectance.calibration import calibration_of
from panokit.reflectance.light_network import TASK, LightNetwork
from panokit.reflectance.mirroring import read_twice
from panokit.stereo import Views
from panokit.weights import ReleasedModel, find_model, read_model

# Where radiance is likely off by a factor of five, users are told.
_UNSURE = 0.2


class LightingModel:
    """A model that reads light; made once, used for any number of views, from several threads.

    Args:
        model: The id of a released model, or a folder with a model.toml.
        settings: What is asked of each estimate.
        threads: As of `panokit.inference.Session`.
        device: "auto", "cpu" or "cuda".

    Attributes:
        released: Its id, license and files.

    Raises:
        ModelError: If there is no such model, or it does something else.
    """

    def __init__(
        self,
        model: str | Path,
        settings: EstimateSettings | None = None,
        *,
        threads: int = 2,
        device: Literal["auto", "cpu", "cuda"] = "auto",
    ) -> None:
        self.settings = settings or EstimateSettings()
        self.released = _find(model)
        if self.released.task != TASK:
            raise ModelError(
                f"Model {self.released.id!r} is for {self.released.task}, not for {TASK}. See: "
                "panokit models list"
            )
        self.network = LightNetwork(self.released.folder, threads=threads, device=device)
        if not self.network.predicts_light:
            raise ModelError(
                f"Model {self.released.id!r} predicts reflectance, not light. See: panokit models "
                "list"
            )
        self.calibration = calibration_of(self.network.spec)

    def estimate(self, views: Views) -> LightEstimate:
        """Read the light of two views.

        Raises:
            UsageError: If the model needs normals and the views have none.
        """
        warnings = list(view_warnings(views))
        width_px = views.mask.shape[1]
        if width_px < self.network.input_px:
            warnings.append(
                f"The views are {width_px} pixels wide and were enlarged to the "
                f"{self.network.input_px} that the model reads; take larger pictures."
            )
        confidence = None
        if self.settings.confidence:
            radiance, mirrored = read_twice(self.network, views)
            confidence = confidence_of(radiance, mirrored, self.calibration)
            if confidence.value < _UNSURE:
                warnings.append(
                    f"The model is not sure: radiance may be off by a factor of "
                    f"{1 / confidence.value:.0f}. Try other views or another object."
                )
        else:
            radiance = self.network.read(views)
        step = Step(
            stage="lighting",
            version=VERSION,
            settings_digest=self.settings.digest,
            weights_digest=self.released.digest,
            values={"model": self.released.id},
        )
        return LightEstimate(
            radiance=radiance,
            level_from_camera=views.left_level,
            confidence=confidence,
            warnings=tuple(warnings),
            model=self.released.id,
            provenance=Provenance((step,)),
        )


def _find(model: str | Path) -> ReleasedModel:
    folder = Path(model)
    if (folder / "model.toml").is_file():
        return read_model(folder)
    if isinstance(model, Path) or len(folder.parts) > 1:
        raise ModelError(
            f"There is no model in {folder}: no model.toml. Name a folder that `panokit train` "
            "wrote, or the id of a released model."
        )
    return find_model(model)
