"""What an object's pixels say of its surface: reflectance maps, materials, normals.

grid       the half sphere of normals that a camera sees, as a square picture
sparse     colors of pixels gathered by their normal: the sparse reflectance map
materials  pixels of one material, by k-means
normals    noise on normals; normals from depth
stereo     depth and normals from two views, by block matching
primitives normals of a rough shape that a user picks
smaller    pictures and normals at the size that a network takes

and networks that read light from two views, with what their answers are worth:

light_network  what a network is given, and what it gives
mirroring      the views in a mirror: two answers, and how far they are apart
calibration    from how far they are apart to how wrong one is
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.reflectance.grid import hemisphere_normals
    from panokit.reflectance.materials import segment_materials
    from panokit.reflectance.normals import add_noise, normals_from_depth
    from panokit.reflectance.primitives import primitive_normals
    from panokit.reflectance.sparse import Rule, SparseReflectance, sparse_reflectance
    from panokit.reflectance.stereo import normals_from_stereo

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Rule": "panokit.reflectance.sparse",
        "SparseReflectance": "panokit.reflectance.sparse",
        "add_noise": "panokit.reflectance.normals",
        "hemisphere_normals": "panokit.reflectance.grid",
        "normals_from_depth": "panokit.reflectance.normals",
        "normals_from_stereo": "panokit.reflectance.stereo",
        "primitive_normals": "panokit.reflectance.primitives",
        "segment_materials": "panokit.reflectance.materials",
        "sparse_reflectance": "panokit.reflectance.sparse",
    },
)
