"""The torch twins: reflectance maps and HDR coding, equal to the numpy ones."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from panokit.color.hdr_coding import ColorCode, HdrCoding  # noqa: E402
from panokit.networks.stereo import sparse  # noqa: E402
from panokit.networks.stereo.coding import decode, encode  # noqa: E402
from panokit.networks.stereo.sparse import sparse_reflectance  # noqa: E402
from panokit.reflectance import sparse_reflectance as reference  # noqa: E402

pytestmark = pytest.mark.train


@pytest.mark.parametrize("is_on_cpu", [True, False])
@pytest.mark.parametrize("gate_deg", [2.0, 5.0, 15.0])
def test_maps_and_hits_are_those_of_the_reference(gate_deg, is_on_cpu, monkeypatch):
    if not is_on_cpu:  # what graphics processors do, without one
        monkeypatch.setattr(sparse, "_by_reference", sparse._by_shifts)
    rng = np.random.default_rng(4)
    normals = rng.normal(0, 1, (3, 40, 40, 3))
    normals[1, :20] = normals[1, 0, 0]  # a flat face: many equal normals
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = normals.astype(np.float32)
    pictures = rng.uniform(0, 4, (3, 40, 40, 3)).astype(np.float32)
    pictures[:, ::4] = pictures[:, :1]
    masks = rng.random((3, 40, 40)) < 0.6
    masks[2] = False
    color, hits = sparse_reflectance(
        torch.from_numpy(pictures).permute(0, 3, 1, 2),
        torch.from_numpy(normals).permute(0, 3, 1, 2),
        torch.from_numpy(masks),
        width_px=32,
        gate_deg=gate_deg,
    )
    for n in range(3):
        one = reference(pictures[n], normals[n], masks[n], width_px=32, gate_deg=gate_deg)
        np.testing.assert_array_equal(hits[n].numpy(), one.hits)
        np.testing.assert_array_equal(color[n].permute(1, 2, 0).numpy(), one.color)


def test_gradients_reach_the_pixels_that_were_chosen():
    normals = torch.zeros(1, 3, 4, 4)
    normals[:, 2] = 1
    pictures = torch.rand(1, 3, 4, 4, requires_grad=True)
    color, _ = sparse_reflectance(pictures, normals, torch.ones(1, 4, 4, dtype=torch.bool))
    color.sum().backward()
    assert (pictures.grad.sum(dim=1) > 0).sum() == 1


@pytest.mark.parametrize("color", list(ColorCode))
def test_codes_are_decoded_alike(color):
    coding = HdrCoding(brightest=500.0, color=color)
    radiance = np.random.default_rng(0).lognormal(0, 2, (2, 8, 8, 3))
    code = coding.encode(radiance)
    found = decode(torch.from_numpy(code).permute(0, 3, 1, 2).double(), coding)
    np.testing.assert_allclose(
        found.permute(0, 2, 3, 1).numpy(), coding.decode(code), rtol=1e-5, atol=1e-5
    )


@pytest.mark.parametrize("color", list(ColorCode))
def test_radiance_is_coded_alike(color):
    coding = HdrCoding(brightest=500.0, color=color)
    radiance = np.random.default_rng(0).lognormal(0, 2, (2, 8, 8, 3))
    radiance[0, 0] = 0
    found = encode(torch.from_numpy(radiance).permute(0, 3, 1, 2), coding)
    np.testing.assert_allclose(
        found.permute(0, 2, 3, 1).numpy(), coding.encode(radiance), rtol=1e-5, atol=1e-5
    )


@pytest.mark.parametrize("color", list(ColorCode))
def test_darkness_has_a_code_with_a_finite_gradient(color):
    radiance = torch.zeros(1, 3, 2, 2, requires_grad=True)
    encode(radiance, HdrCoding(color=color)).sum().backward()
    assert torch.isfinite(radiance.grad).all()
