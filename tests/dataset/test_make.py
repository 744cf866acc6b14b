"""A sample: drawn from its number, aligned with its camera, exposed as a camera would, complete."""

import json
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from panokit.capture import Capture, license_from_spdx
from panokit.dataset.make import aligned_light, build_scene, make_sample
from panokit.dataset.photograph import blurred_background, metered_exposure
from panokit.dataset.plan import draw_plan
from panokit.dataset.renderers import make_renderer
from panokit.dataset.sample import SPLITS
from panokit.dataset.settings import DatasetSettings, ObjectSettings, RigSettings
from panokit.dataset.splits import split_of_index
from panokit.dataset.stock import open_stock
from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.io import read_exr, write_environment_map
from panokit.sphere import energy, equirect_pixel

PLACES = 6
SETTINGS = DatasetSettings(
    renderer="analytic", samples=4, objects=ObjectSettings(per_kind=3, kinds=("chair", "vase")),
    rig=RigSettings(width_px=32), validation_share=0.2, test_share=0.2, hdr=True,
)  # fmt: skip


@pytest.fixture(scope="module")
def stock(tmp_path_factory):
    folder = tmp_path_factory.mktemp("maps")
    for number in range(PLACES):
        rng = np.random.default_rng(number)
        radiance = rng.uniform(0.2, 1, (32, 64, 3)).astype(np.float32)
        radiance[6, 10 * number : 10 * number + 2] = 60
        capture = Capture(provider="test", id=f"m{number}", place=f"place {number}",
                          license=license_from_spdx("CC0-1.0", "Somebody"))  # fmt: skip
        write_environment_map(
            EnvironmentMap(radiance=radiance, capture=capture), folder / f"m{number}.exr"
        )
    return open_stock(SETTINGS, [folder])


def first(stock, changes=None, **plan_changes):
    """The first sample that is usable."""
    chosen = SETTINGS.model_copy(update=changes or {})
    for index in range(20):
        try:
            plan = replace(draw_plan(chosen, stock, index), **plan_changes)
            return make_sample(plan, chosen, stock, make_renderer("analytic"))
        except ImageError:
            continue
    raise AssertionError("no sample of twenty is usable")


def image(sample, name):
    return cv2.imdecode(np.frombuffer(sample.members[name], np.uint8), cv2.IMREAD_UNCHANGED)


def radiance(sample, name, tmp_path):
    (tmp_path / name).write_bytes(sample.members[name])
    return read_exr(tmp_path / name)[0]


def test_a_plan_depends_on_its_number_alone(stock):
    assert repr(draw_plan(SETTINGS, stock, 7)) == repr(draw_plan(SETTINGS, stock, 7))
    assert draw_plan(SETTINGS, stock, 7).render_seed != draw_plan(SETTINGS, stock, 8).render_seed
    again = draw_plan(SETTINGS, stock, 7, attempt=1)
    assert again.split == draw_plan(SETTINGS, stock, 7).split == split_of_index(SETTINGS, 7)
    assert again.render_seed != draw_plan(SETTINGS, stock, 7).render_seed


def test_places_and_objects_stay_in_their_split(stock):
    seen = {split: (set(), set()) for split in SPLITS}
    for index in range(60):
        plan = draw_plan(SETTINGS, stock, index)
        seen[plan.split][0].add(stock.lights.all[plan.probe_id].place)
        seen[plan.split][1].add(plan.object_id)
    for one in SPLITS:
        for other in SPLITS:
            if one < other:
                assert not seen[one][0] & seen[other][0]
                assert not seen[one][1] & seen[other][1]


def test_every_material_is_on_some_part(stock):
    many = SETTINGS.model_copy(
        update={"objects": SETTINGS.objects.model_copy(update={"materials": 3})}
    )
    counts = set()
    for index in range(30):
        plan = draw_plan(many, stock, index)
        assert set(plan.material_of_part) == set(range(len(plan.materials)))
        scene = build_scene(plan, stock)
        assert scene.mesh.part_count == len(plan.materials)
        counts.add(len(plan.materials))
    assert counts == {1, 2, 3}


def test_a_sample_has_every_member_and_equal_bytes_when_made_again(stock):
    sample = first(stock)
    names = {
        f"{view}{end}"
        for view in ("left", "right")
        for end in (".png", "_object.png", "_mask.png", "_normal.exr", "_depth.exr", ".exr")
    }
    names |= {"background.png", "env64.exr", "env.exr", "reflectance.exr", "albedo.exr",
              "meta.json"}  # fmt: skip
    assert set(sample.members) == names
    assert first(stock).members == sample.members


def test_turned_in_cameras_have_a_background_each(stock):
    rig = SETTINGS.rig.model_copy(update={"toe_in": True})
    sample = first(stock, {"rig": rig})
    left, right = image(sample, "background.png"), image(sample, "right_background.png")
    assert not np.array_equal(left, right)


def test_normals_are_unit_and_depth_is_positive_on_the_object(stock, tmp_path):
    sample = first(stock)
    normal = radiance_of_normals(sample, tmp_path)
    depth_file = tmp_path / "depth.exr"
    depth_file.write_bytes(sample.members["left_depth.exr"])
    seen = np.abs(normal).sum(axis=-1) > 0
    np.testing.assert_allclose(np.linalg.norm(normal[seen], axis=-1), 1, atol=2e-3)
    assert seen.mean() == pytest.approx(image(sample, "left_mask.png").mean() / 255, abs=0.05)


