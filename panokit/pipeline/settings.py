"""What a pipeline's TOML file says: where from, how each stage works, where the probes go."""

from pathlib import Path
from typing import Literal

from pydantic import Field

from panokit.expand.settings import ExpandSettings
from panokit.fetch.settings import FetchSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.qa.settings import QaSettings
from panokit.settings import Settings
from panokit.stitch.settings import StitchSettings


class PipelineSettings(Settings):
    """One run from places to light probes; each table has the fields of its stage's settings."""

    name: str = Field(min_length=1)
    """What to call the run, in the report."""

    output: Path | None = None
    """The run's folder; `runs/NAME` if not given."""

    library: Path = Path("library")
    """The probe library to put good maps into; relative to the run's folder."""

    reference: Path | None = None
    """A folder of maps to compare with; one with the name of a map is its truth."""

    engine: Literal["serial", "local"] = "serial"
    """How items are worked on: one after the other, or in several processes."""

    workers: int | None = Field(default=None, ge=1)
    """Processes of the local engine; one for each core if not given."""

    max_rejected_share: float = Field(default=0.5, ge=0, le=1)
    """The run ends with exit code 1 if a larger share of its items was rejected."""

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

    def folder(self) -> Path:
        """Where the run goes."""
        return self.output or Path("runs") / self.name
