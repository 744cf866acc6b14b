"""The stereo networks: every choice runs, and does what it says."""

import pytest
from pydantic import ValidationError

torch = pytest.importorskip("torch")

from panokit.color.hdr_coding import HdrCoding  # noqa: E402
from panokit.networks.stereo.coding import decode  # noqa: E402
from panokit.networks.stereo.net import StereoNet, _interpolated  # noqa: E402
from panokit.networks.stereo.reflectance import Dematerial, PictureToMap  # noqa: E402
from panokit.networks.stereo.settings import StereoNetSettings  # noqa: E402

pytestmark = pytest.mark.train
SMALL = {"width": 4, "input_px": 32, "output_px": 16}


def views(size=32, seed=0):
    generator = torch.Generator().manual_seed(seed)
    return [torch.randn(2, 3, size, size, generator=generator) for _ in range(3)]


@pytest.mark.parametrize("size, narrowest", [(16, 2), (64, 4), (128, 4), (256, 4)])
def test_views_of_any_size_end_in_64_pixels(size, narrowest):
    net = StereoNet(StereoNetSettings(width=4, input_px=size))
    assert net.size == narrowest
    assert net(*views(size)).shape == (2, 3, 64, 64)


@pytest.mark.parametrize("kind", ["pointwise", "epipolar", "row", "full"])
def test_every_comparison_runs(kind):
    net = StereoNet(StereoNetSettings(similarity=kind, **SMALL))
    assert net(*views()).shape == (2, 3, 16, 16)


def test_copy_left_learns_nothing_from_the_right_view():
    torch.manual_seed(0)
    net = StereoNet(StereoNetSettings(weights="copy-left", fusion="concat", **SMALL))
    left, right, behind = views()
    right.requires_grad_(True)
    net(left, right, behind).sum().backward()
    assert right.grad is None or not right.grad.any()
    shared = StereoNet(StereoNetSettings(weights="shared", fusion="concat", **SMALL))
    shared(left, right, behind).sum().backward()
    assert right.grad.any()


def test_unshared_encoders_have_weights_of_their_own():
    count = {}
    for weights in ("shared", "unshared", "copy-left"):
        net = StereoNet(StereoNetSettings(weights=weights, **SMALL))
        count[weights] = sum(one.numel() for one in net.parameters())
    assert count["unshared"] > count["shared"] == count["copy-left"]


def test_the_background_counts_only_where_there_is_a_branch():
    left, right, behind = views()
    for background, counts in (("branch", True), ("composited", False)):
        net = StereoNet(StereoNetSettings(background=background, **SMALL)).eval()
        same = torch.equal(net(left, right, behind), net(left, right, behind + 1))
        assert same is not counts


def test_a_wrapped_decoder_gives_a_turned_map_for_turned_features():
    net = StereoNet(StereoNetSettings(wrap=True, layers=2, **SMALL)).eval()
    x = torch.randn(1, net.last.convolution.in_channels, 16, 16)
    torch.testing.assert_close(net.last(torch.roll(x, 5, dims=-1)),
                               torch.roll(net.last(x), 5, dims=-1))  # fmt: skip


def test_contradictory_choices_are_refused():
    with pytest.raises(ValidationError, match="pyramid"):
        StereoNetSettings(pyramid=True, fusion="concat")
    with pytest.raises(ValidationError, match="multiple of coarser"):
        StereoNetSettings(coarser=16)


@pytest.mark.parametrize("size", [30, 96])
def test_sizes_that_do_not_arrive_at_the_map_are_refused(size):
    with pytest.raises(ValidationError, match=f"input_px is a power of two.* not {size}"):
        StereoNetSettings(input_px=size)


def test_the_networks_on_reflectance_maps_run():
    for channels, size in ((4, 64), (3, 128)):
        net = PictureToMap(channels, input_px=size, width=4)
        assert net(torch.zeros(2, channels, size, size)).shape == (2, 3, 64, 64)
    net = Dematerial(materials=3, background_px=32, width=4, layers=1)
    maps = torch.zeros(2, 12, 64, 64)
    assert net(maps, torch.zeros(2, 3, 32, 32)).shape == (2, 3, 64, 64)


def test_a_coarser_map_is_interpolated_across_its_seam():
    x = torch.rand(1, 3, 8, 8)
    turned = _interpolated(torch.roll(x, 3, dims=-1), 2)
    torch.testing.assert_close(turned, torch.roll(_interpolated(x, 2), 6, dims=-1))
    torch.testing.assert_close(_interpolated(torch.ones_like(x), 4), torch.ones(1, 3, 32, 32))
    assert _interpolated(x, 1) is x


@pytest.mark.parametrize("size", [16, 32])
def test_a_coarser_decoder_gives_the_whole_map(size):
    net = StereoNet(StereoNetSettings(coarser=2, wrap=True, width=4, input_px=32, output_px=size))
    assert net(*views()).shape == (2, 3, size, size)
    # Nothing alternates from pixel to pixel.
    found = net.eval()(*views())
    steps = (found[..., 1:] - found[..., :-1]).abs()
    second = (found[..., 2:] - 2 * found[..., 1:-1] + found[..., :-2]).abs()
    assert second.mean() < 2 * steps.mean()


def test_lights_leave_nothing_brighter_to_the_decoder():
    coding = HdrCoding(brightest=1000.0)
    net = StereoNet(StereoNetSettings(lights=1, painted=2.0, **SMALL), coding).eval()
    torch.nn.init.constant_(net.last.bias, 3.0)  # as bright as can be
    torch.nn.init.constant_(net.lobes.head[-1].bias, -30.0)  # hardly any lobe
    radiance = decode(net(*views()), coding)
    assert 1.9 < radiance.max() < 2.2
