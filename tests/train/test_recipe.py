from pathlib import Path

import pytest

from panokit.errors import SettingsError, StorageError
from panokit.shipped import shipped_path
from panokit.train.expandnet_recipe import ExpandNetRecipe
from panokit.train.recipe import (
    EMBEDDED_SEED,
    DataRecipe,
    Recipe,
    architecture_of,
    read_recipe,
)


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


def test_a_recipe_says_which_architecture_it_is_for(tmp_path: Path):
    assert architecture_of(write(tmp_path, 'id = "x"\n')) == "panokit"
    assert architecture_of(write(tmp_path, 'architecture = "expandnet"\n')) == "expandnet"
    with pytest.raises(SettingsError, match="'unet'"):
        architecture_of(write(tmp_path, 'architecture = "unet"\n'))
    # The name of the file means nothing.
    assert architecture_of(shipped_path("models/expandnet/expandnet.toml")) == "expandnet"
    assert architecture_of(shipped_path("models/expand-2/recipe.toml")) == "panokit"
    with pytest.raises(SettingsError, match="architecture"):
        read_recipe(write(tmp_path, 'architecture = "expandnet"\nid = "x"\n'))


def test_a_digest_counts_what_was_changed_and_nothing_else():
    assert DataRecipe().digest == DataRecipe(shots_per_probe=16, tilt_deg=0.0).digest
    assert DataRecipe(tilt_deg=3.0).digest != DataRecipe().digest
    plain = Recipe(id="x")
    assert plain.digest == Recipe.model_validate({"id": "x", "network": {"batch": 8}}).digest
    assert plain.digest != Recipe(id="x", data=DataRecipe(lower_bounds=True)).digest
    net = ExpandNetRecipe(architecture="expandnet", id="x")
    assert net.digest != net.model_copy(update={"steps": 3}).digest


def test_synthetic_light_is_a_table_of_the_data(tmp_path: Path):
    text = 'id = "x"\n[data.synthetic]\nplaces = 8\nskies = 4\nshare = 0.3\n'
    synthetic = read_recipe(write(tmp_path, text)).data.synthetic
    assert synthetic is not None and (synthetic.places, synthetic.share) == (8, 0.3)
    with pytest.raises(SettingsError, match=r"data\.synthetic\.share"):
        read_recipe(write(tmp_path, 'id = "x"\n[data.synthetic]\nshare = 1.0\n'))


def test_the_city_that_is_judged_by_is_never_trained_with(tmp_path: Path):
    from panokit.synthetic import embedded_city

    ids = [picture.capture.id for picture in embedded_city()]
    assert all(f"-{EMBEDDED_SEED}-" in name for name in ids)
    text = f'id = "x"\n[data.synthetic]\nplaces = 1\nseed = {EMBEDDED_SEED}\n'
    with pytest.raises(SettingsError, match="judged by"):
        read_recipe(write(tmp_path, text))
