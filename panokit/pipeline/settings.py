"""What a pipeline's TOML file says: where from, how each stage works, where the probes go."""

from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, ValidationError, field_validator, model_validator

from panokit.dataset.settings import DatasetSettings
from panokit.engine.settings import ClusterSettings, EngineName
from panokit.errors import SettingsError
from panokit.expand.settings import ExpandSettings
from panokit.fetch.settings import FetchSettings, PlaceSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.qa.settings import QaSettings
from panokit.settings import Settings
from panokit.stitch.settings import StitchSettings

if TYPE_CHECKING:
    from panokit.train.stereo.recipe import LightingRecipe

PROBE_STAGES = ("fetch", "stitch", "inpaint", "expand", "qa", "probes")
MODEL_STAGES = ("references", "dataset", "train", "evaluate")
STAGES = (*PROBE_STAGES, *MODEL_STAGES)
Arm = Literal["references", "augmented"]
# Of all figures those of which less is better, and which one number decides.
Figure = Literal[
    "relit-diffuse-si-rmse", "relit-glossy-0.3-si-rmse", "relit-mirror-si-rmse",
    "relit-plane-si-rmse", "relit-diffuse-rmse", "relit-glossy-0.3-rmse", "relit-mirror-rmse",
    "relit-plane-rmse", "l1", "log-rmse", "si-rmse", "rgb-angular", "dssim-sphere",
    "irradiance-mean", "light-vector", "thesis-mse", "thesis-ssd", "thesis-dssim",
    "thesis-dssim-log",
]  # fmt: skip


class AreaSettings(Settings):
    """Where to fetch, and what differs there from the table of fetch."""

    cities: tuple[str, ...] = ()
    """Cities by name, as in the table of fetch."""

    city_list: Path | None = None
    """A text file with one city on a line."""

    places: tuple[PlaceSettings, ...] = ()
    """Places of your own, each a name, a point and a radius."""

    area_file: Path | None = None
    """A GeoJSON file of polygons, or a CSV table of points."""

    bbox: tuple[float, float, float, float] | None = None
    """A box: west, south, east, north in degrees."""

    radius_m: float | None = Field(default=None, gt=0, le=100_000)
    """How far from a city's center to look."""

    count: int | None = Field(default=None, ge=1)
    """How many panoramas to have of each place; else as in the table of fetch."""

    date_from: date | None = None
    """Only pictures taken on this day or later; else as in the table of fetch."""

    date_to: date | None = None
    """Only pictures taken on this day or earlier; else as in the table of fetch."""

    licenses: tuple[str, ...] | None = None
    """Only pictures under these licenses; else as in the table of fetch."""


class QuotaSettings(Settings):
    """How much one start of the pipeline may spend; a later start goes on."""

    max_requests: int | None = Field(default=None, ge=0)
    """Stop before sending more requests than this, over all areas together."""

    max_cost_usd: float | None = Field(default=None, ge=0)
    """Stop before spending more than this by list price, over all areas together."""


class ReferenceSettings(Settings):
    """Maps of true range, of places that are not fetched: the light to train and to judge with."""

    folder: Path | None = None
    """A folder of HDR maps; else `probes` in the folder that PANOKIT_DATA names; else synthetic."""

    rendered: int = Field(default=10, ge=0)
    """Of synthetic maps, how many are rendered places of the city; needs panokit[render]."""

    skies: int = Field(default=6, ge=0)
    """Of synthetic maps, how many are skies by formula over plain ground."""

    seed: int = Field(default=40, ge=0)
    """Another seed gives other places."""

    width_px: int = Field(default=256, ge=64, le=4096, multiple_of=4)
    """Width of synthetic maps."""

    samples: int = Field(default=16, ge=1)
    """Light paths through each pixel of a rendered place."""


class DatasetStage(Settings):
    """Stereo samples, once for each arm: by reference maps alone, and by the run's probes, too."""

    arms: tuple[Arm, ...] = Field(default=("references", "augmented"), min_length=1)
    """Which datasets there are; each arm trains a model."""

    count: int = Field(default=1000, ge=4)
    """How many samples each arm has."""

    shard_samples: int | None = Field(default=None, ge=1)
    """How many of them a shard holds; 16 to 250 by the count if not given."""

    settings: DatasetSettings = DatasetSettings()
    """What samples are made of."""


class EvaluateStage(Settings):
    """How the models are judged: on places that no arm has learned from."""

    figure: Figure = "relit-diffuse-si-rmse"
    """The figure that decides between the arms."""

    count: int = Field(default=0, ge=0)
    """How many samples of the test split; all if 0."""

    baselines: bool = True
    """Whether what hardly looks (the mean map, one color) is judged, too."""


