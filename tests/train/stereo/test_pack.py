"""Packs: what the shards hold, made smaller, and never another dataset's."""

import shutil

import cv2
import numpy as np
import pytest

pytest.importorskip("torch")

from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.settings import DatasetSettings
from panokit.dataset.storage.read import StereoDataset
from panokit.errors import StorageError, UsageError
from panokit.train.stereo import pack as packs
from panokit.train.stereo.pack import MAPS, PICTURES, open_pack
from tests.dataset.fake import FakeMaker
from tests.train.stereo.rendered import WIDTH_PX

pytestmark = pytest.mark.train


def test_a_pack_holds_what_the_shards_do(small_dataset, tmp_path):
    pack = open_pack(small_dataset, "train", WIDTH_PX, tmp_path)
    names = (*(f"{one}.png" for one in PICTURES), "env64.exr", "left_normal.exr", "left_mask.png")
    source = StereoDataset(small_dataset, "train", members=names)
    assert pack.keys.tolist() == source.keys.tolist()
    assert pack.places.tolist() == [source.meta(n)["probe"]["place"] for n in range(len(source))]
    for number in (0, len(pack) - 1):
        files = source[number]
        for name in PICTURES:
            np.testing.assert_array_equal(pack.arrays[name][number], files[name])
        np.testing.assert_array_equal(pack.arrays["env64"][number], files["env64"])
        np.testing.assert_array_equal(
            pack.arrays["reflectance"][number], source.decoded(number, "reflectance.exr")
        )
        np.testing.assert_array_equal(pack.arrays["part"][number], files["left_mask"] >= 128)
        # Stored in half precision, and made unit again.
        known = np.linalg.norm(files["left_normal"], axis=-1) > 0.5
        np.testing.assert_allclose(
            pack.arrays["normal"][number][known], files["left_normal"][known], atol=2e-3
        )
    assert set(pack.arrays) == {*PICTURES, *MAPS, "normal", "part"}


def test_smaller_pictures_are_means_and_their_normals_unit(small_dataset, tmp_path):
    pack = open_pack(small_dataset, "validation", 16, tmp_path)
    whole = open_pack(small_dataset, "validation", WIDTH_PX, tmp_path)
    picture = whole.arrays["left"][0].astype(float)
    means = picture.reshape(16, 2, 16, 2, 3).mean(axis=(1, 3))
    assert np.abs(pack.arrays["left"][0] - means).max() <= 0.5
    length = np.linalg.norm(pack.arrays["normal"].astype(np.float32), axis=-1)
    assert np.all((length == 0) | (np.abs(length - 1) < 2e-3))
    assert (length > 0).mean() == pytest.approx((pack.arrays["part"] > 0).mean(), abs=0.05)


def test_a_pack_is_made_once(small_dataset, tmp_path, monkeypatch):
    first = open_pack(small_dataset, "train", 16, tmp_path)
    monkeypatch.setattr(cv2, "resize", None)  # it cannot be made again
    second = open_pack(small_dataset, "train", 16, tmp_path)
    np.testing.assert_array_equal(first.arrays["left"], second.arrays["left"])
    assert [path.name.split("-")[0] for path in (tmp_path / "packs").iterdir()] == ["train"]


def test_a_pack_that_was_not_finished_is_not_there(small_dataset, tmp_path, monkeypatch):
    def break_off(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(packs, "write_json", break_off)
        with pytest.raises(KeyboardInterrupt):
            open_pack(small_dataset, "train", 16, tmp_path)
    assert list((tmp_path / "packs").iterdir()) == []
    assert len(open_pack(small_dataset, "train", 16, tmp_path)) > 0


def test_another_process_may_be_faster(small_dataset, tmp_path, monkeypatch):
    original = packs._write

    def overtaken(folder, *arguments):
        original(folder, *arguments)
        place = tmp_path / "packs" / ("-".join(folder.name.lstrip(".").split("-")[:2]))
        if not place.exists():
            shutil.copytree(folder, place)

    monkeypatch.setattr(packs, "_write", overtaken)
    assert len(open_pack(small_dataset, "train", 16, tmp_path)) > 0
    assert len(list((tmp_path / "packs").iterdir())) == 1


def test_a_dataset_that_was_rendered_anew_has_another_pack(tmp_path):
    # Same place on the disk, same keys, other pictures.
    place, found = tmp_path / "stereo", []
    for seed in (0, 1):
        shutil.rmtree(place, ignore_errors=True)
        maker = FakeMaker(settings=DatasetSettings(renderer="analytic", seed=seed))
        render_dataset(maker, place, ProductionSettings(count=10, workers=0))
        found.append(open_pack(place, "train", 16, tmp_path / "work"))
    before, after = found
    assert before.keys.tolist() == after.keys.tolist()
    assert not np.array_equal(before.arrays["left"], after.arrays["left"])


def test_a_limit_takes_the_first_samples(small_dataset, tmp_path):
    whole = open_pack(small_dataset, "train", 16, tmp_path)
    few = open_pack(small_dataset, "train", 16, tmp_path, limit=4)
    assert few.keys.tolist() == whole.keys[:4].tolist()
    more_than_there_are = open_pack(small_dataset, "train", 16, tmp_path, limit=999)
    assert len(more_than_there_are) == len(whole)


def test_what_cannot_be_packed_is_named(small_dataset, tmp_path):
    with pytest.raises(UsageError, match=r"32 pixels wide, less than input_px = 64"):
        open_pack(small_dataset, "train", 64, tmp_path)
    assert list((tmp_path / "packs").iterdir()) == []
    with pytest.raises(StorageError, match="nowhere"):
        open_pack(tmp_path / "nowhere", "train", 16, tmp_path)
