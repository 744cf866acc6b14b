"""What travels in models/: each is complete, documented and what its recipe says."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from panokit.cli.main import main
from panokit.evaluate.expansion_report import PROTOCOL, SCHEMA
from panokit.evaluate.figures import LINES
from panokit.inference import Session
from panokit.shipped import shipped_path
from panokit.train.recipe import read_recipe, read_table
from panokit.train.stereo.recipe import read_lighting_recipe
from panokit.weights import ReleasedModel, find_model, released_models, verify_model

MOST_BYTES = 9_000_000
EXPANSION = [model.id for model in released_models() if model.task.startswith("expand")]
# What a user looks for, and the probes' word for it.
KINDS = {
    "sun": "outdoor_sunny",
    "overcast": "outdoor_overcast",
    "night": "outdoor_night",
    "window": "indoor_windows",
    "artificial": "indoor_artificial",
    "studio": "indoor_studio",
}


@pytest.fixture(params=EXPANSION)
def model(request: pytest.FixtureRequest) -> ReleasedModel:
    return next(model for model in released_models() if model.id == request.param)


@pytest.fixture
def card(model: ReleasedModel) -> str:
    return (model.folder / "README.md").read_text(encoding="utf-8")


@pytest.fixture
def metrics(model: ReleasedModel) -> dict[str, Any]:
    return json.loads((model.folder / "metrics.json").read_text(encoding="utf-8"))


def test_every_recipe_loads_and_names_its_folder():
    folder = shipped_path("models")
    recipes = sorted(folder.glob("*/recipe.toml"))
    assert recipes
    for path in recipes:
        lights = read_table(path).get("task") == "lighting"
        read = read_lighting_recipe if lights else read_recipe
        assert read(path).id == path.parent.name


def test_the_three_models_are_there():
    assert {"expand-1", "expand-2", "expandnet"} <= set(EXPANSION)


def test_files_are_as_released_and_small(model: ReleasedModel):
    verify_model(model)
    size = sum(path.stat().st_size for path in Path(model.folder).iterdir() if path.is_file())
    assert size < MOST_BYTES


def test_every_input_and_output_is_described(model: ReleasedModel):
    names = set()
    for role, file in model.files.items():
        session = Session(model.path(role), device="cpu")
        assert session.inputs == file.inputs, role
        assert session.outputs == file.outputs, role
        names |= {*file.inputs, *file.outputs}
        for name, shape in zip(session.inputs, session.input_shapes, strict=True):
            told = model.tensors[name].shape
            assert len(told) == len(shape), name
            for length, meant in zip(shape, told, strict=True):
                assert length == meant if isinstance(meant, int) else length is None, name
    assert set(model.tensors) == names
    for name, tensor in model.tensors.items():
        assert tensor.type == "float32", name
        assert len(tensor.meaning) > 10, name


def test_the_card_says_what_a_user_must_know(model: ReleasedModel, card: str):
    headings = re.findall(r"^## (.+)$", card, re.MULTILINE)
    assert headings == [
        "Use",
        "Input and output",
        "Limits",
        "Data and license",
        "Scores",
        "Failures",
    ]
    sections = dict(zip(headings, re.split(r"^## .+$", card, flags=re.MULTILINE)[1:], strict=True))
    assert "CC0" in sections["Data and license"]
    assert "HDRI Haven" in sections["Data and license"]
    for name in model.tensors:
        assert f"`{name}`" in sections["Input and output"]
    for kind, category in KINDS.items():
        assert category in sections["Scores"], kind
    assert re.search(r"!\[.+\]\(.+\.jpg\)", sections["Failures"])
    for link in re.findall(r"\]\((?!http)([^)]+)\)", card):
        assert (model.folder / link).exists(), link


def test_the_card_shows_the_figures_of_its_metrics(card: str, metrics: dict[str, Any]):
    digits = {line.key: line.digits for line in LINES}
    rows = [line for line in card.splitlines() if line.startswith("|")]
    for camera, columns in metrics["cameras"].items():
        own = columns[metrics["model"]]
        (row,) = [r for r in rows if r.startswith(f"| {camera} | {metrics['model'].split()[0]}")]
        for key in ("irradiance_median", "light_vector_mean", "ball_median", "energy_median"):
            assert f"{own['figures'][key]['value']:.{digits[key]}f}" in row, (camera, key)
        for category in KINDS.values():
            value = own["categories"][category]["irradiance_median"]["value"]
            (row,) = [r for r in rows if r.startswith(f"| {category} |")]
            assert f"{value:.{digits['irradiance_median']}f}" in row, (camera, category)


def test_the_scores_are_of_probes_that_it_has_not_seen(metrics: dict[str, Any]):
    assert (metrics["schema"], metrics["protocol"]) == (SCHEMA, PROTOCOL)
    assert metrics["settings"]["folds"] == 5
    for camera in ("A", "B"):
        own = metrics["cameras"][camera][metrics["model"]]
        assert own["status"] == "unseen"
        assert own["pictures"] >= 15
        assert len([row for row in metrics["rows"] if row["camera"] == camera]) == own["pictures"]
    assert not any(row["seen"] for row in metrics["rows"])


@pytest.mark.parametrize("name", [m.id for m in released_models() if m.task == "expand"])
def test_the_scores_beat_every_analytic_method(name: str):
    folder = shipped_path(f"models/{name}/model.toml").parent
    metrics = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    for camera, columns in metrics["cameras"].items():
        for key in ("irradiance_median", "irradiance_mean", "light_vector_mean"):
            values = {name: column["figures"][key]["value"] for name, column in columns.items()}
            own = values.pop(metrics["model"])
            assert own < min(values.values()), (camera, key)


def test_the_command_shows_the_card_and_the_tensors(model: ReleasedModel, capsys):
    assert main(["models", "show", model.id]) == 0
    shown = capsys.readouterr().out
    assert "## Limits" in shown
    for name, tensor in model.tensors.items():
        assert name in shown
        assert tensor.meaning in shown
    assert main(["models", "show", model.id, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert set(told["tensors"]) == set(model.tensors)
    for role, file in model.files.items():
        assert told["files"][role] == {"name": file.name, "sha256": file.sha256}


def test_a_baseline_is_no_model_to_expand_with(tmp_path: Path, capsys):
    arguments = ["expand", str(tmp_path / "x.jpg"), "--out", str(tmp_path / "o")]
    (tmp_path / "x.jpg").write_bytes(b"")
    assert main([*arguments, "--model", "expandnet"]) != 0
    error = capsys.readouterr().err
    assert "expand-2" in error
    assert "expandnet'" in error


def test_released_files_name_no_file_of_their_maker():
    files = sorted((Path(__file__).parent.parent / "models").glob("*/*.onnx"))
    assert files
    for file in files:
        data = file.read_bytes()
        assert b"site-packages" not in data, file
        assert b".py" not in data, file


READS_LIGHT = [model.id for model in released_models() if model.task == "lighting"]


@pytest.mark.parametrize("name", READS_LIGHT)
def test_a_model_that_reads_light_is_complete(name: str):
    model = find_model(name)
    verify_model(model)
    recipe = read_lighting_recipe(model.folder / "recipe.toml")
    training = json.loads((model.folder / "training.json").read_text(encoding="utf-8"))
    assert recipe.id == name == model.folder.name
    assert (training["samples"], training["seed"]) == (recipe.samples, recipe.seed)
    session = Session(model.path("lighting"), device="cpu")
    assert session.inputs == model.files["lighting"].inputs
    assert all(shape[0] is None for shape in session.input_shapes)
    assert set(model.tensors) == {*session.inputs, *session.outputs}


@pytest.mark.parametrize("name", READS_LIGHT)
def test_its_card_tells_its_scores_and_its_limits(name: str):
    folder = find_model(name).folder
    text = (folder / "README.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (.+)$", text, re.MULTILINE)
    assert headings == [
        "Use", "Input and output", "Limits", "Data and license", "Scores", "Failures",
    ]  # fmt: skip
    for link in re.findall(r"\]\((?!http)([^)]+)\)", text):
        assert (folder / link).exists(), link
    scores = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    assert scores["samples"] >= 200
    for entrant, figures in scores["entrants"].items():
        (row,) = [line for line in text.splitlines() if line.startswith(f"| {entrant} |")]
        assert f"{figures['thesis-dssim']['mean']:.3f}" in row, entrant
        assert f"{figures['light-vector']['mean']:.1f}" in row, entrant
    own = scores["entrants"].pop(name)
    knowing = scores["entrants"].pop("nearest map (oracle)")
    assert knowing["code-ssd"]["mean"] < own["code-ssd"]["mean"]
    for entrant, figures in scores["entrants"].items():
        for figure in ("light-vector", "relit-diffuse-rmse"):
            assert own[figure]["mean"] < figures[figure]["mean"], (entrant, figure)
