"""What travels in models/: each is complete, documented and what its recipe says."""

import json
from pathlib import Path

import pytest

from panokit.shipped import shipped_path
from panokit.train.recipe import read_recipe
from panokit.weights import ReleasedModel, released_models, verify_model

MOST_BYTES = 9_000_000


@pytest.fixture(params=[model.id for model in released_models()])
def model(request: pytest.FixtureRequest) -> ReleasedModel:
    return next(model for model in released_models() if model.id == request.param)


def test_every_recipe_loads_and_names_its_folder():
    folder = shipped_path("models")
    recipes = sorted(folder.glob("*/recipe.toml"))
    assert recipes
    for path in recipes:
        assert read_recipe(path).id == path.parent.name


def test_files_are_as_released_and_small(model: ReleasedModel):
    verify_model(model)
    size = sum(path.stat().st_size for path in Path(model.folder).iterdir() if path.is_file())
    assert size < MOST_BYTES


def test_the_scores_beat_every_analytic_method(model: ReleasedModel):
    metrics = json.loads((model.folder / "metrics.json").read_text(encoding="utf-8"))
    assert metrics["folds"] >= 5
    for camera in ("A", "B"):
        methods = metrics["summary"][camera]
        for column in ("irradiance median", "irradiance mean", "light vector mean (deg)"):
            best = min(figures[column]["value"] for name, figures in methods.items()
                       if name != "recipe")  # fmt: skip
            assert methods["recipe"][column]["value"] < best, (camera, column)


def test_the_card_says_what_a_user_must_know(model: ReleasedModel):
    card = (model.folder / "README.md").read_text(encoding="utf-8")
    for heading in ("## Use", "## Limits", "## Data and license", "## Scores", "## Failures"):
        assert heading in card
    for line in card.splitlines():
        if "](" in line and "](http" not in line:
            assert (model.folder / line.split("](")[1].split(")")[0]).exists(), line


def test_released_files_name_no_file_of_their_maker():
    files = sorted((Path(__file__).parent.parent / "models").glob("*/*.onnx"))
    assert files
    for file in files:
        data = file.read_bytes()
        assert b"site-packages" not in data, file
        assert b".py" not in data, file
