"""Samples from probe libraries, the catalog of objects and a renderer."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from panokit.dataset.make import make_sample
from panokit.dataset.plan import draw_plan
from panokit.dataset.renderers import make_renderer
from panokit.dataset.sample import Sample
from panokit.dataset.scene import Renderer
from panokit.dataset.settings import VERSION, DatasetSettings
from panokit.dataset.splits import split_of_index
from panokit.dataset.stock import Stock, open_stock


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LibraryMaker:
    """Makes samples from probe libraries; see `open_maker`.

    Attributes:
        settings: Of the dataset.
        stock: Objects and lights.
    """

    settings: DatasetSettings
    stock: Stock

    def describe(self) -> Mapping[str, Any]:
        """Settings, stock, renderer and the sources of light with their licenses."""
        return {
            "version": VERSION,
            "settings": self.settings.model_dump(mode="json"),
            "renderer": dict(_renderer(self.settings.renderer).describe()),
            "stock": self.stock.digest,
            "lights": {
                light.id: {
                    "place": light.place,
                    "kind": light.kind,
                    "license": asdict(light.license),
                }
                for light in self.stock.lights.all.values()
            },
        }

    def split_of(self, index: int) -> str:
        """The split of a sample."""
        return split_of_index(self.settings, index)

    def seed_of(self, index: int, attempt: int) -> Sequence[int]:
        """What `draw_plan` starts from."""
        return [self.settings.seed, index, attempt]

    def make(self, index: int, attempt: int) -> Sample:
        """Draw, render and encode a sample."""
        plan = draw_plan(self.settings, self.stock, index, attempt)
        return make_sample(plan, self.settings, self.stock, _renderer(self.settings.renderer))


def open_maker(
    settings: DatasetSettings, probes: Sequence[Path], *, packed: Path | None = None
) -> LibraryMaker:
    """The maker of a dataset from probe libraries.

    Args:
        settings: Of the dataset.
        probes: Probe libraries, run folders, or folders of maps.
        packed: A folder that keeps maps at their working size, or None.

    Raises:
        UsageError: If there is no light, or too few places or objects to split.
        LicenseError: If a map may not be trained with.
        MissingExtraError: If the renderer is not installed.
    """
    _renderer(settings.renderer)
    return LibraryMaker(settings=settings, stock=open_stock(settings, probes, packed=packed))


@lru_cache(maxsize=1)
def _renderer(name: str) -> Renderer:
    """The renderer of this process: starting one takes seconds."""
    return make_renderer(name)
