import numpy as np
import pyarrow.parquet as pq
import pytest

from panokit.dataset.storage.index import index_shards, member_names, read_index
from panokit.dataset.storage.index_columns import light_direction
from panokit.dataset.storage.layout import DatasetFolder
from panokit.dataset.storage.shards import tar_bytes, write_shard
from panokit.errors import RecordError
from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.sphere import equirect_directions
from tests.dataset.conftest import COUNT
from tests.dataset.fake import FakeMaker


def test_a_row_says_what_the_sample_says(finished_dataset):
    table = read_index(finished_dataset)
    assert table.num_rows == COUNT
    row = next(row for row in table.to_pylist() if row["index"] == 6)
    meta = FakeMaker().make(6, 0).meta
    assert row["key"] == "000000006"
    assert row["place"] == meta["probe"]["place"]
    assert row["probe_license"] == "CC-BY-4.0"
    assert row["object_kind"] == "chair"
    assert row["yaw_deg"] == meta["yaw_deg"]
    assert row["roughness"] == meta["materials"][0]["roughness"]
    assert row["width_px"] == 16
    assert row["spp"] == 1
    assert row["baseline_m"] == meta["baseline_m"]
    # Not in this record: no value is better than a made-up one.
    assert row["fill"] is None


def test_columns_can_be_chosen(finished_dataset):
    table = read_index(finished_dataset, ["key", "split"])
    assert table.column_names == ["key", "split"]


def test_the_tar_files_alone_are_enough(finished_dataset, tmp_path):
    shards = DatasetFolder(finished_dataset).complete_shards()
    assert index_shards(shards).equals(read_index(finished_dataset))


def test_samples_may_have_different_members(tmp_path):
    shard = tmp_path / "train-00000.tar"
    parts = []
    for index in range(2):
        members = dict(FakeMaker().make(index, 0).members)
        if index:
            members["reflectance_1.exr"] = members.pop("reflectance.exr")
        parts.append(tar_bytes(f"{index:09d}", members))
    write_shard(shard, parts)
    table = index_shards([shard])
    assert table.column("offset/reflectance.exr").null_count == 1
    assert table.column("offset/reflectance_1.exr").null_count == 1
    names = member_names(table)
    assert names[0] == "left.png"
    assert names[-1] == "meta.json"


@pytest.mark.parametrize(
    ("members", "text"),
    [
        ({"left.png": b""}, r"has no meta\.json"),
        ({"meta.json": b"[]"}, "not the record of a sample"),
        ({"meta.json": b'{"key": "000000009", "split": "train"}'}, "speaks of sample 000000009"),
        ({"meta.json": b"{"}, "damaged"),
    ],
)
def test_a_shard_of_something_else_is_told(tmp_path, members, text):
    write_shard(tmp_path / "train-00000.tar", [tar_bytes("000000000", members)])
    with pytest.raises(RecordError, match=text):
        index_shards([tmp_path / "train-00000.tar"])


def test_an_index_of_another_version_is_refused(own_dataset):
    path = own_dataset / "index.parquet"
    pq.write_table(pq.read_table(path).replace_schema_metadata({}), path)
    with pytest.raises(RecordError, match="Delete it"):
        read_index(own_dataset)


@pytest.mark.parametrize("elevation_deg", [-35.0, 0.0, 50.0])
def test_the_direction_of_one_lamp_is_found_whatever_the_camera(elevation_deg):
    camera = Rotation.from_heading_pitch_roll(0.7, -0.4, 0.2)
    toward = direction_from_azimuth_elevation(0.9, np.deg2rad(elevation_deg))
    seen = camera.inverse.apply(toward)
    light = np.zeros((64, 64, 3), np.float32)
    light[equirect_directions(64, 64) @ seen > np.cos(np.deg2rad(6))] = 100.0
    found = light_direction(light, camera)
    assert found["light_elevation_deg"] == pytest.approx(elevation_deg, abs=2)
    assert found["light_directedness"] > 0.98


def test_even_light_has_no_direction():
    found = light_direction(np.ones((64, 64, 3), np.float32), Rotation.identity())
    assert found["light_directedness"] < 1e-6
    assert found["light_elevation_deg"] is None
    dark = light_direction(np.zeros((64, 64, 3), np.float32), Rotation.identity())
    assert dark["light_directedness"] is None
