"""Names that browsers send are made safe, and nothing comes in beyond the limits."""

import asyncio

import pytest

from panokit.app.uploads import PICTURES, VIDEOS, Inbox, safe_name
from panokit.errors import StorageError, UsageError


@pytest.fixture
def inbox(tmp_path):
    folder = tmp_path / "inbox"
    folder.mkdir()
    return Inbox(folder=folder, largest_picture_mb=1, largest_video_mb=2, most_files=3)


def receive(inbox, name, data=b"pixels", suffixes=PICTURES, **more):
    async def chunks():
        for start in range(0, len(data), 100_000):
            yield data[start : start + 100_000]

    return asyncio.run(inbox.receive(name, chunks(), suffixes, **more))


@pytest.mark.parametrize(
    ("name", "safe"),
    [
        ("street.jpg", "street.jpg"),
        ("../../../etc/cron.d/evil.jpg", "evil.jpg"),
        ("..\\..\\windows\\evil.PNG", "evil.png"),
        ("/absolute/path.jpg", "path.jpg"),
        ("C:\\pictures\\a b.jpeg", "a_b.jpeg"),
        ("....jpg", "file.jpg"),
        ("-rf.jpg", "rf.jpg"),
        ("a\x00b\n.jpg", "a_b.jpg"),
        ("a%2f..%2fb.jpg", "a_2f.._2fb.jpg"),
        ("<script>.jpg", "script.jpg"),
        ("straße über.jpg", "straße_über.jpg"),
        ("CON.jpg", "file_CON.jpg"),
        ("x" * 400 + ".jpg", "x" * 100 + ".jpg"),
    ],
)
def test_names_are_made_safe(name, safe):
    assert safe_name(name, PICTURES) == safe


@pytest.mark.parametrize("name", ["", ".jpg", "..", "a.exe", "a.jpg.sh", "a.svg", "a.html"])
def test_names_of_something_else_are_refused(name):
    with pytest.raises(UsageError, match="JPG"):
        safe_name(name, PICTURES)


def test_a_file_is_stored_inside_the_inbox_wherever_its_name_points(inbox, tmp_path):
    path = receive(inbox, "../../../outside.jpg", b"light")
    assert path.read_bytes() == b"light"
    assert path.is_relative_to(inbox.folder)
    assert [p.name for p in tmp_path.iterdir()] == ["inbox"]


def test_a_batch_cannot_leave_the_inbox_either(inbox):
    path = receive(inbox, "1.png", batch="../../frames")
    assert path.parent.parent == inbox.folder


def test_a_picture_over_the_limit_is_refused_and_leaves_nothing(inbox):
    with pytest.raises(UsageError, match="larger than 1 MB"):
        receive(inbox, "large.jpg", bytes(1_000_001))
    assert not [p for p in inbox.folder.rglob("*") if p.is_file()]
    assert receive(inbox, "fits.jpg", bytes(1_000_000)).stat().st_size == 1_000_000


def test_a_video_has_a_limit_of_its_own(inbox):
    assert receive(inbox, "v.mp4", bytes(1_900_000), VIDEOS)
    with pytest.raises(UsageError, match="larger than 2 MB"):
        receive(inbox, "v.mp4", bytes(2_000_001), VIDEOS)


def test_a_folder_of_frames_together_is_as_large_as_a_video_at_most(inbox):
    for number in range(2):
        receive(inbox, f"{number}.png", bytes(900_000), batch="frames")
    with pytest.raises(UsageError, match="larger than"):
        receive(inbox, "2.png", bytes(900_000), batch="frames")


def test_there_are_no_more_files_than_allowed(inbox):
    for number in range(3):
        receive(inbox, f"{number}.png", batch="frames")
    with pytest.raises(UsageError, match="more than 3 files"):
        receive(inbox, "4.png", batch="frames")


def test_frames_of_one_name_do_not_replace_each_other(inbox):
    one, two = (receive(inbox, "a.png", data, batch="frames") for data in (b"1", b"2"))
    assert one.read_bytes() == b"1"
    assert two.read_bytes() == b"2"


def test_a_file_alone_takes_the_place_of_the_one_before(inbox):
    first = receive(inbox, "a.jpg")
    second = receive(inbox, "b.jpg")
    assert not first.exists()
    assert second.exists()


def test_an_empty_file_and_one_that_breaks_off_leave_nothing(inbox):
    with pytest.raises(UsageError, match="empty"):
        receive(inbox, "empty.jpg", b"")

    async def broken():
        yield b"half"
        raise ConnectionResetError

    with pytest.raises(StorageError):
        asyncio.run(inbox.receive("half.jpg", broken(), PICTURES))
    assert not [p for p in inbox.folder.rglob("*") if p.is_file()]
