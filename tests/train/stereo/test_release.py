"""What a released model says of itself."""

import pytest

pytest.importorskip("torch")

from panokit.evaluate.lighting.models import read_facts
from panokit.train.stereo.recipe import LightingRecipe, NormalsRecipe
from panokit.train.stereo.release import FILE, _description

pytestmark = pytest.mark.train


@pytest.mark.parametrize("noise_deg, smooth_px", [(0.0, 0.0), (15.0, 2.0), (15.0, 0.0)])
def test_a_model_is_judged_with_normals_like_those_it_learned_from(tmp_path, noise_deg, smooth_px):
    recipe = LightingRecipe(
        id="mine",
        kind="dematerial",
        normals=NormalsRecipe(noise_deg=noise_deg, smooth_px=smooth_px),
    )
    (tmp_path / FILE).write_bytes(b"weights")
    (tmp_path / "model.toml").write_text(_description(recipe, tmp_path))
    facts = read_facts(tmp_path)
    assert (facts.noise_deg, facts.smooth_px) == (noise_deg, smooth_px)
    assert facts.coding == recipe.coding.coding
    assert (facts.kind, facts.input_px, facts.views) == ("dematerial", 128, "object")
