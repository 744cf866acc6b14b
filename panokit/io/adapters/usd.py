"""USD: the same file, under a dome light that is turned to panokit's axes.

A dome light shows a lat-long texture by the OpenEXR specification, +Y up and its center at +Z
(UsdLux, "DomeLight"): with d of panokit, (-x, y, -z), half a turn about Y.
"""

import numpy as np

from panokit.errors import UsageError
from panokit.io.adapters.analytic_sun import AnalyticSun

_STAGE = """#usda 1.0
(
    defaultPrim = "Light"
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "Light"
{{
    def DomeLight "Environment"
    {{
        asset inputs:texture:file = @{texture}@
        token inputs:texture:format = "latlong"
        float inputs:intensity = {intensity}
        # The texture's center is +Z; turned, it is panokit's forward, -Z.
        float3 xformOp:rotateXYZ = (0, 180, 0)
        uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]
    }}
{sun}}}
"""
# With `normalize` the intensity is the irradiance of a surface that faces the light. It shines
# along its -Z; the rows of a USD matrix are where its axes point.
_SUN = """
    def DistantLight "Sun"
    {{
        float inputs:angle = {angle_deg}
        color3f inputs:color = ({color})
        float inputs:intensity = {intensity}
        bool inputs:normalize = 1
        matrix4d xformOp:transform = ( {rows} )
        uniform token[] xformOpOrder = ["xformOp:transform"]
    }}
"""


def usd_dome_light(texture: str, *, intensity: float = 1.0, sun: AnalyticSun | None = None) -> str:
    """The text of a .usda file with a dome light that shows a map, turned to panokit's axes.

    Args:
        texture: The map's path as the stage will find it, for example "./probe.exr".
        intensity: What radiance is multiplied with, the sun's too.
        sun: A distant light beside it, for a map without its sun.

    Raises:
        UsageError: If the path holds characters that a USD asset path cannot.
    """
    if not texture or "@" in texture or "\n" in texture:
        raise UsageError(f"{texture!r} is no path for USD: it must not be empty or contain '@'.")
    told = "" if sun is None else _sun_text(sun, intensity)
    return _STAGE.format(texture=texture, intensity=f"{intensity:g}", sun=told)


def _sun_text(sun: AnalyticSun, intensity: float) -> str:
    strength = max(float(sun.irradiance.max()), 1e-30)
    side, up = axes_about(sun.direction)
    rows = [*((*axis, 0.0) for axis in (side, up, sun.direction)), (0.0, 0.0, 0.0, 1.0)]
    return _SUN.format(
        angle_deg=f"{np.degrees(2 * sun.angular_radius):.6g}",
        color=", ".join(f"{value / strength:.7g}" for value in sun.irradiance),
        intensity=f"{strength * intensity:.7g}",
        rows=", ".join("(" + ", ".join(f"{value:.9g}" for value in row) + ")" for row in rows),
    )


def axes_about(direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors that with a direction, as third axis, make a right-handed system."""
    helper = np.array([0.0, 1, 0]) if abs(direction[1]) < 0.9 else np.array([1.0, 0, 0])
    side = np.cross(helper, direction)
    side /= np.linalg.norm(side)
    return side, np.cross(direction, side)
