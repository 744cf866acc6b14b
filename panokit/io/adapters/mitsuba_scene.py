"""Mitsuba 3: a scene file with the environment light, to be included in a scene.

Its texture has Mitsuba's rows, the first on the zenith and the last on the nadir; see
`panokit.io.adapters.mitsuba`.
"""

from xml.sax.saxutils import quoteattr

from panokit.errors import UsageError
from panokit.io.adapters.analytic_sun import AnalyticSun

# Mitsuba's texture has +Z at its center; half a turn makes that -Z, panokit's forward.
_SCENE = """<scene version="3.0.0">
    <emitter type="envmap" id="environment">
        <string name="filename" value={texture}/>
        <transform name="to_world">
            <rotate y="1" angle="180"/>
        </transform>
    </emitter>
{sun}</scene>
"""
_SUN = """    <emitter type="directional" id="sun">
        <vector name="direction" value="{direction}"/>
        <rgb name="irradiance" value="{irradiance}"/>
    </emitter>
"""
MITSUBA_NOTE = (
    "Latitude-longitude map for Mitsuba 3: the centers of the first and the last row lie on the "
    "zenith and the nadir, column i has its center at u = (i + 0.5) / width."
)


def mitsuba_scene(texture: str, *, sun: AnalyticSun | None = None) -> str:
    """The text of an .xml file with a map as environment light, in panokit's axes.

    Args:
        texture: The file of `to_mitsuba(envmap)`, from where the scene file lies.
        sun: A directional light beside it, for a map without its sun.

    Raises:
        UsageError: If the path is empty.
    """
    if not texture:
        raise UsageError("The scene needs the file name of the map.")
    told = ""
    if sun is not None:
        told = _SUN.format(
            direction=", ".join(f"{-value:.8g}" for value in sun.direction),
            irradiance=", ".join(f"{value:.7g}" for value in sun.irradiance),
        )
    return _SCENE.format(texture=quoteattr(texture), sun=told)
