import json
import sys
import types

from panokit.train.history import History


def lines(folder):
    return [json.loads(x) for x in (folder / "history.jsonl").read_text().splitlines()]


def test_each_step_is_there_once_though_a_run_was_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr("panokit.train.history.find_spec", lambda _: None)
    first = History(tmp_path, "gain-0")
    for step in (10, 20, 30):
        first.note(step, {"loss": step / 10, "light": 0.5}, 1e-3)
    first.close()
    other = History(tmp_path, "gain-1")
    other.note(40, {"loss": 1.0}, 1e-3)
    # The process died while it wrote a line.
    with (tmp_path / "history.jsonl").open("a") as file:
        file.write('{"network": "gain-0", "st')
    again = History(tmp_path, "gain-0", from_step=20)
    again.note(30, {"loss": 9.0}, 2e-3)
    found = lines(tmp_path)
    assert [(x["network"], x["step"]) for x in found] == [
        ("gain-0", 10),
        ("gain-0", 20),
        ("gain-1", 40),
        ("gain-0", 30),
    ]
    assert found[-1]["loss"] == 9.0 and found[-1]["learning_rate"] == 2e-3
    assert found[0]["light"] == 0.5 and found[0]["seconds"] >= 0


def test_without_a_folder_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    history = History(None, "gain-0")
    history.note(1, {"loss": 1.0}, 1e-3)
    history.close()
    assert not list(tmp_path.iterdir())


def test_tensorboard_gets_the_same_figures_where_it_is_installed(tmp_path, monkeypatch):
    written = []

    class Writer:
        def __init__(self, place, purge_step):
            written.append((place, purge_step))

        def add_scalar(self, name, value, step):
            written.append((name, value, step))

        def close(self):
            written.append("closed")

    stand_in = types.ModuleType("torch.utils.tensorboard")
    stand_in.SummaryWriter = Writer
    monkeypatch.setitem(sys.modules, "torch.utils.tensorboard", stand_in)
    monkeypatch.setattr("panokit.train.history.find_spec", lambda name: name)
    history = History(tmp_path, "components-2", from_step=5)
    history.note(10, {"loss": 0.25}, 1e-3)
    history.close()
    assert written == [
        (str(tmp_path / "tensorboard" / "components-2"), 5),
        ("loss", 0.25, 10),
        ("learning_rate", 1e-3, 10),
        "closed",
    ]
