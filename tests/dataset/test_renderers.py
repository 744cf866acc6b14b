"""What every renderer must show: energy, directions, disparity, normals, depth, materials."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import uniform_filter

from panokit.dataset.materials import draw_texture
from panokit.dataset.renderers import make_renderer
from panokit.dataset.renderers.analytic import sphere_normals
from panokit.dataset.renderers.raster import look
from panokit.dataset.renderers.texturing import box_coordinates, texture_at
from panokit.dataset.scene import NO_DEPTH, Mesh, Quality
from panokit.errors import PanokitError, SettingsError
from tests.dataset.scenes import (
    GLOSSY,
    WHITE,
    ball,
    boxes,
    masked_mean,
    scene,
    sun_light,
    uniform_light,
    view,
)

QUALITY = Quality(samples=64, bounces=4)


@pytest.fixture(
    scope="module",
    params=[
        "analytic",
        pytest.param("mitsuba", marks=pytest.mark.render),
        pytest.param("blender", marks=pytest.mark.tool),
    ],
)
def renderer(request):
    try:
        made = make_renderer(request.param)
    except PanokitError as error:
        if request.param != "blender":
            raise
        pytest.skip(str(error))
    yield made
    if hasattr(made, "close"):
        made.close()


def test_a_white_object_in_a_uniform_map_has_the_map_s_radiance(renderer):
    (seen,) = renderer.render(scene(ball(), uniform_light(2.0), WHITE), (view(),), QUALITY, 1)
    assert masked_mean(seen.radiance, seen.coverage) == pytest.approx([2.0] * 3, rel=0.02)


def test_radiance_grows_with_the_light(renderer):
    pictures = [
        renderer.render(scene(ball(), uniform_light(level), GLOSSY), (view(),), QUALITY, 1)[0]
        for level in (1.0, 8.0)
    ]
    assert pictures[1].radiance.sum() == pytest.approx(8 * pictures[0].radiance.sum(), rel=0.01)


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "side"),
    [(90, 0, "right"), (-90, 0, "left"), (180, 80, "top"), (180, -80, "bottom")],
)
def test_the_lit_side_is_the_side_of_the_sun(renderer, azimuth_deg, elevation_deg, side):
    """Azimuth 90 is the right of a camera that looks north, and 180 is behind it."""
    light = sun_light(azimuth_deg, elevation_deg, sky=0.05)
    (seen,) = renderer.render(scene(ball(), light, GLOSSY), (view(),), QUALITY, 2)
    gray = seen.radiance.mean(axis=2)
    halves = {"left": gray[:, :24], "right": gray[:, 24:], "top": gray[:24], "bottom": gray[24:]}
    other = {"left": "right", "right": "left", "top": "bottom", "bottom": "top"}[side]
    assert halves[side].sum() > 3 * halves[other].sum()


def test_the_highlight_lies_where_the_sun_is_mirrored(renderer):
    light = sun_light(130, 25, sky=0.01)
    shiny = replace(GLOSSY, base_color=(0.9, 0.9, 0.9), metallic=0.99, roughness=0.2)
    camera = view(distance_m=6, fov_deg=12, width_px=64)
    (seen,) = renderer.render(scene(ball(), light, shiny), (camera,), QUALITY, 3)
    row, column = np.unravel_index(seen.radiance.sum(axis=2).argmax(), (64, 64))
    azimuth, elevation = np.deg2rad([130, 25])
    toward = np.array(
        [
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
            -np.cos(elevation) * np.cos(azimuth),
        ]
    )
    half = np.add(toward, [0, 0, 1])
    half /= np.linalg.norm(half)
    expected = camera.project(0.5 * half)
    assert (column + 0.5, row + 0.5) == pytest.approx(expected[:2], abs=2.5)


def test_points_lie_in_the_same_row_and_further_right_in_the_left_view(renderer):
    left, right = view(side_m=-0.15), view(side_m=0.15, name="right")
    seen = renderer.render(
        scene(boxes(), uniform_light(), WHITE, GLOSSY, GLOSSY), (left, right), QUALITY, 4
    )
    rows = [np.flatnonzero(one.coverage.sum(axis=1) > 0.5) for one in seen]
    assert np.array_equal(rows[0], rows[1])
    # Every center of the left view, carried over by its depth, is found in the right view.
    there = seen[0].part > 0
    along = -left.world_from_camera.inverse.apply(left.rays())[..., 2]
    reach = np.where(there, seen[0].depth, 1) / along
    column, row, depth = right.project(np.asarray(left.position) + left.rays() * reach[..., None])
    disparity = np.arange(48)[None] + 0.5 - column
    assert (disparity[there] > 1).all()
    assert row[there] == pytest.approx((np.indices((48, 48))[0] + 0.5)[there], abs=1e-3)
    at = np.clip(np.floor(column).astype(int), 0, 47)
    rows_at = np.indices((48, 48))[0]
    agrees = np.abs(seen[1].depth[rows_at, at] - depth) < 0.05
    assert agrees[there].mean() > 0.8


def test_normals_are_unit_and_turn_with_the_camera(renderer):
    around = [view(), view(heading_deg=70, pitch_deg=-25)]
    normals = []
    for camera in around:
        (seen,) = renderer.render(scene(ball(), uniform_light(), WHITE), (camera,), QUALITY, 5)
        there = seen.part > 0
        assert np.linalg.norm(seen.normal[there], axis=1) == pytest.approx(1, abs=1e-3)
        assert not seen.normal[~there].any()
        normals.append(seen.normal)
    # A ball looks the same from everywhere, but for its facets.
    assert np.abs(normals[0] - normals[1]).max() < 0.12
    middle = normals[0][23:25, 23:25].mean(axis=(0, 1))
    assert middle == pytest.approx([0, 0, 1], abs=0.02)
    assert normals[0][24, 36, 0] > 0.3
    assert normals[0][12, 24, 1] > 0.3


def test_depth_is_along_the_view_axis(renderer):
    camera = view(heading_deg=-30, pitch_deg=20)
    (seen,) = renderer.render(scene(ball(), uniform_light(), WHITE), (camera,), QUALITY, 6)
    there = seen.part > 0
    rays = camera.rays()
    along = -camera.world_from_camera.inverse.apply(rays)[..., 2]
    points = np.asarray(camera.position) + rays * (seen.depth / along)[..., None]
    assert np.linalg.norm(points[there], axis=1) == pytest.approx(0.5, abs=3e-3)
    assert (seen.depth[~there] == NO_DEPTH).all()


def test_a_shifted_view_shows_the_object_further_right(renderer):
    what = scene(boxes(), uniform_light(), WHITE, GLOSSY, GLOSSY)
    plain, shifted = renderer.render(what, (view(), view(shift_px=5)), QUALITY, 7)
    assert shifted.coverage[:, 5:] == pytest.approx(plain.coverage[:, :-5], abs=0.25)
    assert shifted.coverage.sum() == pytest.approx(plain.coverage.sum(), rel=0.02)
    assert np.array_equal(shifted.part[:, 5:], plain.part[:, :-5])


def test_each_part_shows_its_material(renderer):
    colors = [(0.7, 0.1, 0.1), (0.1, 0.6, 0.1), (0.1, 0.2, 0.8)]
    materials = [replace(WHITE, base_color=color) for color in colors]
    (seen,) = renderer.render(scene(boxes(), uniform_light(), *materials), (view(),), QUALITY, 8)
    assert set(np.unique(seen.part)) == {0, 1, 2, 3}
    for index, color in enumerate(colors):
        mine = seen.part == index + 1
        assert seen.albedo[mine] == pytest.approx(np.tile(color, (mine.sum(), 1)), abs=0.01)
        inner = mine & (seen.coverage > 0.999)
        brightest = seen.radiance[inner].mean(axis=0).argmax()
        assert brightest == index
    assert not seen.albedo[seen.part == 0].any()


def test_an_object_of_one_part_follows_one_of_three(renderer):
    three = scene(boxes(), uniform_light(), WHITE, GLOSSY, GLOSSY)
    one = scene(ball(), uniform_light(), WHITE)
    first = renderer.render(one, (view(),), QUALITY, 9)[0]
    renderer.render(three, (view(),), QUALITY, 9)
    again = renderer.render(one, (view(),), QUALITY, 9)[0]
    for name in ("radiance", "coverage", "part", "normal", "depth", "albedo"):
        assert np.array_equal(getattr(first, name), getattr(again, name)), name


def test_textures_lie_where_the_box_projection_puts_them(renderer):
    texture = draw_texture(np.random.default_rng(3), (0.6, 0.4, 0.2))
    texture[:40, :60] = (0.05, 0.6, 0.9)
    mesh, camera = boxes(1), view(heading_deg=20, pitch_deg=-15, width_px=64)
    material = replace(WHITE, texture=texture)
    (seen,) = renderer.render(scene(mesh, uniform_light(), material), (camera,), QUALITY, 10)
    hits = look(mesh.vertices, mesh.faces, camera)
    expected = texture_at(material, hits.blend(box_coordinates(mesh)))
    both = (seen.part > 0) & (hits.face >= 0)
    close = np.abs(seen.albedo - expected).max(axis=2) < 0.02
    assert close[both].mean() > 0.95


def test_the_back_of_a_sheet_is_lit_and_faces_the_camera(renderer):
    corners = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    sheet = Mesh(
        vertices=corners, faces=np.array([[0, 2, 1], [0, 3, 2]]), part=np.zeros(2), smooth=False
    )
    (seen,) = renderer.render(scene(sheet, uniform_light(), WHITE), (view(),), QUALITY, 11)
    assert masked_mean(seen.radiance, seen.coverage) == pytest.approx([1.0] * 3, rel=0.05)
    middle = seen.normal[20:28, 20:28].reshape(-1, 3)
    assert middle == pytest.approx(np.tile([0, 0, 1], (64, 1)), abs=1e-3)


def test_a_floor_darkens_away_from_the_sun(renderer):
    what = scene(ball(), sun_light(90, 45), WHITE, floor_m=-0.5)
    camera = view(pitch_deg=-35, distance_m=4)
    (seen,) = renderer.render(what, (camera,), QUALITY, 12)
    (floating,) = renderer.render(replace(what, floor_m=None), (camera,), QUALITY, 12)
    assert floating.shadow is None
    assert seen.shadow.shape == (48, 48, 3)
    assert seen.shadow.min() >= 0 and seen.shadow.max() <= 1
    # The shadow falls to the left, one diameter long, onto the floor at (-0.7, -0.5, 0).
    column, row, _ = camera.project(np.array([[-0.7, -0.5, 0.0], [1.0, -0.5, 0.0]]))
    dark, bright = (seen.shadow[int(r), int(c)].mean() for c, r in zip(column, row, strict=True))
    assert dark < 0.5
    assert bright > 0.8
    # The floor is no part of the object.
    assert seen.coverage == pytest.approx(floating.coverage, abs=0.02)
    assert not seen.radiance[seen.coverage == 0].any()


def test_the_reflectance_map_is_what_a_distant_ball_shows(renderer):
    light = sun_light(120, 35)
    dense = renderer.reflectance(GLOSSY, light, replace(QUALITY, samples=256), 13, 32)
    normals, inside = sphere_normals(32)
    assert dense.shape == (32, 32, 3)
    assert dense.dtype == np.float32
    assert not dense[~inside].any()
    far = view(distance_m=40, fov_deg=float(2 * np.rad2deg(np.arctan(0.5 / 40))), width_px=32)
    (seen,) = renderer.render(
        scene(ball(), light, GLOSSY), (far,), replace(QUALITY, samples=256), 14
    )
    whole = inside & (seen.coverage > 0.999) & (normals[..., 2] > 0.3)
    assert seen.normal[whole] == pytest.approx(normals[whole], abs=0.05)
    ratio = seen.radiance[whole].mean(axis=0) / dense[whole].mean(axis=0)
    assert ratio == pytest.approx([1] * 3, rel=0.02)
    # Averaged a little, as Cycles is noisy.
    gray = [uniform_filter(one.mean(axis=2), 3)[whole] for one in (seen.radiance, dense)]
    assert np.corrcoef(np.log(gray[0]), np.log(gray[1]))[0, 1] > 0.98


def test_the_same_seed_gives_the_same_pixels(renderer):
    what = scene(boxes(), sun_light(30), GLOSSY, WHITE, WHITE)
    few = Quality(samples=4)
    first, again, other = (renderer.render(what, (view(),), few, seed)[0] for seed in (5, 5, 6))
    assert np.array_equal(first.radiance, again.radiance)
    assert np.array_equal(first.coverage, again.coverage)
    if renderer.describe()["name"] != "analytic":
        assert not np.array_equal(first.radiance, other.radiance)


def test_pictures_need_not_be_square(renderer):
    (seen,) = renderer.render(
        scene(ball(), uniform_light(), WHITE), (view(width_px=40, height_px=32),), QUALITY, 1
    )
    assert seen.coverage.shape == (32, 40)
    covered = seen.coverage > 0.5
    assert covered.any(axis=0).sum() == pytest.approx(covered.any(axis=1).sum(), abs=1)


def test_an_unknown_renderer_is_refused():
    with pytest.raises(SettingsError, match="Choose from analytic"):
        make_renderer("povray")
