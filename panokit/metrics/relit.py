"""Errors of what the light does: pictures of known scenes under both maps, compared.

The pictures come from panokit's precomputed transport (`panokit.metrics.transport`), which is
linear in the map, exact, and needs no renderer. `relit_errors` is panokit's own protocol.
`relit_three_spheres` follows the three-sphere protocol of `panokit.metrics.spheres` in all but
the renderer: figures from it are "panokit three spheres". They are not StyleLight scores, since
Blender's 5 noisy samples, its denoiser, its camera 7 degrees above the sphere and its depth of
field are not repeated, and belong into no table with them.
"""

import numpy as np
from numpy.typing import NDArray

from panokit.metrics.pairs import Radiance, radiance_pair
from panokit.metrics.spheres import SphereErrors, Variant, lighting_of_spheres, sphere_errors
from panokit.metrics.transport import relight

RELIT_SCENES = ("diffuse", "glossy-0.1", "glossy-0.3", "glossy-0.6", "mirror", "plane")

# The published materials; its mirror reflects 0.8.
THREE_SPHERES = {
    "mirror": "mirror-silver",
    "matte_silver": "matte-silver",
    "diffuse": "principled-diffuse",
}


def relit_errors(estimate: Radiance, truth: Radiance, scene: str) -> SphereErrors:
    """Compare one scene under both maps.

    Args:
        estimate: (H, W, 3), linear, on the truth's scale.
        truth: (H, W, 3), linear.
        scene: One of `panokit.metrics.transport.SCENES`.

    Raises:
        UsageError: If the shapes differ or there is no such scene.
    """
    radiance_pair(estimate, truth)
    guess, true = (relight(np.asarray(m, np.float32), scene) for m in (estimate, truth))
    return sphere_errors(guess, true, "fixed")


def relit_three_spheres(
    estimate: Radiance, truth: Radiance, variant: Variant = "fixed"
) -> dict[str, SphereErrors]:
    """The three-sphere protocol from map to figures, by panokit's transport.

    Args:
        estimate: (H, W, 3), linear, 2:1; the scale does not matter.
        truth: As `estimate`.
        variant: Of the tone step and of the arithmetic, see `panokit.metrics.spheres`.

    Returns:
        Errors for "mirror", "matte_silver" and "diffuse".
    """
    radiance_pair(estimate, truth)
    guess, true = (_facing_camera(lighting_of_spheres(m, variant)) for m in (estimate, truth))
    return {
        name: sphere_errors(relight(guess, scene), relight(true, scene), variant)
        for name, scene in THREE_SPHERES.items()
    }


def _facing_camera(lighting: NDArray[np.float32]) -> NDArray[np.float32]:
    """The map turned as Blender shows it: what is at u = 0.75 is behind the camera."""
    return np.roll(lighting, lighting.shape[1] // 4, axis=1)
