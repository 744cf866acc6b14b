"""Mitsuba's start-up: a variant that works on this machine, and maps in its own convention.

Mitsuba's LLVM variants need a libLLVM of 17 or newer from the system. With 15 or 16 they load
and then *abort the process* at the first kernel that takes a minimum, which no `except` can
catch. So a variant is tried in a process of its own before it is used here.
"""

import subprocess
import sys
from functools import lru_cache
from importlib.util import find_spec
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import MissingExtraError, MissingLibraryError, PanokitError
from panokit.frames import TOOL_FROM_PANOKIT
from panokit.io.adapters.mitsuba import pad_columns
from panokit.io.adapters.nodes import rows_from_pole_to_pole

VARIANTS = ("llvm_ad_rgb", "scalar_rgb")
_PROBE_SECONDS = 120
# The same operations that a sky makes; libLLVM 15 dies at the minimum.
_PROBE = """
import sys, mitsuba as mi
mi.set_variant(sys.argv[1])
scene = mi.load_dict({"type": "scene", "light": {"type": "constant"},
    "ball": {"type": "sphere", "bsdf": {"type": "principled", "clearcoat": 0.5}},
    "camera": {"type": "perspective", "to_world": mi.ScalarTransform4f().look_at(
        [0, 0, 4], [0, 0, 0], [0, 1, 0]), "film": {"type": "hdrfilm", "width": 4, "height": 4}},
    "path": {"type": "path"}})
import numpy as np
picture = np.array(mi.render(scene, spp=2))
if sys.argv[1].startswith("llvm"):
    import drjit as dr
    a = mi.Float([0.0, 1.0])
    picture = picture + np.array(dr.minimum(a, dr.maximum(a * 2, 0.5))).sum()
sys.exit(0 if np.isfinite(picture).all() else 3)
"""


@lru_cache(maxsize=1)
def working_variant() -> str:
    """The fastest Mitsuba variant that works on this machine, found out once per process.

    Raises:
        MissingExtraError: If Mitsuba is not installed.
        PanokitError: If no variant works.
    """
    if find_spec("mitsuba") is None:
        raise MissingExtraError("mitsuba", "render", "Rendering")
    complaints = []
    for variant in VARIANTS:
        complaint = _try(variant)
        if complaint is None:
            return variant
        complaints.append(f"{variant}: {complaint}")
    raise PanokitError(
        f"Mitsuba is installed but does not work here ({'; '.join(complaints)}). "
        "Reinstall it, or render on another machine."
    )


def _try(variant: str) -> str | None:
    """None if the variant renders in a process of its own; otherwise what went wrong."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", _PROBE, variant],
            capture_output=True,
            text=True,
            timeout=_PROBE_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    if done.returncode == 0:
        return None
    last_line = (done.stderr.strip().splitlines() or ["no message"])[-1]
    return f"exit {done.returncode}, {last_line}"


def load_mitsuba() -> ModuleType:
    """The `mitsuba` module with a variant set that works here.

    A variant that the caller has set before is kept.

    Raises:
        MissingExtraError: If Mitsuba is not installed.
    """
    if find_spec("mitsuba") is None:
        raise MissingExtraError("mitsuba", "render", "Rendering")
    import mitsuba

    if mitsuba.variant() is None:
        mitsuba.set_variant(working_variant())
    return mitsuba


def describe_renderer() -> str:
    """One line for `panokit doctor`: the variant in use, and how to get a faster one."""
    try:
        variant = working_variant()
    except PanokitError as error:
        return str(error)
    import mitsuba

    line = f"Mitsuba {mitsuba.__version__}, {variant}"
    if variant == "scalar_rgb":
        line += "; about three times faster with libLLVM 17 or newer (Debian: libllvm19)"
    return line


def environment_emitter(radiance: NDArray[np.floating[Any]]) -> dict[str, Any]:
    """An environment light for a Mitsuba scene, from a map in panokit's convention.

    Args:
        radiance: (H, W, 3), equirectangular, in the frame of the scene.
    """
    mitsuba = load_mitsuba()
    turned = np.eye(4)
    # Both rotations are their own inverse, so the direction of the change does not matter.
    turned[:3, :3] = TOOL_FROM_PANOKIT["mitsuba"].matrix
    return {
        "type": "envmap",
        "bitmap": mitsuba.Bitmap(rows_from_pole_to_pole(radiance)),
        "to_world": mitsuba.ScalarTransform4f(turned),
    }


def environment_parameter(radiance: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """The value for `params["<light>.data"]` of an environment light that is loaded already.

    Mitsuba keeps one more column at each side, and takes an array without them silently for
    another picture.

    Returns:
        (H, W + 2, 3) float32.
    """
    return pad_columns(rows_from_pole_to_pole(radiance))


def use_one_thread() -> None:
    """Let Mitsuba work on one thread: several processes of one thread each do more in all."""
    load_mitsuba()
    import drjit

    drjit.set_thread_count(1)


def evaluate_together(arrays: list[Any]) -> None:
    """Compute arrays of Mitsuba's that depend on the same work in one go."""
    import drjit

    drjit.eval(*arrays)


def differentiable_mitsuba() -> ModuleType:
    """The `mitsuba` module with a variant that traces errors back to parameters.

    Raises:
        MissingExtraError: If Mitsuba is not installed.
        MissingLibraryError: If it has only the scalar variant here, for want of a libLLVM.
    """
    mitsuba = load_mitsuba()
    if "_ad_" not in str(mitsuba.variant()):
        raise MissingLibraryError(
            f"Differentiable rendering needs libLLVM: Mitsuba runs here as {mitsuba.variant()}, "
            "which has no gradients. Install libLLVM 17 or newer (Debian: libllvm19)."
        )
    return mitsuba


def watch_gradient(array: Any) -> None:
    """Have what is rendered with an array of Mitsuba's tell its gradient by it."""
    load_mitsuba()
    import drjit

    drjit.enable_grad(array)


def gradient_of(array: Any) -> NDArray[np.float32]:
    """The gradient that rendering backward has left at an array, in the array's shape."""
    load_mitsuba()
    import drjit

    return np.array(drjit.grad(array), np.float32)
