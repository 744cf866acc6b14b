import numpy as np
import pytest

pytestmark = pytest.mark.train
torch = pytest.importorskip("torch")


@pytest.fixture
def network():
    from panokit.networks.expandnet import ExpandNet

    torch.manual_seed(0)
    return ExpandNet().eval()


def count(module) -> int:
    return sum(parameter.numel() for parameter in module.parameters())


def test_it_has_the_published_number_of_weights(network):
    assert count(network) == 456_899
    branches = [network.local, network.dilated, network.whole, network.fusion]
    assert [count(branch) for branch in branches] == [75_648, 112_576, 252_032, 16_643]


def test_any_size_comes_out_as_it_went_in_within_0_and_1(network):
    for height, width in ((64, 128), (51, 77)):
        with torch.inference_mode():
            light = network(torch.rand(2, 3, height, width))
        assert light.shape == (2, 3, height, width)
        assert 0 < float(light.min()) < float(light.max()) < 1


def test_a_pixel_is_seen_from_8_pixels_away_and_the_rest_through_the_code_only(network):
    picture = torch.rand(1, 3, 64, 64)
    changed = picture.clone()
    changed[..., 32, 32] += 1
    with torch.inference_mode():
        code = network.code(picture)
        difference = (network.expand(picture, code) - network.expand(changed, code)).abs()
    rows = difference.amax(dim=(0, 1, 3)).nonzero().flatten()
    assert (int(rows.min()), int(rows.max())) == (24, 40)
    with torch.inference_mode():
        assert not torch.equal(network.code(picture), network.code(changed))


def test_patches_give_what_the_whole_picture_gives(network):
    from panokit.networks.expandnet import predict_by_patches

    picture = torch.rand(1, 3, 200, 500)
    with torch.inference_mode():
        whole, stitched = network(picture), predict_by_patches(network, picture)
    # A margin of 10 covers the 8 pixels that a pixel sees. At the picture's own edge the
    # padding differs: one has zeros after each layer, the other before the first.
    inside = np.s_[..., 10:-10, 10:-10]
    assert torch.allclose(whole[inside], stitched[inside], atol=1e-5)
    assert stitched.shape == picture.shape


def test_the_loss_is_l1_and_five_times_the_angle_of_color():
    from panokit.networks.expandnet import expandnet_loss

    gray = torch.full((1, 3, 4, 4), 0.5)
    assert float(expandnet_loss(gray, gray)) == pytest.approx(0, abs=1e-6)
    assert float(expandnet_loss(gray * 0.5, gray)) == pytest.approx(0.25, abs=1e-5)
    red = torch.zeros_like(gray)
    red[:, 0] = 0.5
    expected = 1 / 3 + 5 * (1 - 1 / np.sqrt(3))
    assert float(expandnet_loss(red, gray)) == pytest.approx(expected, rel=1e-4)
