"""Copies are found at any yaw, size and exposure; other places are not taken for copies."""

from dataclasses import replace

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.frames import Rotation
from panokit.qa.sets import find_near_duplicates, measure
from panokit.qa.sets.duplicates import Likeness
from panokit.qa.sets.store import description_of
from panokit.sphere import resize, rotate


def described(envmap):
    return description_of(measure(envmap))


def a_map(scenes, seed):
    return EnvironmentMap(radiance=scenes(seed, width=256))


def turned(envmap, yaw_deg):
    return rotate(envmap, Rotation.about_axis((0, 1, 0), np.deg2rad(yaw_deg)))


@pytest.fixture
def others(scenes):
    return [described(a_map(scenes, seed)) for seed in range(20, 30)]


def test_other_places_are_not_duplicates(others):
    assert find_near_duplicates([f"m{i}" for i in range(10)], others) == []


@pytest.mark.parametrize(
    "change",
    [
        lambda m: turned(m, 73.3),
        lambda m: resize(m, 128),
        lambda m: m.with_changes(radiance=m.radiance * np.float32(5)),
        lambda m: m.with_changes(radiance=np.minimum(m.radiance, 0.8)),
        lambda m: turned(resize(m, 128), -120),
    ],
    ids=["yaw", "size", "exposure", "clipped", "yaw and size"],
)
def test_a_changed_copy_is_found_among_others(scenes, others, change):
    original = a_map(scenes, 3)
    maps = [*others, described(original), described(change(original))]
    names = [*(f"m{i}" for i in range(10)), "original", "copy"]
    found = find_near_duplicates(names, maps)
    assert [(pair.first, pair.second) for pair in found] == [("original", "copy")]
    assert found[0].likeness is Likeness.COPY and not found[0].mirrored
    assert found[0].correlation > 0.8


def test_the_yaw_of_a_copy_is_told(scenes):
    original = a_map(scenes, 3)
    pair = find_near_duplicates(
        ["turned", "original"], [described(turned(original, -60)), described(original)]
    )[0]
    # About the vertical a positive angle turns to the left, seen from inside.
    assert pair.yaw_deg == pytest.approx(60, abs=1)


def test_mirror_images_are_found(scenes):
    original = a_map(scenes, 3)
    mirrored = original.with_changes(radiance=np.ascontiguousarray(original.radiance[:, ::-1]))
    pair = find_near_duplicates(["a", "b"], [described(original), described(mirrored)])[0]
    assert pair.mirrored and pair.likeness is Likeness.COPY


def test_a_sky_over_another_ground_is_half_a_copy(scenes):
    random = np.random.default_rng(5)
    clouds = random.uniform(0.3, 1.5, (32, 64, 1)).repeat(4, 0).repeat(4, 1)
    one, other = (a_map(scenes, seed).radiance.copy() for seed in (3, 4))
    one[:64], other[:64] = clouds[:64], clouds[:64]
    one[64:] *= random.uniform(0.3, 1.6, (64, 256, 1))
    other[64:] *= random.uniform(0.3, 1.6, (64, 256, 1))
    pairs = find_near_duplicates(
        ["a", "b"], [described(EnvironmentMap(radiance=x.astype(np.float32))) for x in (one, other)]
    )
    assert [pair.likeness for pair in pairs] == [Likeness.UPPER]


def test_known_pairs_are_left_out(scenes):
    same = described(a_map(scenes, 3))
    assert find_near_duplicates(["a", "b"], [same, same], apart=[(1, 0)]) == []
    assert len(find_near_duplicates(["a", "b", "c"], [same, same, same], apart=[(0, 1)])) == 2


def test_featureless_maps_are_no_duplicates():
    grey = [described(EnvironmentMap(radiance=np.full((64, 128, 3), k, np.float32)))
            for k in (1, 2)]  # fmt: skip
    assert find_near_duplicates(["a", "b"], grey) == []


def test_pictures_of_one_place_are_told_with_their_distance(scenes, others, capture):
    near = replace(capture, id="b", latitude_deg=capture.latitude_deg + 5 / 111_195)
    far = replace(capture, id="c", latitude_deg=capture.latitude_deg + 0.1)
    found = find_near_duplicates(["a", "b", "c"], others[:3], [capture, near, far])
    assert [(p.first, p.second, p.likeness) for p in found] == [("a", "b", Likeness.PLACE)]
    assert found[0].distance_m == pytest.approx(5, rel=0.01)
    assert found[0].correlation is None
