"""The embedded city, all the way to light probes: the main job with nothing but panokit."""

from pathlib import Path

from panokit.console import Console
from panokit.fetch.settings import PlaceSettings
from panokit.pipeline.load import load_settings
from panokit.pipeline.runner import RunResult, run_pipeline
from panokit.pipeline.settings import PipelineSettings
from panokit.shipped import shipped_path
from panokit.synthetic import StreetServer, embedded_city, embedded_truth

# The embedded places lie a few steps apart, as islands on a map.
_AROUND_M = 5.0


def run_demo(out: Path, console: Console) -> RunResult:
    """Serve the embedded city on this machine, and run the demo's pipeline against it.

    The city's true light is read by QA alone, to compare with.

    Args:
        out: The run's folder.
        console: Says how it goes.
    """
    pictures = embedded_city()
    settings = demo_settings()
    with StreetServer(pictures) as server:
        console.note(f"The embedded city is served at {server.url}, to this machine only.")
        fetch = settings.fetch.model_copy(
            update={"endpoint": f"{server.url}", "places": demo_places()}
        )
        return run_pipeline(
            settings.model_copy(
                update={"output": out, "fetch": fetch, "reference": embedded_truth()}
            ),
            console,
        )


def demo_settings() -> PipelineSettings:
    """The demo's pipeline; the server's address, places and truth are filled in by `run_demo`."""
    return load_settings(shipped_path("pipelines/demo.toml"), PipelineSettings)


def demo_places() -> tuple[PlaceSettings, ...]:
    """The places of the embedded city, as areas around their pictures."""
    found: dict[str, list[tuple[float, float]]] = {}
    for picture in embedded_city():
        found.setdefault(picture.capture.place, []).append(picture.position_deg)
    return tuple(
        PlaceSettings(
            name=place,
            latitude_deg=sum(latitude for latitude, _ in positions) / len(positions),
            longitude_deg=sum(longitude for _, longitude in positions) / len(positions),
            radius_m=_AROUND_M,
        )
        for place, positions in found.items()
    )
