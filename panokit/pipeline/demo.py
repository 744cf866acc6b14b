"""The embedded city, all the way to light probes: the main job with nothing but panokit."""

from pathlib import Path

from panokit.console import Console
from panokit.pipeline.load import load_settings
from panokit.pipeline.result import RunResult
from panokit.pipeline.runner import run_pipeline
from panokit.pipeline.settings import PipelineSettings
from panokit.shipped import shipped_path
from panokit.synthetic import embedded_truth


def run_demo(out: Path, console: Console) -> RunResult:
    """Serve the embedded city on this machine, and run the demo's pipeline against it.

    The city's true light is read by QA alone, to compare with.

    Args:
        out: The run's folder.
        console: Says how it goes.
    """
    settings = demo_settings()
    return run_pipeline(
        settings.model_copy(update={"output": out, "reference": embedded_truth()}), console
    )


def demo_settings() -> PipelineSettings:
    """The demo's pipeline; the truth to compare with is filled in by `run_demo`."""
    return load_settings(shipped_path("pipelines/demo.toml"), PipelineSettings)
