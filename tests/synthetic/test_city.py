import math
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from panokit.frames import azimuth_elevation_from_direction
from panokit.sphere import energy, row_solid_angles
from panokit.sun import SUN_SOLID_ANGLE, sun_direction
from panokit.synthetic import CitySettings
from panokit.synthetic.building_site import build_place
from panokit.synthetic.city import PlacePlan
from panokit.synthetic.materials import Texture
from panokit.synthetic.places import _PLANNERS, plan_place
from panokit.synthetic.render import sun_picture
from panokit.synthetic.scene import write_ply
from panokit.synthetic.shots import plan_shots
from panokit.synthetic.sky import (
    Sky,
    night_sky,
    overcast_sky,
    with_clouds,
)
from panokit.synthetic.textures import _PATTERNS, paint


@pytest.mark.parametrize("kind", list(_PLANNERS))
def test_plans_depend_on_kind_and_seed_alone(kind):
    assert plan_place(kind, 3) == plan_place(kind, 3)
    assert plan_place(kind, 3) != plan_place(kind, 4)


@pytest.mark.parametrize("kind", list(_PLANNERS))
def test_camera_stands_free(kind):
    plan = plan_place(kind, 5)
    x, y, z = plan.camera_m
    assert 1.5 < y < 3
    for building in plan.buildings:
        # The camera is on the street side of every front.
        normal = np.array([math.sin(building.right_turn), math.cos(building.right_turn)])
        to_camera = np.array([x - building.left_x_m, z - building.left_z_m])
        assert normal @ to_camera > 1.0


def corner_of(kind: str, seed: int) -> PlacePlan:
    """A place with few buildings and one thing of each kind, quick to build."""
    plan = plan_place(kind, seed)
    things = {thing.kind: thing for thing in plan.things}
    return replace(plan, buildings=plan.buildings[:2], things=tuple(things.values()))


def test_built_meshes_are_sound_and_equal_for_equal_plans():
    plan = corner_of("old-town", 2)
    meshes = build_place(plan, night=True, rig=True)
    again = build_place(plan, night=True, rig=True)
    assert list(meshes) == list(again)
    assert any(material.glow for material in meshes)
    for material, mesh in meshes.items():
        assert np.isfinite(mesh.vertices).all()
        assert mesh.triangles.min() >= 0
        assert mesh.triangles.max() < len(mesh.vertices)
        np.testing.assert_array_equal(mesh.vertices, again[material].vertices)


def test_only_the_picture_has_the_rig():
    plan = corner_of("square", 2)

    def nearest(rig):
        meshes = build_place(plan, night=False, rig=rig)
        camera = np.array(plan.camera_m)
        turn = math.radians(plan.street_azimuth_deg)
        camera = np.array([
            camera[0] * math.cos(turn) - camera[2] * math.sin(turn), camera[1],
            camera[0] * math.sin(turn) + camera[2] * math.cos(turn),
        ])  # fmt: skip
        return min(np.linalg.norm(m.vertices - camera, axis=1).min() for m in meshes.values())

    assert nearest(rig=True) < 0.4
    assert nearest(rig=False) > 1.0


@pytest.mark.parametrize("pattern", list(_PATTERNS))
def test_textures_are_repeatable_and_not_flat(pattern):
    recipe = Texture(pattern=pattern, width_px=64, height_px=48, color=(0.4, 0.3, 0.2), seed=4)
    picture = paint(recipe)
    assert picture.shape == (48, 64, 3)
    np.testing.assert_array_equal(picture, paint(recipe))
    assert picture.std() > 1


def test_mesh_files_hold_what_the_header_says(tmp_path):
    mesh = next(iter(build_place(corner_of("square", 1), night=False, rig=False).values()))
    write_ply(mesh, tmp_path / "mesh.ply")
    data = (tmp_path / "mesh.ply").read_bytes()
    header, body = data.split(b"end_header\n", 1)
    assert f"element vertex {len(mesh.vertices)}".encode() in header
    assert len(body) == 20 * len(mesh.vertices) + 13 * len(mesh.triangles)
    np.testing.assert_array_equal(np.frombuffer(body, "<f4", 3), mesh.vertices[0])


def test_sun_stands_where_the_almanac_says():
    # Equinox, local noon at 28 W: due south, 90 - 44.5 degrees up, within the equation of time.
    noon = sun_direction(44.5, -28.0, datetime(2025, 3, 20, 13, 59, tzinfo=UTC))
    azimuth, elevation = np.degrees(azimuth_elevation_from_direction(noon))
    assert abs(azimuth) == pytest.approx(180, abs=1.0)
    assert elevation == pytest.approx(45.5, abs=0.3)
    morning = sun_direction(44.5, -28.0, datetime(2025, 3, 20, 9, 0, tzinfo=UTC))
    assert morning[0] > 0.5, "in the morning the sun is in the east"


@pytest.mark.parametrize("width_px", [16, 256, 1024])
@pytest.mark.parametrize("elevation", [0.1, 0.7, 1.5])
def test_sun_in_a_picture_has_its_exact_solid_angle(width_px, elevation):
    direction = np.array(
        [math.cos(elevation) * 0.6, math.sin(elevation), -math.cos(elevation) * 0.8]
    )
    covered = sun_picture(direction, width_px)
    assert energy(covered)[0] == pytest.approx(SUN_SOLID_ANGLE, rel=1e-5)


def test_overcast_sky_is_three_times_as_bright_overhead():
    radiance = overcast_sky(1).radiance
    half = radiance.shape[0] // 2
    top = np.average(
        radiance[: half // 8].mean(axis=(1, 2)), weights=row_solid_angles(2 * half)[: half // 8]
    )
    horizon = radiance[half - 8 : half].mean()
    assert 2.4 < top / horizon < 3.4


def test_night_is_dark_and_has_no_sun():
    night = night_sky(1)
    assert night.sun_direction is None
    assert night.radiance.mean() < 0.05 * overcast_sky(1).radiance.mean()


def test_clouds_leave_the_sun_a_gap():
    toward = np.array([0.0, math.sin(0.6), -math.cos(0.6)])
    clear = Sky(
        radiance=np.full((512, 1024, 3), 0.5, np.float32),
        sun_direction=toward,
        sun_radiance=np.full(3, 1e5),
    )
    for seed in range(2):
        cloudy = with_clouds(clear, seed)
        assert cloudy.sun_radiance[0] > 0.5e5
        assert cloudy.radiance[:256].std() > 0.1, "there are clouds"


def test_shots_are_the_same_whatever_the_count_and_mix_the_weather():
    eight = plan_shots(CitySettings(count=8, seed=3))
    assert plan_shots(CitySettings(count=2, seed=3)) == eight[:2]
    weathers = [shot.weather for shot in eight]
    assert weathers.count("overcast") == weathers.count("night") == 2
    assert len({shot.capture.id for shot in eight}) == 8
    for shot in eight:
        capture = shot.capture
        sun = sun_direction(capture.latitude_deg, capture.longitude_deg, capture.time)
        assert (sun[1] > 0.3) == (shot.weather != "night")
        assert capture.details["synthetic"] is True