class PipelineSettings(Settings):
    """One run from places to light probes, and on to models; each table is that of its stage."""

    name: str = Field(min_length=1)
    """What to call the run, in the report."""

    output: Path | None = None
    """The run's folder; `runs/NAME` if not given."""

    library: Path = Path("library")
    """The probe library to put good maps into; relative to the run's folder."""

    publish: str = ""
    """Where library, datasets and models are copied to at the end: a folder or an fsspec URL."""

    reference: Path | None = None
    """A folder of maps to compare with; one with the name of a map is its truth."""

    serve: str = ""
    """Fetch from a server on this machine that lives as long as the run: "embedded" for the
    city that panokit brings, or a folder of pictures."""

    serve_port: int = Field(default=0, ge=0, le=65535)
    """The port of that server; a free one if 0. Captures keep the address, and so the port."""

    engine: EngineName = "serial"
    """How items are worked on: "serial", "local", "dask", "slurm" or a scheduler's address."""

    workers: int | None = Field(default=None, ge=1)
    """Workers of an engine that has them. If not given: one for each core, one job on Slurm, all
    that a scheduler has."""

    cluster: ClusterSettings = ClusterSettings()
    """What engines of several machines need to know."""

    max_rejected_share: float = Field(default=0.5, ge=0, le=1)
    """The run ends with exit code 1 if a larger share of its items was rejected."""

    quota: QuotaSettings = QuotaSettings()
    """How much one start may spend."""

    areas: tuple[AreaSettings, ...] = ()
    """Where to fetch, each with a count and dates of its own; besides what fetch itself names."""

    fetch: FetchSettings = FetchSettings()
    """Which panoramas to fetch."""

    stitch: StitchSettings = StitchSettings()
    """How tiles become a panorama."""

    inpaint: InpaintSettings = InpaintSettings()
    """How holes are found and filled."""

    expand: ExpandSettings = ExpandSettings()
    """How a panorama becomes an HDR map."""

    qa: QaSettings = QaSettings()
    """What a map must be like to pass."""

    references: ReferenceSettings = ReferenceSettings()
    """The maps of true range that samples are lit by and models judged with."""

    dataset: DatasetStage | None = None
    """Stereo samples lit by the probes; the run ends with the probes if not given."""

    train: "LightingRecipe | None" = None
    """A model that is trained on each arm's samples: a recipe as of `panokit train`."""

    evaluate: EvaluateStage | None = None
    """How the models are judged."""

    @classmethod
    def model_rebuild(cls, **how: Any) -> bool | None:
        """Finish the class when it is first used: recipes bring numpy, --help can do without."""
        from panokit.train.stereo.recipe import LightingRecipe

        types = {**globals(), "LightingRecipe": LightingRecipe}
        return super().model_rebuild(**{**how, "_types_namespace": types})

    @field_validator("publish", "serve")
    @classmethod
    def _without_spaces(cls, text: str) -> str:
        return text.strip()

    @model_validator(mode="after")
    def _consistent(self) -> "PipelineSettings":
        if self.train is not None and self.dataset is None:
            raise ValueError("the table train needs the table dataset: what to learn from")
        if self.evaluate is not None and self.train is None:
            raise ValueError("the table evaluate needs the table train: what to judge")
        if self.train is not None and self.train.kind != "stereo":
            raise ValueError('train: a pipeline trains kind = "stereo"')
        return self

    def folder(self) -> Path:
        """Where the run goes."""
        return self.output or Path("runs") / self.name

    def stages(self) -> tuple[str, ...]:
        """The stages that this pipeline has, in order."""
        asked = {
            "references": self.dataset, "dataset": self.dataset, "train": self.train,
            "evaluate": self.evaluate,
        }  # fmt: skip
        return tuple(s for s in STAGES if s in PROBE_STAGES or asked[s] is not None)

    def asks(self) -> tuple[FetchSettings, ...]:
        """What to fetch, one after the other: what `fetch` itself names, then each area.

        Raises:
            SettingsError: If an area does not go together with the table of fetch.
        """
        own = [self.fetch] if names_places(self.fetch) or not self.areas else []
        return (*own, *(self._ask(number, area) for number, area in enumerate(self.areas)))

    def _ask(self, number: int, area: AreaSettings) -> FetchSettings:
        nowhere = {name: FetchSettings.model_fields[name].default for name in _WHERE}
        own: dict[str, Any] = area.model_dump(exclude_none=True)
        if not any(own.get(name) for name in _WHERE):
            raise SettingsError(
                f"areas: the area {number + 1} names no place. Give it cities, places, a bbox, a "
                "city_list or an area_file."
            )
        try:
            return FetchSettings.model_validate({**self.fetch.model_dump(), **nowhere, **own})
        except ValidationError as error:
            raise SettingsError(f"areas: area {number + 1}: {error.errors()[0]['msg']}.") from error


_WHERE = (
    "cities", "city_list", "places", "area_file", "bbox", "point", "pictures", "picture_list",
)  # fmt: skip


def names_places(settings: FetchSettings) -> bool:
    """Whether settings of fetch themselves say where or what to fetch."""
    return settings.source == "folder" or any(getattr(settings, name) for name in _WHERE)
