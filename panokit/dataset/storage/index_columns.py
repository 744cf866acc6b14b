"""The columns of a dataset's index: what a sample's meta.json says, flat and with types.

A row is made of the shard alone, so an index can be made again from the tar files. Where a
member lies is told by two more columns each, "offset/left.png" and "bytes/left.png".
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from panokit.color import luminance
from panokit.frames import Rotation, azimuth_elevation_from_direction
from panokit.sphere import equirect_directions, pixel_solid_angles

# Column -> type and the path into meta.json.
FROM_META: dict[str, tuple[pa.DataType, tuple[str | int, ...]]] = {
    "index": (pa.int64(), ("index",)),
    "attempt": (pa.int32(), ("attempt",)),
    "object": (pa.string(), ("object", "id")),
    "object_kind": (pa.string(), ("object", "details", "kind")),
    "object_license": (pa.string(), ("object", "license")),
    "object_attribution": (pa.string(), ("object", "attribution")),
    "object_sha256": (pa.string(), ("object", "sha256")),
    "probe": (pa.string(), ("probe", "id")),
    "place": (pa.string(), ("probe", "place")),
    "probe_kind": (pa.string(), ("probe", "kind")),
    "probe_category": (pa.string(), ("probe", "category")),
    "probe_license": (pa.string(), ("probe", "license")),
    "probe_attribution": (pa.string(), ("probe", "attribution")),
    "probe_sha256": (pa.string(), ("probe", "sha256")),
    "yaw_deg": (pa.float64(), ("yaw_deg",)),
    "tilt_deg": (pa.float64(), ("tilt_deg",)),
    "exposure": (pa.float64(), ("exposure",)),
    "exposure_stops": (pa.float64(), ("exposure_stops",)),
    "on_floor": (pa.bool_(), ("on_floor",)),
    "object_turn_deg": (pa.float64(), ("object_turn_deg",)),
    "baseline_m": (pa.float64(), ("baseline_m",)),
    "fill": (pa.float64(), ("fill",)),
    "pitch_deg": (pa.float64(), ("pitch_deg",)),
    "roll_deg": (pa.float64(), ("roll_deg",)),
    "width_px": (pa.int32(), ("views", "left", "width_px")),
    "fov_deg": (pa.float64(), ("views", "left", "fov_deg")),
    "roughness": (pa.float64(), ("materials", 0, "roughness")),
    "metallic": (pa.float64(), ("materials", 0, "metallic")),
    "specular": (pa.float64(), ("materials", 0, "specular")),
    "textured": (pa.bool_(), ("materials", 0, "texture")),
    "mask_share": (pa.float64(), ("figures", "mask_share")),
    "burnt_share": (pa.float64(), ("figures", "burnt_share")),
    "object_median": (pa.float64(), ("figures", "object_median")),
    "energy_kept": (pa.float64(), ("figures", "energy_kept")),
    "renderer": (pa.string(), ("renderer", "name")),
    "renderer_version": (pa.string(), ("renderer", "version")),
    "renderer_variant": (pa.string(), ("renderer", "variant")),
    "spp": (pa.int32(), ("samples",)),
    "render_seed": (pa.int64(), ("render_seed",)),
}
# Columns that are not in meta.json.
OWN: dict[str, pa.DataType] = {
    "key": pa.string(),
    "split": pa.string(),
    "shard": pa.string(),
    "materials": pa.int32(),
    "light_elevation_deg": pa.float64(),
    "light_directedness": pa.float64(),
}


def row_from_meta(meta: Mapping[str, Any]) -> dict[str, Any]:
    """The values of all columns that meta.json decides; None where it does not say."""
    row = {name: _at(meta, path) for name, (_, path) in FROM_META.items()}
    if row["object_kind"] is None and row["object"]:
        # Of meshes from a folder: "folder/NAME".
        row["object_kind"] = str(row["object"]).partition("/")[0]
    return row | {
        "key": meta["key"],
        "split": meta["split"],
        "materials": len(meta.get("materials", ())),
    }


def _at(value: Any, path: tuple[str | int, ...]) -> Any:
    for step in path:
        try:
            value = value[step]
        except (KeyError, IndexError, TypeError):
            return None
    return value


def light_direction(
    target: NDArray[np.float32], world_from_camera: Rotation
) -> dict[str, float | None]:
    """Where most of the light is from.

    The direction is that of the vector irradiance, the sum of radiance times solid angle times
    direction; its length over the sum without the directions is 1 for a single lamp and 0 for
    light from all sides alike.

    Args:
        target: (64, 64, 3), the lat-long map in the left camera's frame.
        world_from_camera: That camera's.
    """
    height, width = target.shape[:2]
    power = luminance(target) * pixel_solid_angles(height, width)
    total = float(power.sum())
    if not total > 0:
        return {"light_elevation_deg": None, "light_directedness": None}
    vector = (power[..., None] * equirect_directions(width, height)).sum(axis=(0, 1)) / total
    length = float(np.linalg.norm(vector))
    _, elevation = azimuth_elevation_from_direction(world_from_camera.apply(vector))
    return {
        "light_elevation_deg": float(np.rad2deg(elevation)) if length > 1e-6 else None,
        "light_directedness": length,
    }
