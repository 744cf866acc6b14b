"""The projections by name, for settings and command lines."""

from panokit.sphere.cubemap import LAYOUTS, Cubemap
from panokit.sphere.equirect import Equirectangular
from panokit.sphere.octahedral import Octahedral
from panokit.sphere.projection import Projection
from panokit.sphere.radial import ANGULAR, MIRROR_BALL, SKY_DOME

PROJECTIONS: dict[str, Projection] = {
    "equirectangular": Equirectangular(),
    "anamorphic": Equirectangular(aspect=1.0),
    **{f"cubemap-{layout}": Cubemap(layout=layout) for layout in LAYOUTS},
    "mirror-ball": MIRROR_BALL,
    "angular": ANGULAR,
    "sky-dome": SKY_DOME,
    "octahedral": Octahedral(),
    "octahedral-equal-area": Octahedral(equal_area=True),
}
