"""The losses: equal to the metrics that they stand for, and with gradients one can follow."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from panokit.color.hdr_coding import ColorCode, HdrCoding  # noqa: E402
from panokit.metrics.similarity import dssim as metric  # noqa: E402
from panokit.networks.stereo.coding import encode  # noqa: E402
from panokit.sphere import equirect_directions  # noqa: E402
from panokit.train.stereo.losses import MapLoss, dssim, light_vector, scene_matrix  # noqa: E402
from panokit.train.stereo.recipe import LossRecipe  # noqa: E402

pytestmark = pytest.mark.train
EVERYTHING = LossRecipe(l1=1, dssim=1, render=1, energy=1, direction=1)


def maps(count, seed=0):
    """Dim maps with some bright pixels, (count, 64, 64, 3)."""
    rng = np.random.default_rng(seed)
    radiance = rng.lognormal(-1, 0.7, (count, 64, 64, 3))
    radiance[:, 20:22, 30:33] += rng.uniform(5, 300, (count, 1, 1, 3))
    return radiance.astype(np.float32)


def tensor(radiance):
    return torch.from_numpy(np.moveaxis(radiance, -1, -3).copy())


@pytest.mark.parametrize("scale", [0.05, 1.0])
def test_dssim_is_that_of_the_thesis_preset(scale):
    one, other = scale * maps(3), scale * maps(3, seed=1)
    expected = np.mean([metric(a, b, "thesis")
                        for a, b in zip(one, other, strict=True)])  # fmt: skip
    # Single precision, and variances as differences of large numbers.
    assert float(dssim(tensor(one), tensor(other))) == pytest.approx(expected, abs=2e-4)
    assert float(dssim(tensor(one), tensor(one))) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("color", list(ColorCode))
@pytest.mark.parametrize("kind", ["noise", "dark", "bright", "flat"])
def test_every_gradient_is_finite(color, kind):
    coding = HdrCoding(color=color)
    shape = (2, 3, 64, 64)
    code = {
        "noise": torch.randn(shape, generator=torch.Generator().manual_seed(0)),
        "dark": torch.full(shape, -3.0),
        "bright": torch.full(shape, 5.0),
        "flat": torch.zeros(shape),
    }[kind].requires_grad_(True)
    terms = MapLoss(EVERYTHING, coding)(code, tensor(maps(2)))
    assert set(terms) == {"l1", "dssim", "render", "energy", "direction"}
    total = torch.stack(list(terms.values())).sum()
    assert torch.isfinite(total)
    total.backward()
    assert torch.isfinite(code.grad).all()
    assert code.grad.abs().sum() > 0


def test_only_what_is_weighted_is_computed():
    code, truth = torch.zeros(1, 3, 64, 64), tensor(maps(1))
    assert set(MapLoss(LossRecipe(), HdrCoding())(code, truth)) == {"l1"}
    twice = MapLoss(LossRecipe(l1=2, energy=3), HdrCoding())(code, truth)
    once = MapLoss(LossRecipe(l1=1, energy=1), HdrCoding())(code, truth)
    torch.testing.assert_close(twice["l1"], 2 * once["l1"])
    torch.testing.assert_close(twice["energy"], 3 * once["energy"])


def test_l1_is_of_the_code():
    coding = HdrCoding()
    truth = maps(1)
    code = torch.zeros(1, 3, 64, 64)
    expected = np.abs(coding.encode(truth)).mean()
    assert float(MapLoss(LossRecipe(), coding)(code, tensor(truth))["l1"]) == pytest.approx(
        expected, rel=1e-4
    )


def test_the_light_vector_points_at_the_light():
    radiance = np.zeros((1, 64, 64, 3), np.float32)
    radiance[0, 10, 50] = 7
    energy, vector = light_vector(tensor(radiance))
    direction = equirect_directions(64, 64)[10, 50]
    np.testing.assert_allclose(vector[0] / energy[0], direction, atol=1e-5)
    even_energy, even = light_vector(torch.ones(1, 3, 64, 64))
    assert float(even_energy) == pytest.approx(4 * np.pi, rel=1e-4)
    assert float(even.norm()) < 1e-3


def test_twice_the_light_is_log_two_of_energy_and_no_other_direction():
    truth = tensor(maps(2))
    terms = MapLoss(EVERYTHING, HdrCoding(brightest=1e4))(
        encode(2 * truth, HdrCoding(brightest=1e4)), truth
    )
    assert float(terms["energy"]) == pytest.approx(np.log(2), rel=2e-3)
    assert float(terms["direction"]) < 2e-3
    assert float(terms["render"]) == pytest.approx(1, rel=5e-3)


def test_scenes_count_alike():
    matrix = scene_matrix()
    assert float(matrix.min()) > -1e-4
    thirds = matrix.sum(dim=1).view(3, -1).mean(dim=1)
    torch.testing.assert_close(thirds, torch.ones(3), rtol=1e-4, atol=1e-4)
