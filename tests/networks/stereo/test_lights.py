"""Lobes of light: where they point, how much light they hold, and within which bounds."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from panokit.networks.stereo.lights import LightLobes  # noqa: E402
from panokit.sphere import equirect_directions, row_solid_angles  # noqa: E402

pytestmark = pytest.mark.train
SIZE = 128
LOG_MAX = float(np.log1p(1e3))


class Saying(torch.nn.Module):
    """In place of the head: always the same numbers."""

    def __init__(self, raw):
        super().__init__()
        self.raw = torch.tensor(raw, dtype=torch.float32)

    def forward(self, features):
        return self.raw.flatten().expand(len(features), -1)


def lobes(*raw, size=SIZE):
    """A head that says lobes: (direction, share of sharpness, strength, color) as raw numbers."""
    found = LightLobes(4, len(raw), size, LOG_MAX)
    found.head = Saying(raw)
    return found


@pytest.mark.parametrize(
    "direction", [(0, 0, -1), (1, 0, 0), (-0.6, 0.64, 0.48), (0, 0.8, 0.6), (0.1, -0.9, -0.4)]
)
def test_a_lobe_is_brightest_in_its_direction(direction):
    direction = np.array(direction) / np.linalg.norm(direction)
    radiance = lobes([*(50 * direction), 1.0, 1.0, 0, 0, 0])(torch.zeros(1, 4))[0]
    gray = radiance.mean(dim=0).detach().numpy()
    peak = equirect_directions(SIZE, SIZE)[np.unravel_index(gray.argmax(), gray.shape)]
    # A pixel is 2.8 degrees wide and 1.4 high.
    assert np.degrees(np.arccos(np.clip(peak @ direction, -1, 1))) < 1.7


@pytest.mark.parametrize("share", [-20.0, -1.0, 0.0, 1.0])
def test_the_energy_of_a_lobe_is_that_of_its_formula(share):
    """2 pi a (1 - exp(-2 k)) / k over the sphere."""
    head = lobes([3.0, 5.0, -2.0, share, 1.0, 0.0, 1.0, 2.0], size=512)
    features = torch.zeros(2, 4)
    _, sharpness, amplitude = (part.detach().numpy() for part in head.lights(features))
    radiance = head(features).detach().numpy()
    energy = np.einsum("bchw,h->bc", radiance, row_solid_angles(512, 512))
    k = sharpness[0, 0]
    expected = 2 * np.pi * amplitude[:, 0] * (1 - np.exp(-2 * k)) / k
    np.testing.assert_allclose(energy, expected, rtol=2e-3)


def test_lobes_add_up():
    one, other = [5.0, 0, 0, 0, 1, 0, 0, 0], [0, 5.0, 0, 1, 0, 1, 0, 0]
    features = torch.zeros(1, 4)
    torch.testing.assert_close(
        lobes(one, other)(features), lobes(one)(features) + lobes(other)(features)
    )


def test_no_number_of_the_head_leaves_the_bounds():
    """Between a wide glow and a pixel of the map, and never brighter than the coding can say."""
    for extreme in (-1e4, 1e4):
        direction, sharpness, amplitude = lobes([extreme] * 8).lights(torch.zeros(1, 4))
        assert direction.norm(dim=-1).item() == pytest.approx(1, abs=1e-5)
        assert 1 - 1e-4 <= sharpness.item() <= 400 + 1e-2
        assert (amplitude >= 0).all()
        assert amplitude.mean().item() <= 1e3 * (1 + 1e-4)


def test_a_head_learns_to_point():
    torch.manual_seed(0)
    head = LightLobes(4, 1, 32, LOG_MAX)
    features = torch.randn(1, 4)
    wanted = torch.nn.functional.normalize(torch.tensor([[0.3, 0.8, -0.5]]), dim=-1)
    areas = torch.from_numpy(row_solid_angles(32, 32).astype(np.float32))
    optimizer = torch.optim.Adam(head.parameters(), lr=1e-2)
    for _ in range(60):
        radiance = head(features).mean(dim=1)
        optimizer.zero_grad()
        vector = torch.einsum("bhw,khw,h->bk", radiance, head.directions, areas)
        (-torch.nn.functional.cosine_similarity(vector, wanted).mean()).backward()
        optimizer.step()
    direction, _, _ = head.lights(features)
    assert float((direction[0] @ wanted[0]).detach()) > 0.97