def radiance_of_normals(sample, tmp_path):
    import OpenEXR

    path = tmp_path / "normal.exr"
    path.write_bytes(sample.members["left_normal.exr"])
    with OpenEXR.File(str(path)) as file:
        return file.channels()["RGB"].pixels.astype(np.float32)


def test_the_target_has_the_energy_of_the_aligned_map(stock, tmp_path):
    sample = first(stock)
    aligned = radiance(sample, "env.exr", tmp_path)
    target = radiance(sample, "env64.exr", tmp_path)
    assert target.shape == (64, 64, 3)
    np.testing.assert_allclose(energy(target), energy(aligned), rtol=1e-4)
    assert sample.figures["energy_kept"] == pytest.approx(1, abs=1e-3)


@settings(max_examples=20, deadline=None)
@given(st.floats(-180, 180), st.floats(-60, 60), st.floats(-40, 40))
def test_a_beacon_straight_ahead_is_in_the_center(heading, pitch, roll):
    world_from_camera = Rotation.from_heading_pitch_roll(*np.deg2rad([heading, pitch, roll]))
    ahead = world_from_camera.apply(np.array([0.0, 0.0, -1.0]))
    column, row = equirect_pixel(ahead, 256, 128)
    light = np.zeros((128, 256, 3), np.float32)
    light[int(np.rint(row)) % 128, int(np.rint(column)) % 256] = 100
    aligned = aligned_light(EnvironmentMap(radiance=light), world_from_camera).radiance
    np.testing.assert_allclose(energy(aligned), energy(light), rtol=1e-3)
    found_row, found_column = np.unravel_index(aligned[..., 0].argmax(), (128, 256))
    # The beacon's own pixel may be off by half of one, and it lands between four.
    assert abs(found_column - 127.5) <= 1.5
    assert abs(found_row - 63.5) <= 1.5


def test_yaw_turns_clockwise_and_tilt_moves_the_zenith(stock):
    from panokit.dataset.make import world_from_map

    plan = replace(draw_plan(SETTINGS, stock, 0), yaw_deg=90.0, tilt_deg=0.0)
    north = np.array([0.0, 0.0, -1.0])
    np.testing.assert_allclose(world_from_map(plan).apply(north), [1, 0, 0], atol=1e-12)
    tilted = replace(plan, tilt_deg=30.0, tilt_toward_deg=90.0)
    up = world_from_map(tilted).apply(np.array([0.0, 1.0, 0.0]))
    toward_east = direction_from_azimuth_elevation(np.pi / 2, np.deg2rad(60))
    np.testing.assert_allclose(up, toward_east, atol=1e-12)


def test_exposure_does_not_depend_on_the_unit_of_the_map():
    picture = np.random.default_rng(0).lognormal(0, 1, (8, 8, 3))
    coverage = np.zeros((8, 8))
    coverage[2:6, 2:6] = 1
    once = metered_exposure(picture, coverage)
    assert metered_exposure(1000 * picture, coverage) == pytest.approx(once / 1000)
    assert metered_exposure(np.full((8, 8, 3), 0.18), coverage) == pytest.approx(1.0)


def test_linear_members_are_on_the_scale_of_the_pictures(stock, tmp_path):
    sample = first(stock)
    linear = radiance(sample, "left.exr", tmp_path)
    shown = image(sample, "left.png")[..., ::-1] / 255.0
    clipped = np.clip(linear, 0, 1)
    curve = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(shown, curve, atol=0.5 / 255 + 1e-6)


def test_a_background_is_blurred_with_its_energy():
    sharp = np.zeros((64, 128, 3), np.float32)
    sharp[20, 30] = 10
    blurred = blurred_background(sharp, 10.0)
    assert blurred.shape == (18, 36, 3)
    np.testing.assert_allclose(energy(blurred), energy(sharp), rtol=1e-4)
    assert blurred_background(sharp, 0) is sharp


def test_an_object_in_the_dark_is_rejected(stock):
    with pytest.raises(ImageError) as caught:
        for index in range(10):
            plan = replace(draw_plan(SETTINGS, stock, index), exposure_stops=-12.0)
            make_sample(plan, SETTINGS, stock, make_renderer("analytic"))
    assert caught.value.reason == "under-exposed"


def test_a_burnt_out_object_is_rejected(stock):
    with pytest.raises(ImageError) as caught:
        plan = replace(draw_plan(SETTINGS, stock, 0), exposure_stops=12.0)
        make_sample(plan, SETTINGS, stock, make_renderer("analytic"))
    assert caught.value.reason == "over-exposed"


def test_meta_says_whose_light_and_object_it_is(stock):
    meta = json.loads(first(stock).members["meta.json"])
    assert meta["schema"] == "panokit.sample/1"
    assert meta["probe"]["license"] == "CC0-1.0"
    assert meta["probe"]["kind"] == "native"
    assert meta["object"]["license"]
    assert meta["views"]["left"]["intrinsics_px"][0][0] > 0
    assert meta["exposure"] > 0
