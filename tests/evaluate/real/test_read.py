"""Pairs out of folders laid out as published: every convention checked by what is seen."""

import numpy as np
import pytest

from panokit.color import srgb_decode_u8
from panokit.errors import RecordError, UsageError
from panokit.evaluate.lighting.baselines import AmbientColor
from panokit.evaluate.lighting.scoring import score_map
from panokit.evaluate.real import PairSettings, read_pairs
from panokit.sphere.equirect import equirect_pixel
from tests.evaluate.real import lookalikes

SETTINGS = PairSettings(width_px=64)
KINDS = {"stanford-orb": lookalikes.stanford_orb,
         "objects-with-lighting": lookalikes.objects_with_lighting}  # fmt: skip


@pytest.fixture(scope="module", params=sorted(KINDS))
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def folder(kind, tmp_path_factory):
    return KINDS[kind](tmp_path_factory.mktemp("data"))


@pytest.fixture(scope="module")
def pairs(kind, folder):
    return list(read_pairs(folder, kind, SETTINGS))


def rays(views):
    size = views.mask.shape[0]
    at = (np.arange(size) + 0.5 - size / 2) / views.focal_px
    x, y = np.meshgrid(at, -at)
    return np.stack([x, y, -np.ones_like(x)], axis=-1)


def seen_in(truth, directions):
    """The color of a map's pixels in directions; rows are twice as fine as columns."""
    column, row = equirect_pixel(directions, 64, 64)
    return truth[np.clip(np.rint(row), 0, 63).astype(int), np.rint(column).astype(int) % 64]


def test_there_are_pairs(pairs):
    assert len(pairs) >= 2
    assert [pair.key for pair in pairs] == [f"{n:09d}" for n in range(len(pairs))]


def test_the_background_of_a_photograph_is_the_light_from_there(pairs):
    for pair in pairs:
        views = pair.views
        seen = srgb_decode_u8(views.left)
        expected = seen_in(pair.truth, rays(views))
        outside = ~views.mask & (seen.min(axis=-1) > 0.01) & (seen.max(axis=-1) < 0.98)
        assert outside.sum() > 500
        difference = np.abs(seen - expected)[outside]
        assert np.median(difference) < 0.02
        # Only the edge of the object, where both mix, is off by more.
        assert (difference.max(axis=-1) < 0.08).mean() > 0.9


def test_the_cameras_are_parallel_and_the_right_one_is_right(pairs):
    for pair in pairs:
        views = pair.views
        places = [np.argwhere(p.any(axis=-1)).mean(axis=0)
                  for p in (views.left_object, views.right_object)]  # fmt: skip
        assert abs(places[0][0] - places[1][0]) < 0.6
        assert places[0][1] - places[1][1] > 1
        assert pair.meta["parallel"]


def test_the_disparity_is_that_of_the_distance(pairs):
    pair = pairs[0]
    views = pair.views
    columns = [np.argwhere(p.any(axis=-1))[:, 1].mean()
               for p in (views.left_object, views.right_object)]  # fmt: skip
    depth = views.baseline_m / pair.meta["over_depth"]
    expected = views.focal_px * views.baseline_m / depth
    assert columns[0] - columns[1] == pytest.approx(expected, rel=0.15)


def test_the_object_fills_its_share_and_stays_inside(pairs):
    for pair in pairs:
        rows, columns = np.nonzero(pair.views.mask)
        assert columns.min() > 0 and columns.max() < 63 and rows.min() > 0 and rows.max() < 63
        assert 0.3 < (np.ptp(rows) + 1) / 64 < 0.75


def test_up_is_known(pairs):
    for pair in pairs:
        # The cameras looked down from a height of 1 m at 3 m, with their heads up.
        _, pitch, roll = pair.views.left_level.heading_pitch_roll()
        assert np.degrees(pitch) == pytest.approx(-18.4, abs=1.5)
        assert abs(np.degrees(roll)) < 3


