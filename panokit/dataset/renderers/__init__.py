"""Renderers behind one protocol, see `panokit.dataset.scene.Renderer`.

analytic   formulas in numpy, for tests
mitsuba    Mitsuba 3, the default
cycles     Blender's Cycles, in a process of its own
raster     a z-buffer
texturing  where textures lie
"""

from importlib import import_module

from panokit.dataset.scene import Renderer
from panokit.errors import SettingsError

# Name -> module and class; a module is loaded when its renderer is asked for.
RENDERERS = {
    "analytic": ("panokit.dataset.renderers.analytic", "AnalyticRenderer"),
    "blender": ("panokit.dataset.renderers.cycles", "CyclesRenderer"),
    "mitsuba": ("panokit.dataset.renderers.mitsuba", "MitsubaRenderer"),
}


def make_renderer(name: str) -> Renderer:
    """A renderer for this process, which uses one thread.

    Args:
        name: "mitsuba", "blender" or "analytic".

    Raises:
        SettingsError: If there is none of that name.
        MissingExtraError: If its package is not installed.
        PanokitError: If it does not work on this machine.
    """
    if name not in RENDERERS:
        raise SettingsError(f"There is no renderer {name!r}. Choose from {', '.join(RENDERERS)}.")
    module, class_name = RENDERERS[name]
    renderer: Renderer = getattr(import_module(module), class_name)()
    return renderer
