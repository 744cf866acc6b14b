"""A place in the city as pure data: what stands where, before any of it is built.

The frame of a place has +x right, +y up and -z along its street; `street_azimuth_deg` says
where -z looks in the world. A plan is a function of its kind and seed alone.
"""

from dataclasses import dataclass
from typing import Literal

from panokit.synthetic.materials import Color

PlaceKind = Literal["old-town", "boulevard", "square", "residential", "waterfront"]
ThingKind = Literal["car", "tree", "lamp", "bench", "bollard", "hedge", "fountain", "boat", "bin"]
Wall = Literal["plaster", "brick", "stone", "concrete"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BuildingPlan:
    """One building in a row of fronts.

    Attributes:
        left_x_m: Of the front's left corner, as seen from the street.
        left_z_m: Of the same corner.
        right_turn: Radians from +x to the direction that is right on the front,
            counter-clockwise from above.
        width_m: Of the front.
        depth_m: Of the building.
        floors: Above the ground floor.
        ground_floor_m: Height of the ground floor.
        floor_m: Height of every other floor.
        wall: What its walls are made of.
        color: Of the walls.
        bay_m: From window to window, about.
        window_m: Width and height of a window.
        ground: What the ground floor is.
        shutters: Whether the windows have them.
        balconies: Share of windows with a balcony.
        pitched: Whether there is a pitched roof; otherwise a parapet.
        seed: For what is left to chance within the building.
    """

    left_x_m: float
    left_z_m: float
    right_turn: float
    width_m: float
    depth_m: float
    floors: int
    ground_floor_m: float
    floor_m: float
    wall: Wall
    color: Color
    bay_m: float
    window_m: tuple[float, float]
    ground: Literal["home", "shop", "arcade"]
    shutters: bool
    balconies: float
    pitched: bool
    seed: int

    @property
    def height_m(self) -> float:
        """From the pavement to the eaves."""
        return self.ground_floor_m + self.floors * self.floor_m


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundPlan:
    """One level rectangle of ground.

    Attributes:
        surface: Its texture.
        x_m: From and to.
        z_m: From and to.
        y_m: Height of its top; more than 0 gets kerbs at both sides.
        color: Of the surface.
    """

    surface: Literal["asphalt", "paving", "cobbles", "grass", "paint", "water"]
    x_m: tuple[float, float]
    z_m: tuple[float, float]
    y_m: float = 0.0
    color: Color = (0.2, 0.2, 0.2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Thing:
    """Street furniture, a car, a tree.

    Attributes:
        kind: What it is.
        x_m: Where.
        z_m: Where.
        turn: Radians, counter-clockwise from above.
        height_m: For trees, lamps and hedges; length for hedges and boats.
        color: For cars, awnings and boats.
        seed: For what is left to chance within it.
        y_m: Of the ground it stands on.
    """

    kind: ThingKind
    x_m: float
    z_m: float
    turn: float = 0.0
    height_m: float = 1.0
    color: Color = (0.3, 0.3, 0.3)
    seed: int = 0
    y_m: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacePlan:
    """A whole place.

    Attributes:
        kind: What sort of place it is.
        seed: That it was planned from.
        street_azimuth_deg: Where -z of the place looks, clockwise from north.
        camera_m: Where the camera stands.
        rig: What carries the camera, seen at the foot of each picture.
        ground: Level rectangles.
        buildings: All of them.
        things: All else.
    """

    kind: PlaceKind
    seed: int
    street_azimuth_deg: float
    camera_m: tuple[float, float, float]
    rig: Literal["car", "tripod"]
    ground: tuple[GroundPlan, ...]
    buildings: tuple[BuildingPlan, ...]
    things: tuple[Thing, ...]
