"""Figures of a map's light: right on known light, the same at any exposure, size and yaw."""

import numpy as np
import pytest

from panokit.envmap import EnvironmentMap
from panokit.errors import ItemError
from panokit.frames import Rotation
from panokit.qa.sets import DESCRIPTORS, LightClass, describe, light_class, measure
from panokit.qa.sets.store import DescriptionStore, description_of
from panokit.sphere import equirect_directions, rotate

_ANY_YAW = {d.name for d in DESCRIPTORS} - {"detail", "plateau"}


def figures(radiance):
    return describe(measure(EnvironmentMap(radiance=np.ascontiguousarray(radiance, np.float32))))


def test_exposure_changes_nothing(scenes):
    one, other = figures(scenes(1)), figures(scenes(1) * 37)
    assert one == pytest.approx(other, rel=1e-4, abs=1e-4)
    assert len(one) == len(DESCRIPTORS) == len({d.name for d in DESCRIPTORS})


def test_yaw_changes_next_to_nothing(scenes):
    envmap = EnvironmentMap(radiance=scenes(2, width=512))
    turned = rotate(envmap, Rotation.about_axis((0, 1, 0), 0.7))
    one, other = describe(measure(envmap)), describe(measure(turned))
    for name in _ANY_YAW:
        assert other[name] == pytest.approx(one[name], rel=0.05, abs=0.05), name


def test_a_larger_file_of_one_map_has_the_same_figures(scenes):
    small = EnvironmentMap(radiance=scenes(3, width=512))
    large = EnvironmentMap(radiance=np.repeat(np.repeat(small.radiance, 2, axis=0), 2, axis=1))
    one, other = describe(measure(small)), describe(measure(large))
    for name in one:
        assert other[name] == pytest.approx(one[name], rel=0.02, abs=0.02), name


def test_known_light_has_known_figures():
    directions = equirect_directions(256, 128)
    even = figures(np.ones((128, 256, 3)))
    for name in ("contrast", "anisotropy", "lights", "detail"):
        assert even[name] == pytest.approx(0, abs=1e-3), name
    assert even["key-elevation"] is None and even["key-to-fill"] is None
    assert even["ambient-temperature"] == pytest.approx(1e6 / 6504, abs=1)
    above = figures(np.where(directions[..., 1:2] > 0, 3.0, 1.0) * np.ones(3))
    assert above["upper-share"] == pytest.approx(0.75, abs=0.01)
    assert above["light-elevation"] == pytest.approx(90, abs=0.1)
    red = figures(np.ones((128, 256, 3)) * [2.0, 1.0, 0.5])
    assert red["ambient-warmth"] == pytest.approx(2) and red["ambient-green"] == pytest.approx(0)


def test_a_sun_is_the_key_light(scenes):
    weak, strong = figures(scenes(4, sun=0.3)), figures(scenes(4, sun=3))
    for name in ("peak-over-median", "top-share", "anisotropy", "key-to-fill", "degree-9-16"):
        assert strong[name] > weak[name], name
    assert strong["lights"] == 1 and 20 < strong["key-elevation"] < 75


def test_black_and_tiny_maps_are_rejected():
    with pytest.raises(ItemError, match="black") as caught:
        measure(EnvironmentMap(radiance=np.zeros((64, 128, 3), np.float32)))
    assert caught.value.reason == "black-map"
    with pytest.raises(ItemError, match="too small"):
        measure(EnvironmentMap(radiance=np.ones((16, 32, 3), np.float32)))


def small_light(radius_deg, strength, azimuth_deg=0.0, width=512):
    directions = equirect_directions(width, width // 2)
    azimuth, elevation = np.deg2rad(azimuth_deg), np.deg2rad(40)
    toward = np.array(
        [
            np.sin(azimuth) * np.cos(elevation),
            np.sin(elevation),
            -np.cos(azimuth) * np.cos(elevation),
        ]
    )
    return (directions @ toward > np.cos(np.deg2rad(radius_deg)))[..., None] * strength


def outdoors(width=512):
    y = equirect_directions(width, width // 2)[..., 1:2]
    return np.where(y > 0, [0.4, 0.5, 0.9], [0.25, 0.2, 0.15])


@pytest.mark.parametrize(
    ("radiance", "expected"),
    [
        (outdoors() + small_light(0.8, 3000), LightClass.SUN),
        (outdoors(), LightClass.OVERCAST),
        (outdoors() + small_light(12, 3), LightClass.OVERCAST),
        (outdoors() + sum(small_light(0.7, 2000, a) for a in (-120, 0, 100)), LightClass.NIGHT),
        (0.5 + small_light(10, 20) * np.ones(3), LightClass.INDOOR),
    ],
)
def test_kinds_of_light(radiance, expected):
    envmap = EnvironmentMap(radiance=np.asarray(radiance * np.ones(3), np.float32))
    assert light_class(measure(envmap)) is expected


def test_descriptions_are_kept_by_content(scenes, make_set, tmp_path, monkeypatch):
    path = make_set("maps", {"a": scenes(5)})[0].path
    store = DescriptionStore(tmp_path / "kept.jsonl")
    first = store.describe(path)
    store.save()
    written = (tmp_path / "kept.jsonl").read_bytes()
    monkeypatch.setattr("panokit.qa.sets.store.read_environment_map", None)
    again = DescriptionStore(tmp_path / "kept.jsonl")
    second = again.describe(path)
    assert second.values == first.values and second.light_class is first.light_class
    for name in ("power", "signature", "thumbnail", "detail"):
        np.testing.assert_array_equal(getattr(second, name), getattr(first, name))
    again.save()
    assert (tmp_path / "kept.jsonl").read_bytes() == written


def test_damaged_lines_are_described_anew(scenes, make_set, tmp_path):
    path = make_set("maps", {"a": scenes(5)})[0].path
    kept = tmp_path / "kept.jsonl"
    kept.write_text('{"version": "1"}\nnot json\n{"version": "0", "values": {}}\n[]\n')
    store = DescriptionStore(kept)
    assert store.describe(path).values["lights"] >= 0
    store.save()
    assert len(kept.read_text().splitlines()) == 1


def test_a_thumbnail_has_no_exposure_and_detail_no_rows(scenes):
    one, other = (
        description_of(measure(EnvironmentMap(radiance=scenes(6) * np.float32(k)))) for k in (1, 8)
    )
    np.testing.assert_allclose(one.thumbnail, other.thumbnail, atol=0.01)
    assert np.abs(one.detail.mean(axis=1)).max() < 0.01
    np.testing.assert_allclose(one.signature, other.signature, atol=1e-3)
