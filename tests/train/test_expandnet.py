import json
from pathlib import Path

import numpy as np
import pytest

from panokit.errors import SettingsError
from panokit.shipped import shipped_path
from panokit.train.expandnet_recipe import ExpandNetRecipe, read_expandnet_recipe

pytestmark = pytest.mark.train
torch = pytest.importorskip("torch")

TINY = ExpandNetRecipe(
    architecture="expandnet", id="tiny", steps=12, batch=2, crop_px=32, smallest_crop_px=32,
    largest_crop_px=48, learning_rate=1e-3,
)  # fmt: skip


def photographed(seed: int = 0):
    from panokit.color.camera import CAMERA_A, photograph
    from panokit.train.expandnet import PhotographedProbe

    random = np.random.default_rng(seed)
    radiance = random.uniform(0.2, 1, (64, 128, 3)).astype(np.float32)
    radiance[10:14, 20:30] = 20
    pictures = (photograph(radiance, CAMERA_A).pixels,)
    return PhotographedProbe(radiance=radiance, pictures=pictures)


def test_a_crop_is_a_picture_and_its_light_between_0_and_1():
    from panokit.train.expandnet import cut_crop

    probe = photographed()
    lamps = 0
    for seed in range(20):
        picture, light = cut_crop(probe, TINY, np.random.default_rng(seed))
        assert picture.shape == light.shape == (3, 32, 32)
        assert picture.min() >= 0 and picture.max() <= 1
        assert light.min() == pytest.approx(0, abs=1e-6)
        assert light.max() == pytest.approx(1, rel=1e-5)
        # Where the light is brightest, so is the picture: both are cut at the same place.
        if (light.min(axis=0) > 0.9).any():
            lamps += 1
            assert picture.min(axis=0)[light.min(axis=0) > 0.9].min() > 0.7
    assert lamps > 3


def test_training_lowers_the_loss_goes_on_where_it_stopped_and_repeats(tmp_path: Path):
    from panokit.train.expandnet import fit_expandnet

    probes = [photographed(0), photographed(1)]
    recipe = TINY.model_copy(update={"steps": 40})
    whole, losses = fit_expandnet(probes, recipe)
    checkpoint = tmp_path / "state.pt"
    half = recipe.model_copy(update={"steps": 20})
    fit_expandnet(probes, half, checkpoint=checkpoint)
    resumed, _ = fit_expandnet(probes, recipe, checkpoint=checkpoint)
    for a, b in zip(whole.parameters(), resumed.parameters(), strict=True):
        assert torch.equal(a, b)
    first, _ = fit_expandnet(probes, TINY.model_copy(update={"steps": 1}))
    assert losses[-1] < fit_expandnet(probes, TINY.model_copy(update={"steps": 1}))[1][0]
    assert not torch.equal(next(first.parameters()), next(whole.parameters()))


def test_the_export_computes_what_torch_computes(tmp_path: Path):
    from panokit.networks.expandnet import ExpandNet
    from panokit.train.expandnet import PARITY, check_parity, export_expandnet

    torch.manual_seed(0)
    network = ExpandNet().eval()
    export_expandnet(network, tmp_path / "net.onnx")
    assert check_parity(network, tmp_path / "net.onnx") < PARITY == 1e-5


def test_the_recipe_in_models_loads_and_names_its_folder():
    path = shipped_path("models/expandnet/expandnet.toml")
    recipe = read_expandnet_recipe(path)
    assert recipe.id == path.parent.name
    assert recipe.held_out is not None
    seen = json.loads((path.parent / "training.json").read_text(encoding="utf-8"))
    assert seen["recipe_digest"] == recipe.digest
    assert len(seen["seen"]) >= 50


def test_a_wrong_recipe_is_refused_by_name(tmp_path: Path):
    path = tmp_path / "expandnet.toml"
    path.write_text('architecture = "expandnet"\nid = "x"\nstep = 3\n', encoding="utf-8")
    with pytest.raises(SettingsError, match="step"):
        read_expandnet_recipe(path)
    path.write_text("id = ", encoding="utf-8")
    with pytest.raises(SettingsError, match="TOML"):
        read_expandnet_recipe(path)
