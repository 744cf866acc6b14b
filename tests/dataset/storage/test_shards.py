import tarfile

import pytest

from panokit.dataset.storage.layout import plan_shards
from panokit.dataset.storage.shards import read_members, tar_bytes, write_shard
from panokit.errors import RecordError, UsageError

SAMPLES = {
    "000000003": {"left.png": b"p" * 700, "meta.json": b"{}"},
    "000000007": {"left.png": b"", "meta.json": b"[]" * 512},
}


@pytest.fixture
def shard(tmp_path):
    path = tmp_path / "train-00000.tar"
    write_shard(path, (tar_bytes(key, members) for key, members in SAMPLES.items()))
    return path


def test_any_tar_program_reads_a_shard(shard):
    with tarfile.open(shard) as file:
        entries = file.getmembers()
        contents = {entry.name: file.extractfile(entry).read() for entry in entries}
    assert contents == {
        f"{key}.{name}": data for key, members in SAMPLES.items() for name, data in members.items()
    }
    assert {(e.mtime, e.uid, e.gid, e.uname, e.gname, e.mode) for e in entries} == {
        (0, 0, 0, "", "", 0o644)
    }


def test_members_are_where_they_are_said_to_be(shard):
    data = shard.read_bytes()
    for member in read_members(shard):
        expected = SAMPLES[member.key][member.name]
        assert data[member.offset : member.offset + member.bytes] == expected
        assert member.bytes == len(expected)


@pytest.mark.parametrize("cut", [1, 600, 1024, 1500])
def test_a_shard_that_was_cut_is_damaged(shard, cut):
    shard.write_bytes(shard.read_bytes()[:-cut])
    with pytest.raises(RecordError, match="damaged"):
        list(read_members(shard))


def test_what_is_no_sample_is_not_taken_for_one(tmp_path):
    path = tmp_path / "other.tar"
    (tmp_path / "nodot").write_bytes(b"x")
    with tarfile.open(path, "w") as file:
        file.add(tmp_path / "nodot", "nodot")
    with pytest.raises(RecordError, match="nodot"):
        list(read_members(path))


def split_of(index):
    return ("train", "train", "test", "train", "validation")[index % 5]


def test_more_samples_leave_full_shards_as_they_are():
    small = {plan.name: plan.indices for plan in plan_shards(split_of, 37, 4)}
    large = {plan.name: plan.indices for plan in plan_shards(split_of, 90, 4)}
    assert all(large[name] == indices for name, indices in small.items() if len(indices) == 4)
    assert all(large[name][: len(indices)] == indices for name, indices in small.items())
    for plans, count in ((small, 37), (large, 90)):
        assert sorted(i for indices in plans.values() for i in indices) == list(range(count))
        for name, indices in plans.items():
            assert {split_of(index) for index in indices} == {name.rpartition("-")[0]}


def test_nothing_to_plan():
    with pytest.raises(UsageError, match="--count 0"):
        plan_shards(split_of, 0, 4)
