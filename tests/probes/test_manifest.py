"""manifest.csv: what is read of it, and what is wrong with it."""

import pytest

from panokit.errors import RecordError
from panokit.probes.manifest import capture_for, read_manifest


def write(folder, text):
    (folder / "manifest.csv").write_text(text, encoding="utf-8")
    return read_manifest(folder)


def test_a_folder_without_one(tmp_path):
    assert read_manifest(tmp_path) == {}


def test_what_is_read(tmp_path):
    lines = write(
        tmp_path,
        "file,name,category,tags,licence,attribution,split_group,latitude_deg,longitude_deg,peak\n"
        "a_1k.hdr,a,outdoor_night+urban,moon bridge,cc0-1.0,Ada,old town,48.5,7.75,3\n"
        "b.exr,,,,,,,,,\n",
    )
    first = lines["a_1k.hdr"]
    assert (first.name, first.category, first.tags) == (
        "a", "outdoor_night", ("urban", "moon", "bridge"),
    )  # fmt: skip
    capture = capture_for(tmp_path / "a_1k.hdr", first.known, "CC-BY-4.0", "somebody else")
    # What the manifest says goes before what the command says.
    assert (capture.license.id, capture.license.attribution) == ("CC0-1.0", "Ada")
    assert (capture.place, capture.latitude_deg, capture.longitude_deg) == ("old town", 48.5, 7.75)
    assert lines["b.exr"].known == {}
    assert lines["b.exr"].category == ""


def test_a_command_names_the_license_where_the_manifest_does_not(tmp_path):
    capture = capture_for(tmp_path / "x.exr", {}, "CC-BY-4.0", "Ada")
    assert (capture.provider, capture.id) == ("folder", "x")
    assert capture.license.train
    unknown = capture_for(tmp_path / "x.exr", {}, "", "")
    assert (unknown.license.id, unknown.license.train) == ("unknown", False)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name,category\na,b\n", "line 2: there is no `file`"),
        ("file,latitude_deg\na.exr,north\n", "line 2"),
        ("file,latitude_deg,longitude_deg\na.exr,95,0\n", None),
    ],
)
def test_what_is_wrong_is_told_with_the_line(tmp_path, text, said):
    if said is None:
        lines = write(tmp_path, text)
        with pytest.raises(ValueError, match="latitude_deg is 95"):
            capture_for(tmp_path / "a.exr", lines["a.exr"].known, "", "")
        return
    with pytest.raises(RecordError, match=said):
        write(tmp_path, text)


def test_what_is_no_table(tmp_path):
    (tmp_path / "manifest.csv").write_bytes(b"\xff\xfe\x00file")
    with pytest.raises(RecordError, match="no CSV table"):
        read_manifest(tmp_path)
