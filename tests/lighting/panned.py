"""A virtual camera that pans or slides over real panoramas, with objects whose place is known."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from panokit.dataset.scene import View
from panokit.frames import Rotation
from panokit.lighting.select import Box

SIZE = (640, 360)
FRAMES = 60


WIDE = 1568


@dataclass(frozen=True, kw_only=True)
class Thing:
    """An object in a panorama, outlined by hand.

    Corners and click are columns and rows of the panorama at a width of 1568. With `is_round`
    the two corners are those of the rectangle around an ellipse.
    """

    panorama: str
    name: str
    corners: tuple[tuple[float, float], ...]
    click: tuple[float, float] | None = None
    is_round: bool = False
    fov_deg: float = 60.0
    slides: bool = False
    shakes_deg: float = 0.0
    # Whether one click, without a tolerance set, selects it.
    selectable: bool = True

    def outline(self) -> np.ndarray:
        """(N, 3) directions on it."""
        points = np.array(self.corners, float)
        if self.is_round:
            turn = np.linspace(0, 2 * np.pi, 64, endpoint=False)
            half = np.ptp(points, axis=0) / 2
            return directions(
                points.mean(axis=0) + half * np.stack([np.cos(turn), np.sin(turn)], 1)
            )
        if len(points) == 2:
            (left, top), (right, bottom) = points
            points = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
        steps = np.linspace(0, 1, 12)[:, None]
        sides = zip(points, np.roll(points, -1, axis=0), strict=True)
        return directions(np.concatenate([one + (other - one) * steps for one, other in sides]))

    @property
    def middle(self) -> np.ndarray:
        return np.array(self.corners, float).mean(axis=0)

    def clicked(self) -> np.ndarray:
        return directions(np.array(self.click or self.middle))


def directions(pixels: np.ndarray) -> np.ndarray:
    """(..., 3) of columns and rows of a panorama 1568 wide."""
    azimuth = pixels[..., 0] / WIDE * 2 * np.pi - np.pi
    elevation = np.pi / 2 - pixels[..., 1] / WIDE * 2 * np.pi
    level = np.cos(elevation)
    return np.stack([level * np.sin(azimuth), np.sin(elevation), -level * np.cos(azimuth)], -1)


def views_of(thing: Thing, count: int = FRAMES) -> list[View]:
    """The object enters on the right of the middle and leaves on its left."""
    x, y, z = directions(thing.middle)
    azimuth, elevation = np.rad2deg([np.arctan2(x, -z), np.arcsin(y)])
    way_deg = 0.22 * thing.fov_deg
    focal = SIZE[0] / 2 / np.tan(np.deg2rad(thing.fov_deg) / 2)
    found = []
    for k, part in enumerate(np.linspace(-1, 1, count)):
        shake = thing.shakes_deg * np.sin([0.9 * k, 0.53 * k + 1, 0.71 * k + 2])
        heading = azimuth + (0 if thing.slides else part * way_deg) + 0.3 * shake[0]
        turn = Rotation.from_heading_pitch_roll(
            *np.deg2rad([heading, elevation + shake[1], shake[2]])
        )
        shift = -part * focal * np.tan(np.deg2rad(way_deg)) if thing.slides else 0.0
        found.append(
            View(
                name="left",
                position=(0, 0, 0),
                world_from_camera=turn,
                fov_deg=thing.fov_deg,
                width_px=SIZE[0],
                height_px=SIZE[1],
                shift_px=float(shift),
            )
        )
    return found


def seen(pixels: np.ndarray, view: View) -> np.ndarray:
    rays = view.rays()
    height, width = pixels.shape[:2]
    column = (np.arctan2(rays[..., 0], -rays[..., 2]) / (2 * np.pi) + 0.5) * width - 0.5
    row = (0.5 - np.arcsin(rays[..., 1]) / np.pi) * height - 0.5
    return cv2.remap(
        pixels,
        column.astype(np.float32),
        row.astype(np.float32),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_WRAP,
    )


def true_box(thing: Thing, view: View) -> Box:
    column, row, _ = view.project(thing.outline())
    return Box(
        x=float(column.min()),
        y=float(row.min()),
        width=float(np.ptp(column)),
        height=float(np.ptp(row)),
    )


class PannedFrames:
    """What the virtual camera sees, as frames of a video."""

    def __init__(self, folder: Path, thing: Thing) -> None:
        data = cv2.imread(str(folder / f"pannellum_{thing.panorama}.jpg"))
        self.pixels = np.ascontiguousarray(data[..., ::-1])
        self.name, self.fps, self.size_px = thing.name, 25.0, SIZE
        self.views = views_of(thing)
        self.count = len(self.views)

    def frame(self, number):
        return seen(self.pixels, self.views[number])

    def frames_from(self, number):
        for at in range(number, self.count):
            yield at, self.frame(at)


CORRELATOR = "alma-correlator-facility"
THINGS = (
    Thing(panorama="lascar", name="rock", corners=((674, 471), (775, 524)), is_round=True),
    Thing(
        panorama="lascar",
        name="backpack",
        slides=True,
        corners=((962, 529), (1028, 538), (1031, 575), (1003, 573), (944, 553)),
    ),
    Thing(
        panorama="alma", name="pad", corners=((725, 417), (891, 445)), is_round=True, slides=True
    ),
    Thing(
        panorama="alma",
        name="slab",
        corners=((393, 416), (497, 413), (491, 427)),
        fov_deg=40,
        click=(470, 418),
        shakes_deg=0.5,
    ),
    Thing(
        panorama="bma-0",
        name="wall",
        fov_deg=70,
        slides=True,
        click=(1318, 330),
        corners=((1279, 241), (1355, 248), (1355, 404), (1279, 405)),
    ),
    Thing(
        panorama="bma-0",
        selectable=False,
        name="gray door",
        corners=((733, 387), (748, 421)),
        fov_deg=20,
    ),
    Thing(panorama=CORRELATOR, name="door", corners=((953, 357), (1038, 467)), shakes_deg=0.5),
    Thing(
        panorama=CORRELATOR,
        name="sign",
        corners=((101, 360), (123, 432)),
        fov_deg=40,
        click=(112, 385),
        slides=True,
    ),
    Thing(
        panorama=CORRELATOR,
        name="lamp",
        fov_deg=50,
        slides=True,
        corners=((943, 298), (1057, 298), (1064, 317), (938, 316)),
    ),
    Thing(
        panorama=CORRELATOR,
        name="light",
        fov_deg=50,
        shakes_deg=0.5,
        corners=((672, 305), (696, 260), (760, 268), (738, 308)),
    ),
    Thing(
        panorama=CORRELATOR,
        selectable=False,
        name="exit",
        corners=((987, 350), (1002, 362)),
        fov_deg=20,
        slides=True,
        click=(990, 352),
    ),
    Thing(
        panorama="jfk",
        name="pedestal",
        fov_deg=70,
        shakes_deg=0.5,
        click=(690, 520),
        corners=((636, 514), (652, 479), (777, 477), (797, 513), (716, 566)),
    ),
    Thing(
        panorama="jfk", name="suitcase", corners=((1268, 452), (1300, 501)), fov_deg=30, slides=True
    ),
    Thing(
        panorama="from-tree",
        selectable=False,
        name="drain",
        corners=((577, 491), (602, 503)),
        is_round=True,
        fov_deg=20,
    ),
)
