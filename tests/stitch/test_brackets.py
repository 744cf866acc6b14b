import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from panokit.color import srgb_encode
from panokit.color.camera import sigmoid_encode
from panokit.errors import ImageError, UsageError
from panokit.io import read_environment_map
from panokit.stitch import merge_brackets

TIMES = [4.0**k for k in range(-4, 3)]


def light(width_px=256, seed=0):
    """Smooth light of five decades, with a lamp."""
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(-4.5, 1.5, (8, 16, 3)).astype(np.float32)
    wide = cv2.resize(coarse, (width_px, width_px // 2), interpolation=cv2.INTER_CUBIC)
    radiance = np.exp(wide)
    radiance[30:36, 40:46] = 80.0
    return radiance.astype(np.float32)


def shots(radiance, times=TIMES, encode=srgb_encode, jpeg=None):
    pictures = []
    for time in times:
        exposed = np.clip(radiance * time, 0, 1).astype(np.float32)
        picture = np.rint(encode(exposed) * 255).astype(np.uint8)
        if jpeg:
            picture = cv2.imdecode(cv2.imencode(".jpg", picture, [1, jpeg])[1], 1)
        pictures.append(picture)
    return pictures


def in_scene_units(merged):
    return merged.radiance / merged.values["reference_exposure"]


def test_radiance_comes_back():
    scene = light()
    merged = merge_brackets(shots(scene), TIMES)
    error = np.abs(in_scene_units(merged) / scene - 1)
    assert np.median(error) < 0.005
    assert np.quantile(error, 0.99) < 0.07
    assert not merged.ghosts.any()
    assert merged.radiance.dtype == np.float32


def test_the_order_of_pictures_does_not_matter():
    pictures = shots(light())
    turned = merge_brackets(pictures[::-1], TIMES[::-1])
    assert np.array_equal(turned.radiance, merge_brackets(pictures, TIMES).radiance)


def test_another_curve_is_given_or_found():
    scene = light()
    pictures = shots(scene, encode=lambda x: sigmoid_encode(x, 0.9, 0.6))
    fine = np.linspace(0, 1, 20001, dtype=np.float32)
    curve = np.interp(np.arange(256), sigmoid_encode(fine, 0.9, 0.6) * 255, fine)
    known = merge_brackets(pictures, TIMES, curve=curve)
    wrong = merge_brackets(pictures, TIMES, deghost=False)
    found = merge_brackets(pictures, TIMES, curve="debevec")

    def spread(merged):
        logs = np.log(np.maximum(in_scene_units(merged), 1e-6) / scene)
        return float(np.median(np.abs(logs - np.median(logs))))

    assert spread(known) < 0.01
    assert spread(found) < 0.04 < spread(wrong)


def test_what_moved_is_told_by_one_picture():
    scene = light()
    with_car = [scene.copy() for _ in TIMES]
    for number, frame in enumerate(with_car):
        left = 20 + 25 * number
        frame[70:100, left : left + 22] = 0.5
    pictures = [shots(s, [t])[0] for s, t in zip(with_car, TIMES, strict=True)]
    merged = merge_brackets(pictures, TIMES)
    plain = merge_brackets(pictures, TIMES, deghost=False)
    assert merged.ghosts[75:95].mean() > 0.2
    assert merged.ghosts[:55].mean() < 0.02
    # The reference shows one car; elsewhere the wall is as it was.
    reference = merged.values["reference"]
    car = np.zeros(scene.shape[:2], bool)
    car[60:110, 12 + 25 * reference : 50 + 25 * reference] = True
    row = np.s_[72:98, 20:200]
    error = np.abs(in_scene_units(merged) / scene - 1).mean(axis=-1)[row][~car[row]]
    smeared = np.abs(in_scene_units(plain) / scene - 1).mean(axis=-1)[row][~car[row]]
    assert np.mean(error > 0.2) < 0.5 * np.mean(smeared > 0.2)


def test_what_all_pictures_clip_is_as_bright_as_the_shortest_tells():
    scene = light()
    scene[50:60, 50:60] = 1e5
    merged = merge_brackets(shots(scene), TIMES)
    assert merged.values["clipped_share"] > 0
    assert in_scene_units(merged)[52:58, 52:58].min() >= 0.98 / TIMES[0]


def test_bad_brackets():
    pictures = shots(light())
    with pytest.raises(UsageError, match="got 7 and 6"):
        merge_brackets(pictures, TIMES[:-1])
    with pytest.raises(UsageError, match="above 0"):
        merge_brackets(pictures, [0.0, *TIMES[1:]])
    with pytest.raises(UsageError, match="256 rising"):
        merge_brackets(pictures, TIMES, curve=np.linspace(1, 0, 256))
    with pytest.raises(ImageError, match="different exposures") as caught:
        merge_brackets(pictures[:2], [1.0, 1.0])
    assert caught.value.reason == "one-exposure"
    with pytest.raises(ImageError, match="one size"):
        merge_brackets([pictures[0], pictures[1][1:]], TIMES[:2])


@pytest.mark.data
@pytest.mark.parametrize("name", ["kloofendal_43d_clear_puresky", "artist_workshop"])
def test_brackets_cut_from_real_probes(name):
    folder = os.environ.get("PANOKIT_DATA")
    if not folder:
        pytest.skip("PANOKIT_DATA is not set")
    probe = read_environment_map(Path(folder) / "probes" / f"{name}_1k.hdr").radiance
    scene = probe * (0.5 / np.median(probe.mean(axis=-1)))
    times = [4.0**k for k in range(-5, 3)]
    merged = merge_brackets(shots(scene, times, jpeg=95), times)
    rows = np.sin((np.arange(512) + 0.5) / 512 * np.pi)[:, None, None]
    energy = (in_scene_units(merged) * rows).sum()
    assert energy == pytest.approx((np.minimum(scene, 1 / times[0]) * rows).sum(), rel=0.01)
    bright = scene.mean(axis=-1) > 0.02
    error = np.abs(in_scene_units(merged).mean(axis=-1) / scene.mean(axis=-1) - 1)[bright]
    assert np.median(error) < 0.015
