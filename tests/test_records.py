import json

import pytest

from panokit.errors import Rejection, StorageError
from panokit.io.files import file_entry, write_json
from panokit.ledger import Ledger
from panokit.records import Receipt, RunFolder, is_complete, require_folder, stage_key


def finished(path, key):
    path.write_bytes(b"pixels")
    write_json(path.with_suffix(".json"), {"key": key, "files": {path.name: file_entry(path)}})


def test_everything_that_makes_a_result_is_in_its_key():
    base = ("expand", "1", "settings", ["input"], "weights")
    changed = [
        ("stitch", "1", "settings", ["input"], "weights"),
        ("expand", "2", "settings", ["input"], "weights"),
        ("expand", "1", "other", ["input"], "weights"),
        ("expand", "1", "settings", ["other"], "weights"),
        ("expand", "1", "settings", ["input"], "other"),
    ]
    keys = {stage_key(*parts) for parts in [base, *changed]}
    assert len(keys) == 6
    assert stage_key(*base) == stage_key(*base)


def test_complete_means_record_key_and_size(tmp_path):
    path = tmp_path / "a.exr"
    assert not is_complete(path, "k")
    finished(path, "k")
    assert is_complete(path, "k")
    assert not is_complete(path, "other")
    path.write_bytes(b"pix")
    assert not is_complete(path, "k")
    finished(path, "k")
    path.with_suffix(".json").write_text('{"key": "k", "fil')
    assert not is_complete(path, "k")


def test_the_log_is_appended_and_leftovers_are_removed(tmp_path):
    run = RunFolder(tmp_path / "run").create()
    run.log("start", city="Bristol")
    run.log("end")
    lines = (run.root / "log.jsonl").read_text().splitlines()
    events = [json.loads(line)["event"] for line in lines]
    assert events == ["start", "end"]
    run.probes.mkdir()
    (run.probes / ".a.exr.x.part").write_bytes(b"half")
    assert run.remove_leftovers() == 1
    assert run.remove_leftovers() == 0


def test_a_run_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "run").write_text("not a folder")
    with pytest.raises(StorageError):
        RunFolder(tmp_path / "run").create()
    with pytest.raises(StorageError, match="Check"):
        require_folder(tmp_path / "nowhere")


def test_the_ledger_remembers_by_item_stage_and_key(tmp_path):
    ledger = Ledger(tmp_path / "ledger.sqlite")
    assert ledger.rejections() == []
    rejection = Rejection(item="p", stage="stitch", reason="bad-tile", message="m", values={"x": 1})
    ledger.add(rejection, "k")
    assert ledger.find("p", "stitch", "k") == rejection
    assert ledger.find("p", "stitch", "other") is None
    assert ledger.rejections("expand") == []
    ledger.add(rejection, "k2")
    assert len(ledger.rejections()) == 1
    ledger.add_done(Receipt(item="p", stage="stitch", path=tmp_path, key="k"))
    assert ledger.rejections() == []
    assert ledger.content() == [("p", "stitch", "k", "done")]


def test_a_damaged_ledger_says_what_to_do(tmp_path):
    (tmp_path / "ledger.sqlite").write_bytes(b"not a database, not at all" * 50)
    with pytest.raises(StorageError, match="delete it"):
        Ledger(tmp_path / "ledger.sqlite").rejections()
