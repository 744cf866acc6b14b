"""Expansion with a released model: networks on the grid and networks on the components."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from panokit.errors import ImageError, ModelError
from panokit.expand.component_features import COMPONENT_FEATURES, component_features
from panokit.expand.components import Components, find_components
from panokit.expand.curve import apply_curve
from panokit.expand.features import GRID_WIDTH_PX, grid_features
from panokit.expand.reduce import ReducedPanorama
from panokit.expand.spread import grid_energies, spread_gain
from panokit.frames import azimuth_elevation_from_direction
from panokit.inference import DEFAULT_THREADS, Session
from panokit.weights import ReleasedModel, find_model, verify_model

# What a model is for that this stage can run.
TASK = "expand"
# Of the functions that make the networks' inputs; a model says which one it was trained with.
FEATURES_VERSION = "1"
# Of a model in two files, whose grid network answers for one roll: the mean over rolls by 0 to
# 15 cells repeats under every roll. A model in one file does this within.
ROLLS = 16
# The share of the sphere that must be burnt out for a model's camera curve to count in full.
ENOUGH_BURNT = 0.002


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Answer:
    """What a model computes.

    Attributes:
        log_gain: (3, 64, 128) float32, of burnt-out light, per channel.
        slopes: Of the camera's response, in the dark and at white.
        component_gain: (K,) float32, log gain of each component.
        sun: (K,) float32, probability that a component is the sun.
        grid_weight: How much the grid counts in the log of a component's energy.
        looks_for_sun: Whether the model tells suns from lamps; if not, `sun` is 0.
    """

    log_gain: NDArray[np.float32]
    slopes: tuple[float, float]
    component_gain: NDArray[np.float32]
    sun: NDArray[np.float32]
    grid_weight: float = 0.5
    looks_for_sun: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """What the networks say of a panorama.

    Attributes:
        log_gain: (3, 64, 128) float32, of burnt-out light, per channel.
        curve_slopes: Of the camera's response, in the dark and at white; see `curve`.
        components: Of the panorama, K of them.
        grid_energy: (K + 1,) float64, of the light outside the components and of each one,
            as the grid has it.
        component_energy: (K,) float64, of each component as the component network has it.
        sun: (K,) float32, probability that a component is the sun.
        grid_weight: How much `grid_energy` counts in the log of a component's energy.
        looks_for_sun: Whether the model tells suns from lamps; if not, `sun` is 0.
    """

    log_gain: NDArray[np.float32]
    curve_slopes: tuple[float, float]
    components: Components
    grid_energy: NDArray[np.float64]
    component_energy: NDArray[np.float64]
    sun: NDArray[np.float32]
    grid_weight: float = 0.5
    looks_for_sun: bool = False

    @property
    def energy(self) -> NDArray[np.float64]:
        """(K + 1,): of the light outside the components, and each one's, the weighted
        geometric mean of what the two networks say.
        """  # noqa: D205
        weight = self.grid_weight
        each = self.grid_energy[1:] ** weight * self.component_energy ** (1 - weight)
        return np.concatenate([self.grid_energy[:1], each])

    @property
    def gain_ranges(self) -> NDArray[np.float64]:
        """(K, 2): between which gains the two networks put each component.

        Where they agree, that is as good as it gets; where not, the gain is a guess.
        """
        answers = np.stack([self.grid_energy[1:], self.component_energy], axis=1)
        return np.sort(answers / self.components.energy[:, None], axis=1)

    def range_at(self, direction: NDArray[np.float64]) -> tuple[float, float] | None:
        """The range of the component in a direction, as factors of the gain that was taken.

        Args:
            direction: (3,), in the panorama's frame.

        Returns:
            None where there is no component.
        """
        height, width = self.components.labels.shape
        azimuth, elevation = azimuth_elevation_from_direction(direction)
        column = int((float(azimuth) / (2 * np.pi) + 0.5) * width) % width
        row = min(int((0.5 - float(elevation) / np.pi) * height), height - 1)
        label = int(self.components.labels[row, column])
        if not label:
            return None
        gain = self.energy[label] / self.components.energy[label - 1]
        low, high = self.gain_ranges[label - 1] / gain
        return float(low), float(high)


class ExpansionNetwork:
    """A released expansion model, loaded and verified.

    Raises:
        ModelError: If its files are damaged, or it is not for this version's features.
    """

    def __init__(
        self, model: ReleasedModel, *, threads: int = DEFAULT_THREADS, device: str = "auto"
    ) -> None:
        if model.task != TASK or model.features_version != FEATURES_VERSION:
            raise ModelError(
                f"Model {model.id!r} is for {model.task!r} with features "
                f"{model.features_version!r}; this is expand with features {FEATURES_VERSION!r}. "
                "Use a model of this version of panokit."
            )
        verify_model(model)
        self.digest = model.digest
        self._files = {
            role: Session(model.path(role), threads=threads, device=device) for role in model.files
        }

    def ask(self, grid: NDArray[np.float32], features: NDArray[np.float32]) -> Answer:
        """What the model says.

        Args:
            grid: (16, 64, 128), `grid_features`.
            features: (K, 60), `component_features`.
        """
        count = len(features)
        # A network wants at least one row; one of zeros is padding to it.
        rows = features[None] if count else np.zeros((1, 1, COMPONENT_FEATURES), np.float32)
        if "expansion" in self._files:
            said = self._files["expansion"].run({"grid": grid[None], "features": rows})
            log_gain, slopes = said["log_gain"], said["slopes"]
            component_gain = said["component_gain"]
            sun = np.asarray(1 / (1 + np.exp(-said["sun_logit"].clip(-30, 30))), np.float32)
            weight = float(said["grid_weight"])
        else:
            log_gain, slopes = self._over_rolls(grid)
            component_gain = self._files["components"].run({"features": rows})["log_gain"][0]
            sun, weight = np.zeros_like(component_gain), 0.5
        return Answer(
            log_gain=_warm_or_cool(log_gain),
            slopes=(float(slopes[0]), float(slopes[1])),
            component_gain=component_gain[:count],
            sun=sun[:count],
            grid_weight=weight,
            looks_for_sun="expansion" in self._files,
        )

    def _over_rolls(
        self, grid: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        rolled = np.stack([np.roll(grid, shift, axis=-1) for shift in range(ROLLS)])
        result = self._files["gain"].run({"grid": rolled})
        back = [np.roll(gain, -i, axis=-1) for i, gain in enumerate(result["log_gain"])]
        return np.mean(back, axis=0), np.exp(np.log(result["slopes"]).mean(axis=0))


def predict(reduced: ReducedPanorama, network: ExpansionNetwork) -> Prediction:
    """Ask both networks.

    Args:
        reduced: The panorama; at 1024 pixels or more the networks see what they were trained on.
        network: The model.

    Raises:
        ImageError: If the panorama is smaller than the network's grid.
    """
    width = reduced.width_px
    if width < GRID_WIDTH_PX:
        raise ImageError(
            f"The panorama is {width} pixels wide; the network needs at least {GRID_WIDTH_PX}. "
            "Use a larger picture or an analytic model, such as srgb.",
            reason="too-small",
            values={"width_px": width},
        )
    grid = grid_features(reduced)
    components = find_components(reduced)
    answer = network.ask(grid, component_features(reduced, components, grid))
    return Prediction(
        log_gain=answer.log_gain,
        curve_slopes=_trusted(answer.slopes, reduced.burnt_share),
        components=components,
        grid_energy=grid_energies(answer.log_gain, reduced, components),
        component_energy=components.energy * np.exp(answer.component_gain),
        sun=answer.sun,
        grid_weight=answer.grid_weight,
        looks_for_sun=answer.looks_for_sun,
    )


def compose(reduced: ReducedPanorama, prediction: Prediction) -> NDArray[np.float32]:
    """Radiance (H, W, 3) from a panorama and what the networks say of it.

    Pixels that are not burnt out change by the estimated camera curve only; burnt-out ones
    never get darker.
    """
    lost = spread_gain(
        prediction.log_gain, reduced, prediction.components, prediction.energy, prediction.sun
    )
    return np.ascontiguousarray(shown_light(reduced, prediction.curve_slopes) + lost, np.float32)


def shown_light(reduced: ReducedPanorama, slopes: tuple[float, float]) -> NDArray[np.float32]:
    """What the picture shows, (H, W, 3) float32: through the camera's curve where nothing is
    burnt out.
    """  # noqa: D205
    open_share = np.maximum(1 - reduced.share, 1e-3)[..., None]
    unburnt = np.asarray(np.clip(reduced.clear / open_share, 0, 1), np.float32)
    return np.asarray(apply_curve(unburnt, *slopes) * open_share + reduced.burnt, np.float32)


def _trusted(slopes: tuple[float, float], burnt_share: float) -> tuple[float, float]:
    """The camera's slopes as far as they are known: those of sRGB where nothing is burnt out.

    They were learned on pictures that clip. One that does not is taken at its word: its map is
    the decoded picture. In between they fade, so that one burnt-out pixel changes nothing else.
    """
    trust = min(burnt_share / ENOUGH_BURNT, 1.0)
    return float(slopes[0] ** trust), float(slopes[1] ** trust)


def _warm_or_cool(log_gain: NDArray[np.float32]) -> NDArray[np.float32]:
    """The gain with its color kept on the way from warm to cool, where light sources lie.

    What a network says of green against magenta is noise, and shows: a magenta sun. What is
    left has the same change, with opposite signs, in red and blue.
    """
    red, green, blue = log_gain
    level = (red + green + blue) / 3
    warmth = (red - blue) / 2
    return np.stack([level + warmth, level, level - warmth])


@lru_cache(maxsize=2)
def load_network(model_id: str, device: str = "auto") -> ExpansionNetwork:
    """The released model with this id, loaded once; `device` as in `panokit.inference`."""
    return ExpansionNetwork(find_model(model_id), device=device)
