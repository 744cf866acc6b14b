"""manifest.csv: what is read of it, and what is wrong with it."""

import pytest

from panokit.errors import RecordError, StorageError
from panokit.io.probe_manifest import read_manifest


def write(folder, text):
    (folder / "manifest.csv").write_text(text, encoding="utf-8")
    return read_manifest(folder)


def test_what_is_read(tmp_path):
    plain, full = write(
        tmp_path,
        "file,name,category,tags,licence,attribution,split_group,latitude_deg,longitude_deg,peak\n"
        "z_1k.hdr,z,outdoor_night+urban,moon bridge,cc0-1.0,Ada,old town,48.5,7.75,3\n"
        "b.exr,,,,,,,,,\n",
    )
    assert (full.name, full.category, full.tags) == (
        "z",
        "outdoor_night",
        ("urban", "moon", "bridge"),
    )
    assert (full.license.id, full.license.attribution, full.license.train) == (
        "CC0-1.0",
        "Ada",
        True,
    )
    assert (full.group, full.place, full.path) == ("old town", "old town", tmp_path / "z_1k.hdr")
    assert (full.latitude_deg, full.longitude_deg) == (48.5, 7.75)
    assert (plain.name, plain.group, plain.place, plain.usable_for) == ("b", "b", "", "training")
    assert (plain.license.id, plain.license.train) == ("unknown", False)


def test_names_of_others(tmp_path):
    (row,) = write(
        tmp_path, "file,license,place,split_group\na.exr,CC-BY-4.0 (c) 2021 Ada,Lyon,group 3\n"
    )
    assert (row.license.id, row.license.attribution) == ("CC-BY-4.0", "(c) 2021 Ada")
    assert (row.place, row.group) == ("Lyon", "group 3")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name,category\na,b\n", "line 2: there is no `file`"),
        ("file,latitude_deg\na.exr,4\nb.exr,north\n", "line 3"),
        ("file,latitude_deg\na.exr,95\n", "latitude_deg is 95, not -90 to 90"),
    ],
)
def test_what_is_wrong_is_told_with_the_line(tmp_path, text, said):
    with pytest.raises(RecordError, match=said):
        write(tmp_path, text)


def test_what_is_no_table_or_not_there(tmp_path):
    with pytest.raises(StorageError):
        read_manifest(tmp_path)
    (tmp_path / "manifest.csv").write_bytes(b"\xff\xfe\x00file")
    with pytest.raises(RecordError, match="no CSV table"):
        read_manifest(tmp_path)
