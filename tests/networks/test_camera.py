import numpy as np
import pytest

from panokit.color import camera as numpy_camera
from panokit.color import development as numpy_development
from panokit.color.development import Development
from panokit.color.response import SRGB, TONED_BANK, Response
from panokit.errors import UsageError

pytestmark = pytest.mark.train
torch = pytest.importorskip("torch")


def scene(seed: int, height: int = 48) -> np.ndarray:
    random = np.random.default_rng(seed)
    radiance = random.lognormal(-1.5, 1, (height, 2 * height, 3)).astype(np.float32)
    radiance[:, : height // 2] *= 0.05
    radiance[5:8, 9:14] = 300
    return radiance


def as_torch(radiance: np.ndarray):
    return torch.from_numpy(np.ascontiguousarray(radiance.transpose(2, 0, 1)))[None]


EVERYTHING = [
    Development(exposure=1.3),
    Development(exposure=0.7, white_balance=(1.1, 0.9)),
    Development(exposure=1.3, shot_noise=0.03, read_noise=0.01, noise_seed=3),
    Development(exposure=1.3, local=0.4),
    Development(exposure=1.3, response=Response(family="gamma", numbers=(2.4,))),
    Development(exposure=1.3, response=Response(family="sigmoid", numbers=(0.9, 0.6))),
    Development(exposure=1.3, response=TONED_BANK[3]),
    Development(
        exposure=2.0,
        white_balance=(0.95, 1.05),
        shot_noise=0.02,
        read_noise=0.003,
        noise_seed=8,
        local=0.2,
        response=TONED_BANK[1],
    ),
]


@pytest.mark.parametrize("development", EVERYTHING, ids=range(len(EVERYTHING)))
def test_both_cameras_take_the_same_picture(development):
    from panokit.networks.camera import develop

    radiance = scene(1)
    expected = numpy_development.develop(radiance, development)
    found = develop(as_torch(radiance), [development])[0].numpy().transpose(1, 2, 0) * 255
    difference = np.abs(found - expected)
    # A value that lies on the edge between two codes may fall to either side.
    assert difference.max() <= 1.001
    assert (difference > 0.01).mean() < 2e-3


def test_a_batch_has_a_development_for_each_map():
    from panokit.networks.camera import develop

    batch = torch.cat([as_torch(scene(1)), as_torch(scene(2))])
    found = develop(batch, EVERYTHING[:2])
    for i in range(2):
        expected = numpy_development.develop(scene(i + 1), EVERYTHING[i])
        assert found[i].numpy().transpose(1, 2, 0) * 255 == pytest.approx(expected, abs=1.001)
    with pytest.raises(UsageError, match="as many"):
        develop(batch, EVERYTHING[:1])


def test_both_measure_the_same_exposure():
    from panokit.networks.camera import exposed_percentile

    for seed in range(4):
        found = float(exposed_percentile(as_torch(scene(seed)))[0])
        assert found == pytest.approx(numpy_camera.exposed_percentile(scene(seed)), rel=1e-5)


def test_gradients_pass_the_rounding_and_stop_at_clipping():
    from panokit.networks.camera import develop

    radiance = torch.full((1, 3, 8, 16), 0.3)
    radiance[..., 0, 0] = 5.0
    radiance.requires_grad_(True)
    everything = Development(
        exposure=1, shot_noise=0.01, read_noise=0.001, local=0.1, response=SRGB
    )
    develop(radiance, [everything]).sum().backward()
    assert torch.isfinite(radiance.grad).all()
    assert float(radiance.grad[..., 4, 4].min()) > 0.3
    plain = torch.full((1, 3, 8, 16), 5.0, requires_grad=True)
    develop(plain, [Development(exposure=1)]).sum().backward()
    assert float(plain.grad.abs().max()) == 0
    black = torch.zeros((1, 3, 8, 16), requires_grad=True)
    for development in EVERYTHING:
        develop(black, [development]).sum().backward()
    assert torch.isfinite(black.grad).all()
