"""`panokit evaluate` as a user meets it."""

import json

import pytest

from panokit.cli.main import main
from panokit.dataset import ProductionSettings, render_dataset
from tests.dataset.fake import FakeMaker


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    out = tmp_path_factory.mktemp("data") / "stereo"
    render_dataset(FakeMaker(), out, ProductionSettings(count=40, workers=0))
    return out


def test_baselines_alone_make_a_report(data, tmp_path, capsys):
    out = tmp_path / "scores"
    code = main(["evaluate", "--data", str(data), "--out", str(out), "--count", "2",
                 "--protocol-count", "0", "--training-maps", "5"])  # fmt: skip
    captured = capsys.readouterr()
    assert code == 0
    assert "mean map" in captured.out
    assert max(map(len, captured.out.splitlines()[:8])) <= 80
    assert "evaluate: 2 of 2" in captured.err
    assert (out / "report.html").stat().st_size > 10_000
    assert main(["evaluate", "figures", str(out), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["samples"] == 2
    assert "F5.7" in summary["figures"]


def test_nothing_to_judge_is_a_wrong_call(data, tmp_path, capsys):
    code = main(["evaluate", "--no-baselines", "--data", str(data), "--out", str(tmp_path)])
    assert code == 2
    assert "nothing to judge" in capsys.readouterr().err


def test_a_model_that_is_not_there_is_named(data, tmp_path, capsys):
    code = main(["evaluate", "no-such-model", "--data", str(data), "--out", str(tmp_path)])
    said = capsys.readouterr().err
    assert code != 0
    assert len(said.splitlines()) == 1
    assert "no-such-model" in said


def test_an_empty_split_or_folder_is_named(data, tmp_path, capsys):
    assert main(["evaluate", "--data", str(tmp_path), "--out", str(tmp_path / "o")]) != 0
    assert str(tmp_path) in capsys.readouterr().err
    assert main(["evaluate", "figures", str(tmp_path)]) != 0
    assert "no results.jsonl" in capsys.readouterr().err
