from pathlib import Path

import pytest

from panokit.errors import SettingsError, StorageError
from panokit.train.recipe import read_recipe


def write(folder: Path, text: str) -> Path:
    path = folder / "recipe.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_recipe_has_defaults_for_all_but_its_name(tmp_path: Path):
    recipe = read_recipe(write(tmp_path, 'id = "tiny"\n[network]\nsteps = 3\n'))
    assert recipe.network.steps == 3
    assert recipe.components.steps == 700


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('id = "x"\n[network]\nstep = 3\n', "network.step"),
        ('id = "x"\n[network]\nsteps = 0\n', "network.steps"),
        ("id = ", "not valid TOML"),
        ("", "id"),
    ],
)
def test_a_wrong_recipe_is_refused_by_name(tmp_path: Path, text: str, message: str):
    with pytest.raises(SettingsError, match=message):
        read_recipe(write(tmp_path, text))


def test_a_missing_recipe_is_a_storage_error(tmp_path: Path):
    with pytest.raises(StorageError, match="recipe"):
        read_recipe(tmp_path / "none.toml")
