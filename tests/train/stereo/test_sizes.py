"""Sizes: the same experiment small or large, and every recipe of the suite at each of them."""

import tomllib
from pathlib import Path

import pytest

torch = pytest.importorskip("torch")

from panokit.errors import SettingsError, StorageError, UsageError  # noqa: E402
from panokit.shipped import shipped_path  # noqa: E402
from panokit.train.stereo.recipe import LightingRecipe, read_lighting_recipe  # noqa: E402
from panokit.train.stereo.release import inputs_of  # noqa: E402
from panokit.train.stereo.sizes import SUITE, at_size, read_size  # noqa: E402
from panokit.train.stereo.tasks import build_network  # noqa: E402

pytestmark = pytest.mark.train
ROOT = Path(__file__).parents[3]
RECIPES = sorted((ROOT / SUITE).glob("*.toml"))
SIZES = ("pocket", "two-core", "full")

RECIPE = """
id = "mine"
task = "lighting"
samples = 7

[network]
layers = 2
width = 12

[schedule]
learning_rate = 0.5
"""
SIZE = """
seeds = 2
samples = 100

[network]
input_px = 64
width = 8

[schedule]
epochs = 4
learning_rate = 0.25
"""


@pytest.fixture
def files(tmp_path):
    recipe, size = tmp_path / "mine.toml", tmp_path / "small.toml"
    recipe.write_text(RECIPE)
    size.write_text(SIZE)
    return recipe, size


def test_a_size_fills_in_what_the_recipe_leaves_open(files):
    made = at_size(files[0], str(files[1]), 3)
    assert (made.network.input_px, made.schedule.epochs) == (64, 4)
    assert made.schedule.batch == LightingRecipe(id="x").schedule.batch
    assert made.network.layers == 2


def test_what_the_recipe_says_counts_more(files):
    made = at_size(files[0], str(files[1]))
    assert (made.network.width, made.schedule.learning_rate, made.samples) == (12, 0.5, 7)


def test_the_id_says_size_and_seed(files):
    recipe, size = files
    assert at_size(recipe, str(size)).id == "mine-small-s0"
    assert at_size(recipe, str(size), 3).id == "mine-small-s3"
    assert at_size(recipe, str(size), 3).seed == 3
    assert at_size(recipe, "", 3).id == "mine-s3"
    assert at_size(recipe, "") == read_lighting_recipe(recipe)


def test_seeds_differ_in_nothing_else(files):
    one, two = (at_size(files[0], str(files[1]), seed) for seed in (0, 1))
    assert one.digest != two.digest
    assert one.model_copy(update={"id": "", "seed": 0}) == two.model_copy(
        update={"id": "", "seed": 0}
    )


def test_unknown_sizes_are_refused_with_those_that_are_known(files):
    with pytest.raises(UsageError, match=r"no size 'huge'; there are full, pocket, two-core"):
        at_size(files[0], "huge")
    with pytest.raises(StorageError, match="nowhere"):
        read_size("nowhere.toml")


@pytest.mark.parametrize(
    "wrong, message",
    [("seed = 3\n", r"small\.toml: seed: "), ("seeds = 0\n", r"small\.toml: seeds: "),
     ("[network]\nlayers = 3\n", r"small\.toml: network\.layers: "),
     ("[schedule]\nepoch = 3\n", r"small\.toml: schedule\.epoch: ")],
)  # fmt: skip
def test_a_size_holds_nothing_that_would_change_the_experiment(files, wrong, message):
    files[1].write_text(wrong)
    with pytest.raises(SettingsError, match=message):
        read_size(str(files[1]))


@pytest.mark.parametrize(
    "wrong, message",
    [("[network]\nlayer = 3\n", r"mine\.toml: network\.layer: "),
     ('kind = "mono"\n', r"mine\.toml: kind: "),
     ("[loss]\nl2 = 1\n", r"mine\.toml: loss\.l2: "),
     ("[network\n", "mine.toml")],
)  # fmt: skip
def test_a_recipe_with_a_typo_is_named_with_its_place(files, wrong, message):
    files[0].write_text(f'id = "mine"\ntask = "lighting"\n{wrong}')
    with pytest.raises(SettingsError, match=message):
        at_size(files[0], str(files[1]))


def test_the_suite_is_there():
    assert len(RECIPES) >= 19
    assert {path.stem for path in shipped_path(f"{SUITE}/sizes").glob("*.toml")} == set(SIZES)
    pocket, two_core, full = map(read_size, SIZES)
    # Verdicts need three seeds and five thousand samples; 0 is all that there are.
    assert pocket.samples <= 1000
    assert min(two_core.seeds, full.seeds) >= 3
    assert two_core.samples >= 5000
    assert full.samples == 0


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.stem)
def test_every_recipe_builds_its_network_at_every_size(path):
    """Without memory for weights, as a full network would need much of it."""
    assert tomllib.loads(path.read_text())["id"] == path.stem
    for size in SIZES:
        recipe = at_size(path, size)
        with torch.device("meta"):
            network = build_network(recipe)
        count = sum(weights.numel() for weights in network.parameters())
        assert 10_000 < count < 300_000_000, (size, count)


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.stem)
def test_every_recipe_gives_a_map_at_the_smallest_size(path):
    recipe = at_size(path, "pocket")
    network = build_network(recipe).eval()
    inputs = [torch.zeros(1, channels, size, size) for channels, size in inputs_of(recipe).values()]
    with torch.inference_mode():
        assert network(*inputs).shape == (1, 3, 64, 64)
