import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.frames import Rotation
from panokit.sphere import (
    ANGULAR,
    MIRROR_BALL,
    PROJECTIONS,
    SKY_DOME,
    Cubemap,
    Equirectangular,
    Octahedral,
    Perspective,
    join_faces,
    pixel_grid,
    split_faces,
)
from panokit.sphere.cubemap import FACES, LAYOUTS

NORTH, SOUTH, EAST, WEST = (0, 0, -1), (0, 0, 1), (1, 0, 0), (-1, 0, 0)
UP, DOWN = (0, 1, 0), (0, -1, 0)


def size_of(projection, long_side=96):
    width = long_side if projection.aspect >= 1 else round(long_side * projection.aspect)
    return width, round(width / projection.aspect)


def shown_at(projection, x, y, size=None):
    """The direction in the middle of a picture (0.5, 0.5) or elsewhere, x right and y down."""
    width, height = size or size_of(projection)
    column, row = np.array(x * width - 0.5), np.array(y * height - 0.5)
    return projection.directions(column, row, width, height)[0]


# What each picture shows where: the conventions, written out.
BEACONS = [
    (Equirectangular(), {(0.5, 0.5): NORTH, (0.75, 0.5): EAST, (0.25, 0.5): WEST}),
    (Equirectangular(), {(0.5, 0.0): UP, (0.5, 1.0): DOWN, (0.0, 0.5): SOUTH}),
    (Equirectangular(aspect=1.0), {(0.5, 0.5): NORTH, (0.75, 0.5): EAST, (0.3, 0.0): UP}),
    (Perspective(fov_deg=90), {(0.5, 0.5): NORTH, (1.0, 0.5): (1, 0, -1), (0.5, 0.0): (0, 1, -1)}),
    (MIRROR_BALL, {(0.5, 0.5): SOUTH, (0.5 + np.sqrt(0.125), 0.5): EAST}),
    (MIRROR_BALL, {(0.5, 0.5 - np.sqrt(0.125)): UP, (1.0, 0.5): NORTH, (0.5, 1.0): NORTH}),
    (ANGULAR, {(0.5, 0.5): NORTH, (0.75, 0.5): EAST, (0.5, 0.25): UP, (1.0, 0.5): SOUTH}),
    (SKY_DOME, {(0.5, 0.5): UP, (0.5, 0.0): NORTH, (1.0, 0.5): EAST, (0.5, 1.0): SOUTH}),
    (Octahedral(), {(0.5, 0.5): UP, (1.0, 0.5): EAST, (0.5, 1.0): SOUTH, (0.0, 0.0): DOWN}),
    (Octahedral(equal_area=True), {(0.5, 0.5): UP, (1.0, 0.5): EAST, (1.0, 1.0): DOWN}),
    (Cubemap(), {(1.5 / 4, 0.5): NORTH, (2.5 / 4, 0.5): EAST, (0.5 / 4, 0.5): WEST}),
    (Cubemap(), {(1.5 / 4, 0.5 / 3): UP, (1.5 / 4, 2.5 / 3): DOWN, (3.5 / 4, 0.5): SOUTH}),
    (Cubemap(layout="vertical-cross"), {(0.5, 3.5 / 4): SOUTH, (0.5, 0.5 / 4): UP}),
    (Cubemap(layout="row"), {(0.5 / 6, 0.5): EAST, (4.5 / 6, 0.5): NORTH}),
    (Cubemap(layout="column"), {(0.5, 1.5 / 6): WEST, (0.5, 5.5 / 6): SOUTH}),
    (Cubemap(layout="grid"), {(0.5, 0.25): WEST, (0.5, 0.75): NORTH}),
]  # fmt: skip


@pytest.mark.parametrize(("projection", "beacons"), BEACONS)
def test_each_picture_shows_the_directions_that_its_convention_says(projection, beacons):
    for (x, y), expected in beacons.items():
        unit = np.array(expected) / np.linalg.norm(expected)
        shown = shown_at(projection, np.clip(x, 1e-9, 1 - 1e-9), np.clip(y, 1e-9, 1 - 1e-9))
        np.testing.assert_allclose(shown, unit, atol=1e-3)


def test_a_vertical_cross_folds_where_its_faces_touch():
    # The back face hangs upside down below "down": across their edge nothing jumps.
    cross = Cubemap(layout="vertical-cross")
    for x in (0.4, 0.5, 0.6):
        above = shown_at(cross, x, 0.75 - 1e-6)
        below = shown_at(cross, x, 0.75 + 1e-6)
        np.testing.assert_allclose(above, below, atol=1e-4)


@pytest.mark.parametrize("name", PROJECTIONS)
def test_what_a_disc_or_a_cross_does_not_show_is_masked(name):
    projection = PROJECTIONS[name]
    width, height = size_of(projection)
    share = pixel_grid(projection, width, height)[1].mean()
    disc = np.pi / 4
    expected = {"mirror-ball": disc, "angular": disc, "sky-dome": disc,
                "cubemap-horizontal-cross": 0.5, "cubemap-vertical-cross": 0.5}  # fmt: skip
    assert share == pytest.approx(expected.get(name, 1.0), abs=0.01)


def test_equal_area_pixels_cover_equal_solid_angles():
    width = 64
    projection = Octahedral(equal_area=True)
    column, row = np.meshgrid(np.arange(width + 1) - 0.5, np.arange(width + 1) - 0.5)
    corners, _ = projection.directions(column, row, width, width)
    a, b, c, d = corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]
    areas = triangle(a, b, c) + triangle(a, c, d)
    # Two flat triangles approximate each curved cell, worst at the poles.
    np.testing.assert_allclose(areas, 4 * np.pi / width**2, rtol=0.12)
    assert areas.sum() == pytest.approx(4 * np.pi, rel=1e-3)


def triangle(a, b, c):
    # Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
    volume = np.abs(np.sum(a * np.cross(b, c), axis=-1))
    cosines = np.sum(a * b, -1) + np.sum(b * c, -1) + np.sum(c * a, -1)
    return 2 * np.arctan2(volume, 1 + cosines)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_faces_join_and_split(layout):
    rng = np.random.default_rng(0)
    faces = {name: rng.random((8, 8, 3), np.float32) for name in FACES}
    parted = split_faces(join_faces(faces, layout), layout)
    for name, face in faces.items():
        np.testing.assert_array_equal(parted[name], face)


def test_bad_cubemaps_are_refused():
    with pytest.raises(UsageError, match="No cubemap layout 'star'"):
        Cubemap(layout="star")
    with pytest.raises(UsageError, match="4 by 3 square faces; 65x48 is not"):
        split_faces(np.zeros((48, 65, 3), np.float32))
    with pytest.raises(UsageError, match="squares of one size"):
        join_faces({name: np.zeros((4, 5, 3), np.float32) for name in FACES})
    with pytest.raises(UsageError, match="has the faces"):
        join_faces({"front": np.zeros((4, 4, 3), np.float32)})


def test_a_view_must_be_narrower_than_half_the_sphere():
    with pytest.raises(UsageError, match="180"):
        Perspective(fov_deg=180)
    with pytest.raises(UsageError, match="at least one pixel"):
        pixel_grid(Equirectangular(), 0, 0)


def test_what_is_behind_a_camera_is_not_in_its_picture():
    view = Perspective(fov_deg=60, sphere_from_camera=Rotation.about_axis((0, 1, 0), 0.2))
    _, _, inside = view.pixel(np.array([[0.2, 0, 1], [-0.2, 0, -1.0]]), 64, 64)
    assert inside.tolist() == [False, True]
