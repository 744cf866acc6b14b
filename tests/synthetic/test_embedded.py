"""The embedded city is data; these tests are what it promises."""

import numpy as np
import pytest

from panokit.color import luminance, srgb_decode_u8
from panokit.frames import Frame
from panokit.io import read_environment_map
from panokit.io.images import decode_image
from panokit.sphere import (
    energy,
    equirect_directions,
    resize_radiance,
    rotate_radiance,
)
from panokit.sun import SUN_SOLID_ANGLE, sun_direction
from panokit.synthetic import embedded_city, embedded_truth


@pytest.fixture(scope="module")
def city():
    return list(embedded_city())


@pytest.fixture(scope="module")
def truths(city):
    names = [picture.capture.id for picture in city]
    return {name: read_environment_map(embedded_truth() / f"{name}.exr") for name in names}


def weather(picture):
    return picture.capture.details["weather"]


def test_city_has_places_and_skies_of_every_kind(city):
    assert len(city) >= 6
    assert len({picture.capture.place for picture in city}) >= 3
    assert {"overcast", "night"} < {weather(picture) for picture in city}
    assert {"clear", "cloudy"} & {weather(picture) for picture in city}
    assert any(abs(picture.capture.pitch_deg) > 1 for picture in city)


def test_city_may_be_used_for_anything(city):
    for picture in city:
        license = picture.capture.license
        assert (license.id, license.attribution) == ("CC0-1.0", "panokit synthetic city")
        assert license.store and license.derive and license.train


def test_city_is_small_enough_to_travel(city):
    files = [path for path in embedded_truth().parent.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 10e6
    assert all(picture.image in files for picture in city)


def test_pictures_have_the_size_they_declare(city):
    for picture in city:
        pixels = decode_image(picture.image.read_bytes(), what=picture.image.name)
        assert pixels.shape == (2048, 4096, 3)
        assert picture.size_px == (4096, 2048)
        assert 40 < pixels.mean() < 215


def test_truths_are_level_maps_in_units_of_the_clip_level(city, truths):
    for picture in city:
        truth = truths[picture.capture.id]
        assert truth.radiance.shape == (256, 512, 3)
        assert (truth.frame, str(truth.anchor)) == (Frame.WORLD, "ldr-white")
        assert truth.capture.id == picture.capture.id
        stated = truth.provenance.last("synthetic").values["energy"]
        np.testing.assert_allclose(energy(truth.radiance), stated, rtol=2e-3)


def test_sun_is_where_the_almanac_says_and_holds_most_of_the_light(city, truths):
    directions = equirect_directions(512, 256)
    seen = []
    for picture in city:
        capture = picture.capture
        bright = luminance(truths[capture.id].radiance)
        if weather(picture) not in ("clear", "cloudy") or bright.max() < 1000:
            continue  # No sun, or it stands behind a house.
        toward = sun_direction(capture.latitude_deg, capture.longitude_deg, capture.time)
        peak = directions.reshape(-1, 3)[bright.argmax()]
        assert np.degrees(np.arccos(np.clip(peak @ toward, -1, 1))) < 1.0, capture.id
        assert bright.max() * SUN_SOLID_ANGLE > 0.3, "the sun of a clear day"
        seen.append(capture.id)
    assert len(seen) >= 2


def test_night_and_overcast_have_no_sun(city, truths):
    for picture in city:
        peak = luminance(truths[picture.capture.id].radiance).max()
        if weather(picture) == "overcast":
            assert peak < 10
        elif weather(picture) == "night":
            assert 5 < peak < 5000


def test_each_picture_shows_its_truth(city, truths):
    """Pose, exposure and curve of a picture undone, its unclipped parts are the truth."""
    for picture in city:
        pixels = decode_image(picture.image.read_bytes(), what=picture.image.name)
        linear = resize_radiance(srgb_decode_u8(pixels), 128)
        pose = picture.capture.world_from_camera
        shown = rotate_radiance(linear, pose)
        truth = resize_radiance(truths[picture.capture.id].radiance, 128)
        # Not the rig at the foot, not what is clipped, not the halo around it.
        usable = (truth.max(axis=2) < 0.6) & (equirect_directions(128, 64)[..., 1] > -0.25)
        assert usable.mean() > 0.2
        ratio = np.median(shown[usable] / np.maximum(truth[usable], 1e-4))
        assert 0.93 < ratio < 1.12, picture.capture.id
        similar = np.corrcoef(shown[usable].ravel(), truth[usable].ravel())[0, 1]
        assert similar > 0.85, picture.capture.id
