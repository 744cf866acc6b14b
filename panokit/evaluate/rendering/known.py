"""The object of a sample, rebuilt from what its record says: exact shape, place and cameras.

A sample's meta.json names the object and how it was turned, and procedural objects are made from
their names; meshes of a folder need that folder. Everything is given in the left camera's frame.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.objects.catalog import ObjectCatalog, open_catalog
from panokit.dataset.scene import Material, Mesh, View
from panokit.dataset.settings import ObjectSettings
from panokit.errors import ItemError, UsageError
from panokit.frames import Rotation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KnownGeometry:
    """What a method that knows the shape knows.

    Attributes:
        mesh: In the left camera's frame.
        views: The left camera, at the origin, and the right one.
        materials: The true ones, one for each part; a texture counts by its mean color.
    """

    mesh: Mesh
    views: tuple[View, View]
    materials: tuple[Material, ...]


def open_objects(meshes: Path | None = None) -> ObjectCatalog:
    """The catalog of objects, with the meshes of a folder if one is given."""
    return open_catalog(ObjectSettings(meshes=str(meshes) if meshes else ""))


def known_geometry(meta: Mapping[str, Any], catalog: ObjectCatalog, width_px: int) -> KnownGeometry:
    """Rebuild the object of a sample.

    Args:
        meta: The sample's meta.json.
        catalog: Of objects, see `open_objects`.
        width_px: Width and height of the pictures that are wanted of it.

    Raises:
        ItemError: If the record does not say enough, or the object is not in the catalog, or it
            is another by now.
    """
    try:
        object_id, turn_deg = str(meta["object_id"]), float(meta["object_turn_deg"])
        of_part = np.asarray(meta["material_of_part"], np.uint8)
        materials = tuple(_material(record) for record in meta["materials"])
        cameras = [_view(name, meta["views"][name], width_px) for name in ("left", "right")]
        digest = meta["object"]["sha256"]
    except (KeyError, TypeError, ValueError) as error:
        raise ItemError(
            f"Sample {meta.get('key', '?')} does not say what its object was ({error!r}). Only "
            "samples that panokit rendered can be rebuilt.",
            reason="no-geometry",
        ) from error
    try:
        mesh = catalog.load(object_id)
        same = catalog.digest(object_id) == digest
    except UsageError as error:
        raise ItemError(
            f"The object {object_id} of sample {meta.get('key', '?')} is not there. Give the "
            "folder of meshes that the dataset was made from.",
            reason="no-geometry",
        ) from error
    if not same:
        raise ItemError(
            f"The object {object_id} is another than that of the dataset. Use the meshes and the "
            "version of panokit that it was made with.",
            reason="other-geometry",
        )
    left, right = cameras
    camera_from_world = left.world_from_camera.inverse
    turned = Rotation.about_axis((0, 1, 0), float(np.deg2rad(turn_deg))).apply(mesh.vertices)
    placed = camera_from_world.apply(turned.astype(np.float64) - left.position)
    return KnownGeometry(
        mesh=Mesh(
            vertices=placed.astype(np.float32), faces=mesh.faces, part=of_part[mesh.part],
            smooth=mesh.smooth,
        ),
        views=(
            replace(left, position=(0.0, 0.0, 0.0), world_from_camera=Rotation.identity()),
            replace(
                right,
                position=_three(
                    camera_from_world.apply(np.subtract(right.position, left.position))
                ),
                world_from_camera=camera_from_world @ right.world_from_camera,
            ),
        ),
        materials=materials,
    )  # fmt: skip


def _material(record: Mapping[str, Any]) -> Material:
    known = {field.name for field in fields(Material)} - {"texture", "base_color"}
    numbers: dict[str, Any] = {name: float(record[name]) for name in known}
    return Material(base_color=_three(record["base_color"]), **numbers)


def _view(name: str, record: Mapping[str, Any], width_px: int) -> View:
    """The camera of a record, with pictures of another width."""
    scale = width_px / int(record["width_px"])
    shift = float(record["intrinsics_px"][0][2]) - int(record["width_px"]) / 2
    return View(
        name=name,
        position=_three(record["position_m"]),
        world_from_camera=Rotation(np.array(record["world_from_camera"])),
        fov_deg=float(record["fov_deg"]),
        width_px=width_px,
        height_px=width_px,
        shift_px=shift * scale,
    )


def _three(values: NDArray[np.floating[Any]] | list[float]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
