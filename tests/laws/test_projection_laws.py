"""Every projection: pixel -> direction -> pixel; pictures go on over seams, edges and poles."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.frames import Rotation, angle_between, direction_from_azimuth_elevation
from panokit.sphere import (
    PROJECTIONS,
    Equirectangular,
    Perspective,
    apply_map,
    equirect_directions,
    pixel_grid,
    pixel_map,
    reproject,
)
from panokit.sphere.extension import extend, locate
from panokit.sphere.pixel_map import map_directions

ALL = {**PROJECTIONS, "perspective": Perspective(fov_deg=100, aspect=1.5)}
WHOLE = [name for name in ALL if name not in ("sky-dome", "perspective")]
names = st.sampled_from(sorted(ALL))
directions = st.tuples(st.floats(-np.pi, np.pi), st.floats(-np.pi / 2, np.pi / 2)).map(
    lambda angles: direction_from_azimuth_elevation(*map(np.float64, angles))
)
poses = st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)).map(
    lambda angles: Rotation.from_heading_pitch_roll(*angles)
)


def size_of(projection, scale):
    width = 12 * scale
    return width, round(width / projection.aspect)


def smooth(toward):
    """A picture known in every direction: a few waves, the same on all of the sphere."""
    return (0.5 + 0.4 * np.sin(4 * toward + [0.3, 1.1, 2.0])).astype(np.float32)


@given(names, st.integers(1, 6), st.data())
def test_pixel_to_direction_to_pixel_is_identity(name, scale, data):
    projection = ALL[name]
    width, height = size_of(projection, scale)
    column = np.array([data.draw(st.floats(0, width - 1))])
    row = np.array([data.draw(st.floats(0, height - 1))])
    toward, valid = projection.directions(column, row, width, height)
    back_column, back_row, inside = projection.pixel(toward, width, height)
    assert np.linalg.norm(toward) == pytest.approx(1)
    if valid.all():
        assert inside.all()
        again, _ = projection.directions(back_column, back_row, width, height)
        # Directions are the test: on a seam or in a corner two pixels show the same one.
        assert angle_between(toward, again).max() < 1e-6


@given(names, directions)
def test_direction_to_pixel_to_direction_is_identity(name, toward):
    projection = ALL[name]
    width, height = size_of(projection, 8)
    column, row, inside = projection.pixel(toward[None], width, height)
    if inside.all():
        again, valid = projection.directions(column, row, width, height)
        # A pixel on the very edge of a disc or a face may round to either side of it.
        if valid.all():
            assert angle_between(toward, again).max() < 1e-5
    elif name in WHOLE:
        raise AssertionError(f"{name} shows the whole sphere, but not {toward}")


@settings(deadline=None, max_examples=30)
@given(st.sampled_from(sorted(WHOLE)), poses)
def test_any_projection_reads_back_anywhere_on_the_sphere(name, pose):
    # Through the projection, at directions with no regard to its seams, corners and rims.
    projection = ALL[name]
    width, height = size_of(projection, 40)
    picture = smooth(pixel_grid(projection, width, height)[0])
    turned = pose.apply(equirect_directions(64, 32))
    for interpolation, limit in (("linear", 0.02), ("spline", 0.02)):
        found = map_directions(turned, projection, width, height)
        read = apply_map(picture, found, interpolation=interpolation)
        # A mirror ball squeezes what is behind it into its last pixels, an anamorphic map has
        # coarse columns: those are read with less precision, not wrongly.
        worst = {"mirror-ball": 0.4, "anamorphic": 0.03}.get(name, limit)
        error = np.abs(read - smooth(turned))
        assert error.max() < worst
        assert error.mean() < 0.005


@settings(deadline=None, max_examples=20)
@given(st.sampled_from(sorted(set(WHOLE) - {"mirror-ball"})))
def test_there_and_back_through_any_projection(name):
    source = Equirectangular()
    picture = smooth(equirect_directions(128, 64))
    width, height = size_of(ALL[name], 40)
    there, valid = reproject(picture, source, ALL[name], width, interpolation="spline")
    assert there.shape[:2] == (height, width)
    assert (there[~valid] == 0).all()
    back, whole = reproject(there, ALL[name], source, 128, interpolation="spline")
    assert whole.all()
    assert np.abs(back - picture).max() < 0.03


@settings(deadline=None, max_examples=30)
@given(st.sampled_from(sorted(WHOLE)), st.integers(1, 6))
def test_a_border_goes_on_as_the_sphere_does(name, border):
    projection = ALL[name]
    width, height = size_of(projection, 24)
    picture = smooth(pixel_grid(projection, width, height)[0])
    bordered = extend(picture, projection, border)
    near = equirect_directions(64, 32)
    column, row, _ = locate(near, projection, width, height, border)
    assert (column >= border - 0.51).all()
    assert (column <= bordered.shape[1] - border - 0.49).all()
    assert (row >= border - 0.51).all()
    assert (row <= bordered.shape[0] - border - 0.49).all()


@settings(deadline=None, max_examples=15)
@given(poses)
def test_a_picture_is_continuous_over_seam_and_poles(pose):
    found = pixel_map(Equirectangular(), (256, 128), Equirectangular(), (256, 128), pose)
    for interpolation in ("linear", "spline"):
        picture = smooth(equirect_directions(256, 128))
        turned = apply_map(picture, found, interpolation=interpolation)
        error = np.abs(turned - smooth(pose.inverse.apply(equirect_directions(256, 128))))
        seam = error[:, [0, 1, -2, -1]]
        pole = error[[0, 1, -2, -1]]
        inside = error[32:96, 64:192].max()
        assert seam.max() <= 1.6 * inside + 1e-5
        assert pole.max() <= 1.6 * inside + 1e-5
