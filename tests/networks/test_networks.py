import numpy as np
import pytest

from panokit.expand.curve import apply_curve as apply_curve_numpy

pytestmark = pytest.mark.train
torch = pytest.importorskip("torch")


@pytest.fixture(autouse=True)
def _repeatable():
    torch.manual_seed(0)


def gain_net():
    from panokit.networks.gain_net import GainNet

    return GainNet().eval()


def test_the_gain_network_starts_at_a_few_times_white_with_the_srgb_curve():
    with torch.inference_mode():
        log_gain, slopes = gain_net()(torch.rand(2, 16, 64, 128))
    assert log_gain.shape == (2, 3, 64, 128)
    assert 0.5 < float(log_gain.mean()) < 3
    assert torch.allclose(slopes, torch.ones(2, 2), atol=1e-6)


def test_the_gain_network_turns_with_its_input_by_16_cells():
    network, grid = gain_net(), torch.rand(1, 16, 64, 128)
    with torch.inference_mode():
        first, _ = network(grid)
        second, _ = network(grid.roll(48, dims=-1))
    assert torch.allclose(second, first.roll(48, dims=-1), atol=1e-4)


def test_luminance_gain_is_never_below_one():
    with torch.inference_mode():
        log_gain, _ = gain_net()(5 * torch.randn(2, 16, 64, 128))
    # The color residual is at most half an e-fold around the common gain.
    assert float(log_gain.max(dim=1).values.min()) > -0.5


def test_an_ensemble_is_the_mean_of_its_members():
    from panokit.networks.gain_net import GainEnsemble, GainNet

    members = [GainNet().eval(), GainNet().eval()]
    grid = torch.rand(1, 16, 64, 128)
    with torch.inference_mode():
        mean, _ = GainEnsemble(members)(grid)
        each = [member(grid)[0] for member in members]
    assert torch.allclose(mean, (each[0] + each[1]) / 2, atol=1e-6)


def test_the_component_network_ignores_order_and_padding():
    from panokit.networks.component_net import ComponentNet

    network = ComponentNet(60).eval()
    rows = torch.rand(1, 5, 60)
    padded = torch.cat([rows, torch.zeros(1, 3, 60)], dim=1)
    order = [3, 0, 4, 1, 2]
    with torch.inference_mode():
        for plain, turned, more in zip(
            network(rows), network(rows[:, order]), network(padded), strict=True
        ):
            assert torch.allclose(turned, plain[:, order], atol=1e-5)
            assert torch.allclose(more[:, :5], plain, atol=1e-5)
        assert float(network(rows)[0].min()) >= 0


def expansion_net():
    from panokit.networks.component_net import ComponentEnsemble, ComponentNet
    from panokit.networks.expansion_net import ExpansionNet
    from panokit.networks.gain_net import GainEnsemble, GainNet

    gain, components = GainEnsemble([GainNet()]), ComponentEnsemble([ComponentNet(60)])
    return ExpansionNet(gain, components).eval()


def test_the_whole_network_turns_with_its_input_by_4_cells():
    network, grid, rows = expansion_net(), torch.rand(1, 16, 64, 128), torch.rand(1, 3, 60)
    with torch.inference_mode():
        first, slopes, gain, sun, weight = network(grid, rows)
        by_four = network(grid.roll(20, dims=-1), rows)[0]
    assert (first.shape, slopes.shape, gain.shape, sun.shape) == ((3, 64, 128), (2,), (3,), (3,))
    assert float(weight) == 0.5
    assert torch.allclose(by_four, first.roll(20, dims=-1), atol=1e-5)
    assert float(sun.min()) < float(sun.max())


def test_the_curve_is_the_same_in_torch_and_numpy():
    from panokit.networks.curve import apply_curve

    linear = np.linspace(0.001, 1, 64, dtype=np.float32).reshape(1, 1, 8, 8)
    slopes = torch.tensor([[0.7, 1.3]])
    found = apply_curve(torch.from_numpy(linear), slopes).numpy()
    assert found == pytest.approx(apply_curve_numpy(linear, 0.7, 1.3), rel=1e-4)
