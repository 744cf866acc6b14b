import json

from panokit.console import Console, duration_text, size_text


def test_plain_lines_when_not_on_a_terminal(capsys):
    console = Console()
    with console.stage("stitch", 3) as tick:
        tick()
        tick(rejected=True)
        tick()
    console.result("done")
    output = capsys.readouterr()
    assert output.err.startswith("stitch: 3 of 3, 1 rejected")
    assert output.out == "done\n"


def test_a_slow_stage_says_how_far_it_is_and_the_end_once(capsys, monkeypatch):
    monkeypatch.setattr("panokit.console._PLAIN_INTERVAL_S", 0.0)
    with Console().stage("expand", 3) as tick:
        for _ in range(3):
            tick()
    lines = [line.split(",")[0] for line in capsys.readouterr().err.splitlines()]
    assert lines == ["expand: 1 of 3", "expand: 2 of 3", "expand: 3 of 3"]


def test_a_stage_with_a_unit_says_its_rate_and_what_is_left(capsys, monkeypatch):
    clock = iter(range(0, 1000, 30))
    monkeypatch.setattr("panokit.console.time.monotonic", lambda: float(next(clock)))
    with Console().stage("dataset", 400, unit="samples") as tick:
        tick()
        tick(rejected=True)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "dataset: 1 of 400, 30 s, 120 samples/h, 3 h 20 min left"
    assert lines[1].startswith("dataset: 2 of 400, 1 rejected, 60 s, 120 samples/h")


def test_json_is_all_that_machines_get(capsys):
    console = Console(as_json=True)
    with console.stage("stitch", 1) as tick:
        tick()
    console.note("a remark")
    console.result("a line")
    console.value({"n": 1})
    output = capsys.readouterr()
    assert json.loads(output.out) == {"n": 1}
    assert output.err == ""


def test_tables_align(capsys):
    Console().table(("name", "n"), [("long-name", "1"), ("x", "22")])
    assert capsys.readouterr().out == "name       n\nlong-name  1\nx          22\n"


def test_sizes_and_times_for_people():
    assert [duration_text(s) for s in (5, 1500, 11100)] == ["5 s", "25 min", "3 h 5 min"]
    assert [size_text(n) for n in (12, 3.2e6, 5e12)] == ["12 B", "3.2 MB", "5.0 TB"]
