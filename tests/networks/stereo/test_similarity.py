"""How alike two views are: the right sign, and what one kind says of another."""

import pytest

torch = pytest.importorskip("torch")

from panokit.networks.stereo.similarity import similarity, similarity_channels  # noqa: E402

pytestmark = pytest.mark.train
FEATURES = torch.randn(2, 16, 8, 8, generator=torch.Generator().manual_seed(0))


@pytest.mark.parametrize("kind", ["pointwise", "epipolar", "row", "full"])
def test_the_channels_are_as_announced(kind):
    found = similarity(FEATURES, FEATURES, kind, 2)
    assert found.shape == (2, similarity_channels(kind, 2, 8), 8, 8)
    assert found.abs().max() <= 1 + 1e-5


def test_equal_views_are_alike_in_the_same_place():
    torch.testing.assert_close(
        similarity(FEATURES, FEATURES, "pointwise", 0), torch.ones(2, 1, 8, 8)
    )
    assert (similarity(FEATURES, FEATURES, "epipolar", 3).argmax(dim=1) == 3).all()


@pytest.mark.parametrize("disparity", [0, 1, 2])
def test_a_point_further_right_in_the_left_view_is_found_at_its_disparity(disparity):
    left = torch.roll(FEATURES, disparity, dims=-1)
    found = similarity(left, FEATURES, "epipolar", 3)
    assert (found[..., 3:].argmax(dim=1) == 3 + disparity).all()


def test_epipolar_is_a_band_of_the_row_and_the_row_a_part_of_all():
    right = torch.roll(FEATURES, 3, dims=1)
    near = similarity(FEATURES, right, "epipolar", 2)
    row = similarity(FEATURES, right, "row", 0)
    full = similarity(FEATURES, right, "full", 0)
    for x in range(2, 6):
        for shift in (-2, 0, 2):
            torch.testing.assert_close(near[:, 2 + shift, :, x], row[:, x - shift, :, x])
    for y in range(8):
        torch.testing.assert_close(row[:, :, y], full[:, y * 8 : y * 8 + 8, y])