def test_the_background_goes_on_behind_the_object(pairs):
    views = pairs[0].views
    assert pairs[0].meta["background"] == "filled"
    behind = srgb_decode_u8(views.background)[views.mask]
    expected = seen_in(pairs[0].truth, rays(views))[views.mask]
    assert np.abs(behind - expected).mean() < 0.06


def test_samples_go_through_the_evaluator(pairs):
    scores = score_map(AmbientColor().predict(pairs[0]), pairs[0].truth)
    assert 0 < scores["si-rmse"] < 1
    assert 0 < scores["log-rmse"] < 1
    assert pairs[0].meta["probe"]["place"]


def test_as_they_are_the_cameras_look_inward(kind, folder):
    pair = next(read_pairs(folder, kind, SETTINGS.model_copy(update={"rectify": False})))
    assert not pair.meta["parallel"]
    assert pair.meta["rotation_deg"] == pytest.approx(6, abs=0.5)
    expected = seen_in(pair.truth, rays(pair.views))
    outside = ~pair.views.mask
    seen = srgb_decode_u8(pair.views.left)
    assert np.median(np.abs(seen - expected)[outside & (seen.max(axis=-1) < 0.98)]) < 0.02


def test_another_layout_is_refused(tmp_path):
    for kind in KINDS:
        with pytest.raises(UsageError, match="laid out"):
            next(read_pairs(tmp_path, kind))
    with pytest.raises(UsageError, match="no data set"):
        next(read_pairs(tmp_path, "laval"))


def test_the_scale_of_one_is_known_and_of_the_other_not(pairs, kind):
    assert pairs[0].meta["scale_known"] == (kind == "objects-with-lighting")


def test_a_data_set_of_8_bits_is_read_too(tmp_path):
    root = lookalikes.stanford_orb(tmp_path, hdr=False)
    pair = next(read_pairs(root, "stanford-orb", SETTINGS))
    assert pair.meta["exposure"] == 1.0


def test_normals_of_the_test_views_are_turned_with_them(tmp_path):
    root = lookalikes.stanford_orb(tmp_path)
    pair = next(pair for pair in read_pairs(root, "stanford-orb", SETTINGS)
                if pair.meta["pair"][0].startswith("test/"))  # fmt: skip
    normals = pair.views.normals[pair.views.mask]
    known = np.linalg.norm(normals, axis=-1) > 0.5
    assert known.mean() > 0.9
    np.testing.assert_allclose(np.linalg.norm(normals[known], axis=-1), 1, atol=1e-5)
    # The photograph's camera looked half the angle between the two more to the side.
    mean = normals[known].mean(axis=0)
    assert np.degrees(np.arctan2(abs(mean[0]), mean[2])) == pytest.approx(3, abs=1)
    assert not pair.views.normals[~pair.views.mask].any()


def test_black_around_the_object_is_no_background(tmp_path, monkeypatch):
    def alone(*arguments):
        picture, mask = photograph(*arguments)
        return picture * mask[..., None], mask

    photograph = lookalikes.photograph
    monkeypatch.setattr(lookalikes, "photograph", alone)
    root = lookalikes.objects_with_lighting(tmp_path)
    pair = next(read_pairs(root, "objects-with-lighting", SETTINGS))
    assert pair.meta["background"] == "unknown"
    assert not pair.views.background.any()


def test_a_damaged_file_is_named(tmp_path):
    root = lookalikes.objects_with_lighting(tmp_path)
    path = root / "dataset/ball/garden/world_to_env.txt"
    path.write_text("1 2 3")
    with pytest.raises(RecordError, match="world_to_env"):
        next(read_pairs(root, "objects-with-lighting"))


def test_a_pair_without_its_object_is_a_rejection(tmp_path):
    root = lookalikes.objects_with_lighting(tmp_path)
    mask = root / "dataset/ball/garden/inputs/mask_0001.png"
    lookalikes.write_png(mask, np.zeros((128, 192), np.uint8))
    told = []
    found = list(read_pairs(root, "objects-with-lighting", SETTINGS, on_reject=told.append))
    assert [one.reason for one in told] == ["blank-mask", "blank-mask"]
    assert found == []
    assert told[0].item == "ball/garden/0000"
