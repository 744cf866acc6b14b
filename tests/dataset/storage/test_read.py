import multiprocessing
import pickle
import tarfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from panokit.dataset.storage.decode import decode_exr, decode_member, decode_png
from panokit.dataset.storage.members import exr_bytes
from panokit.dataset.storage.read import StereoDataset
from panokit.dataset.storage.sampling import ShardSampler
from panokit.errors import ImageError, RecordError, StorageError, UsageError
from panokit.io.images import encode_png
from tests.dataset.conftest import COUNT, SHARD
from tests.dataset.fake import WIDTH_PX, FakeMaker


def test_samples_by_number_and_key(finished_dataset):
    dataset = StereoDataset(finished_dataset, "train")
    assert len(dataset) == sum(FakeMaker().split_of(i) == "train" for i in range(COUNT))
    assert {dataset.meta(number)["split"] for number in range(len(dataset))} == {"train"}
    sample = dataset[dataset.number_of("000000005")]
    assert sample["key"] == "000000005"
    assert sample["left"].shape == (WIDTH_PX, WIDTH_PX, 3)
    assert sample["left"].dtype == np.uint8
    assert sample["env64"].shape == (64, 64, 3)
    assert sample["env64"].dtype == np.float32
    made = FakeMaker().make(5, 0).members
    np.testing.assert_array_equal(sample["right"], decode_png(made["right.png"]))
    np.testing.assert_array_equal(dataset[-1]["left"], dataset[len(dataset) - 1]["left"])


def test_all_splits_and_chosen_members(finished_dataset):
    dataset = StereoDataset(finished_dataset, members=("left_depth.exr", "meta.json"))
    assert len(dataset) == COUNT
    sample = dataset[3]
    assert set(sample) == {"left_depth", "meta", "key"}
    assert sample["left_depth"].shape == (WIDTH_PX, WIDTH_PX)
    assert sample["meta"]["key"] == sample["key"]
    assert sum(1 for _ in dataset) == COUNT
    assert sum(dataset.shard_sizes) == COUNT
    assert max(dataset.shard_sizes) == SHARD


def test_the_bytes_are_those_of_the_tar(finished_dataset):
    dataset = StereoDataset(finished_dataset, "test")
    with tarfile.open(finished_dataset / "shards" / "test-00000.tar") as file:
        for entry in file:
            key, _, name = entry.name.partition(".")
            data = file.extractfile(entry).read()
            assert dataset.read(dataset.number_of(key), name) == data


def test_it_is_pickled_without_its_open_files(finished_dataset):
    dataset = StereoDataset(finished_dataset, "train")
    expected = dataset[4]["left"]
    copy = pickle.loads(pickle.dumps(dataset))
    np.testing.assert_array_equal(copy[4]["left"], expected)
    dataset.close()
    np.testing.assert_array_equal(dataset[4]["left"], expected)


def test_threads_and_processes_share_one(finished_dataset):
    dataset = StereoDataset(finished_dataset, "train")
    expected = [dataset[number]["left"].tobytes() for number in range(len(dataset))]
    numbers = list(range(len(dataset))) * 4
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda n: (n, dataset[n]["left"].tobytes()), numbers))
    assert all(expected[number] == data for number, data in found)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        forked = pool.map(dataset.__getitem__, range(len(dataset)))
    assert [sample["left"].tobytes() for sample in forked] == expected


def test_wrong_names_are_told(finished_dataset, tmp_path):
    with pytest.raises(UsageError, match="choose from train, validation, test"):
        StereoDataset(finished_dataset, "training")
    with pytest.raises(UsageError, match=r"no member 'left\.jpg'; choose from left\.png"):
        StereoDataset(finished_dataset, members=("left.jpg",))
    with pytest.raises(StorageError, match="panokit dataset render"):
        StereoDataset(tmp_path)
    dataset = StereoDataset(finished_dataset, "train")
    with pytest.raises(UsageError, match="no sample '000000099' in train"):
        dataset.number_of("000000099")
    with pytest.raises(UsageError, match=r"has no member 'albedo\.exr'"):
        dataset.read(0, "albedo.exr")
    with pytest.raises(IndexError):
        dataset[len(dataset)]


def test_a_shard_that_shrank_is_told(own_dataset):
    dataset = StereoDataset(own_dataset, "test")
    shard = own_dataset / "shards" / "test-00000.tar"
    shard.write_bytes(shard.read_bytes()[:2000])
    with pytest.raises(RecordError, match="panokit dataset verify"):
        dataset[len(dataset) - 1]
    shard.unlink()
    with pytest.raises(StorageError, match="Check the path"):
        StereoDataset(own_dataset, "test")[0]


@pytest.mark.train
def test_torch_reads_it_as_it_is(finished_dataset):
    from torch.utils.data import DataLoader

    dataset = StereoDataset(finished_dataset, "train")
    sampler = ShardSampler(dataset.shard_sizes, seed=3)
    loader = DataLoader(dataset, batch_size=4, sampler=sampler, num_workers=0)
    batches = list(loader)
    assert batches[0]["left"].shape == (4, WIDTH_PX, WIDTH_PX, 3)
    keys = [key for batch in batches for key in batch["key"]]
    assert keys == [str(dataset.keys[number]) for number in sampler]


def test_members_decode_to_what_was_encoded():
    rng = np.random.default_rng(0)
    color = rng.integers(0, 255, (5, 7, 3), dtype=np.uint8)
    light = rng.gamma(0.2, 100, (4, 8, 3)).astype(np.float32)
    depth = rng.random((5, 7)).astype(np.float16)
    np.testing.assert_array_equal(decode_member("left.png", encode_png(color)), color)
    np.testing.assert_array_equal(decode_member("m.png", encode_png(color[..., 0])), color[..., 0])
    np.testing.assert_array_equal(decode_member("env.exr", exr_bytes(light)), light)
    found = decode_member("depth.exr", exr_bytes(depth, half=True))
    np.testing.assert_array_equal(found, depth.astype(np.float32))
    assert found.dtype == np.float32
    assert decode_member("notes.txt", b"abc") == b"abc"


@pytest.mark.parametrize("name", ["left.png", "env.exr"])
def test_what_is_damaged_is_an_error(name):
    rng = np.random.default_rng(0)
    pixels = rng.random((16, 16, 3))
    data = encode_png((255 * pixels).astype(np.uint8)) if name == "left.png" else exr_bytes(pixels)
    for broken in (b"", b"nonsense", data[: len(data) // 3]):
        with pytest.raises(ImageError, match=name):
            decode_member(name, broken)
    with pytest.raises(RecordError, match=r"meta\.json"):
        decode_member("meta.json", b"{")


def test_an_exr_of_other_channels_is_not_guessed_at(tmp_path):
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, {"RGBA": np.zeros((4, 4, 4), np.float32)}) as file:
        file.write(str(tmp_path / "a.exr"))
    with pytest.raises(ImageError, match="channels"):
        decode_exr((tmp_path / "a.exr").read_bytes())
