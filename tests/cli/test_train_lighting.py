"""`panokit train` for lighting: what it wants to be told, and a suite from a dataset to models."""

import pytest

pytest.importorskip("torch")

from panokit.cli.main import main
from panokit.dataset.production.produce import render_dataset
from panokit.dataset.production.settings import ProductionSettings
from tests.dataset.fake import FakeMaker

pytestmark = pytest.mark.train
RECIPE = 'id = "mine"\ntask = "lighting"\n'
SIZE = """
samples = 8
[network]
input_px = 16
width = 4
[schedule]
epochs = 1
batch = 4
"""


@pytest.fixture
def files(tmp_path):
    folder = tmp_path / "recipes"
    folder.mkdir()
    (folder / "mine.toml").write_text(RECIPE)
    (tmp_path / "tiny.toml").write_text(SIZE)
    return folder


def error(capsys, *arguments, code=2):
    assert main(["train", *map(str, arguments)]) == code
    lines = capsys.readouterr().err.strip().splitlines()
    return lines[-1]


def test_networks_that_read_light_need_a_dataset(files, capsys):
    said = error(capsys, files / "mine.toml", "--probes", files)
    assert "learn from a stereo dataset: --data DIR" in said


def test_a_folder_needs_a_size_and_takes_its_seeds(files, capsys):
    assert "A suite needs a size" in error(capsys, files, "--data", files)
    tail = ("--size", "pocket", "--seed", "1")
    assert "A suite needs a size, and takes its seeds" in error(
        capsys, files, "--data", files, *tail
    )


def test_a_recipe_with_a_typo_is_named_with_the_place_of_the_typo(files, capsys):
    (files / "mine.toml").write_text(f"{RECIPE}[network]\nfusoin = 'concat'\n")
    said = error(capsys, files / "mine.toml", "--data", files)
    assert "mine.toml: network.fusoin" in said
    said = error(capsys, files, "--data", files, "--size", "pocket")
    assert "mine.toml: network.fusoin" in said


def test_a_size_that_is_not_there_is_named_with_those_that_are(files, capsys):
    said = error(capsys, files / "mine.toml", "--data", files, "--size", "poket")
    assert "no size 'poket'; there are full, pocket, two-core" in said


def test_a_dataset_that_is_not_there_is_a_storage_error(files, capsys):
    place = files / "nowhere"
    said = error(capsys, files / "mine.toml", "--data", place, "--work", files / "work", code=4)
    assert str(place) in said


def test_a_suite_becomes_models_and_is_not_trained_twice(files, tmp_path, capsys):
    data, work = tmp_path / "stereo", tmp_path / "work"
    render_dataset(FakeMaker(), data, ProductionSettings(count=20, workers=0))
    (files / "more.toml").write_text(
        'id = "more"\ntask = "lighting"\n[[sources]]\ndata = "../elsewhere"\n'
    )
    command = ["train", str(files), "--data", str(data), "--work", str(work), "--processes", "1",
               "--size", str(tmp_path / "tiny.toml")]  # fmt: skip
    # One recipe has samples, the other's are not there.
    assert main(command) == 1
    said = capsys.readouterr()
    assert "Networks trained: 1, there already: 0, missing: 1" in said.out
    assert "There is no more-tiny-s0" in said.err
    assert f"panokit evaluate {work / 'models'} --data {data}" in said.out
    assert (work / "models" / "mine-tiny-s0" / "lighting.onnx").is_file()
    (files / "more.toml").unlink()
    assert main(command) == 0
    assert "Networks trained: 0, there already: 1, missing: 0" in capsys.readouterr().out


def test_one_recipe_with_a_seed_is_one_model(files, tmp_path, capsys):
    data, out = tmp_path / "stereo", tmp_path / "out"
    render_dataset(FakeMaker(), data, ProductionSettings(count=20, workers=0))
    command = ["train", str(files / "mine.toml"), "--data", str(data), "--out", str(out),
               "--work", str(tmp_path / "work"), "--device", "cpu",
               "--size", str(tmp_path / "tiny.toml"), "--seed", "2"]  # fmt: skip
    assert main(command) == 0
    assert f"panokit evaluate {out / 'mine-tiny-s2'}" in capsys.readouterr().out
    training = (out / "mine-tiny-s2" / "training.json").read_text()
    assert '"experiment": "mine"' in training
