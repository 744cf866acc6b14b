import pytest

from panokit.capture import TileGrid
from panokit.errors import RecordError
from panokit.io.captures import StoredCapture, read_capture, tile_name, write_capture
from panokit.io.files import sha256_of_bytes


def test_a_capture_comes_back_and_notices_changed_bytes(tmp_path, capture):
    name = tile_name(3, 1)
    (tmp_path / "tiles").mkdir()
    (tmp_path / name).write_bytes(b"tile")
    grid = TileGrid(
        width_px=1664, height_px=832, tile_width_px=512, tile_height_px=512, missing=((2, 1),)
    )
    stored = StoredCapture(
        folder=tmp_path, capture=capture, grid=grid, files={name: sha256_of_bytes(b"tile")}
    )
    write_capture(stored, raw={"from": "the provider"})
    back = read_capture(tmp_path)
    assert (back.capture, back.grid, back.files) == (capture, grid, stored.files)
    assert back.read(name) == b"tile"
    (tmp_path / name).write_bytes(b"other")
    with pytest.raises(RecordError, match="fetch again"):
        back.read(name)


def test_without_a_record_there_is_no_capture(tmp_path):
    with pytest.raises(RecordError):
        read_capture(tmp_path)
    (tmp_path / "capture.json").write_text('{"schema": "panokit.capture/9"}')
    with pytest.raises(RecordError, match="this version"):
        read_capture(tmp_path)
