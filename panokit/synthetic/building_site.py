"""A place built from its plan: everything that stands in it, as meshes in the world frame."""

import math

from panokit.synthetic.city import PlacePlan, Thing
from panokit.synthetic.facades import build_building
from panokit.synthetic.furniture import (
    build_bench,
    build_bin,
    build_bollard,
    build_fountain,
    build_ground,
    build_hedge,
    build_lamp,
    build_tree,
)
from panokit.synthetic.materials import Material
from panokit.synthetic.shapes import Mesh, Parts, Placement
from panokit.synthetic.vehicles import build_boat, build_car, build_rig


def build_place(plan: PlacePlan, *, night: bool, rig: bool) -> dict[Material, Mesh]:
    """Everything in a place, one mesh for each material, in the world frame.

    Args:
        plan: What stands where.
        night: Lamps and some windows are lit.
        rig: What carries the camera is there.
    """
    parts = Parts().placed(world_placement(plan))
    for ground in plan.ground:
        build_ground(parts, ground)
    for building in plan.buildings:
        build_building(parts, building, night=night)
    for thing in plan.things:
        _build_thing(parts, thing, night=night)
    if rig:
        build_rig(parts, plan)
    return parts.meshes()


def world_placement(plan: PlacePlan) -> Placement:
    """How the frame of a place lies in the world: turned so that its street has its azimuth."""
    return Placement.standing(0.0, 0.0, -math.radians(plan.street_azimuth_deg))


def _build_thing(parts: Parts, thing: Thing, *, night: bool) -> None:
    if thing.kind == "lamp":
        build_lamp(parts, thing, night=night)
        return
    builders = {
        "bench": build_bench,
        "bin": build_bin,
        "boat": build_boat,
        "bollard": build_bollard,
        "car": build_car,
        "fountain": build_fountain,
        "hedge": build_hedge,
        "tree": build_tree,
    }
    builders[thing.kind](parts, thing)
