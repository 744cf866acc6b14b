"""Where the truth is a lower bound, only too little light is an error."""

import pytest

pytestmark = pytest.mark.train
torch = pytest.importorskip("torch")


def grid_loss(gain: float, ceiling: float) -> dict[str, float]:
    from panokit.train.losses import GridLoss

    share = torch.zeros(1, 1, 64, 128)
    share[..., 10:14, 20:24] = 1
    grid = torch.cat([torch.full((1, 3, 64, 128), 0.5), 0.2 * (1 - share).expand(1, 3, -1, -1),
                      share.expand(1, 3, -1, -1), share, share, share,
                      torch.zeros(1, 4, 64, 128)], dim=1)  # fmt: skip
    clear = (0.2 * (1 - share) + 1e-6).log().expand(1, 3, -1, -1)
    burnt = (10 * share + 1e-6).log().expand(1, 3, -1, -1)
    log_gain = torch.full((1, 3, 64, 128), gain).log()
    terms = GridLoss()(grid, log_gain, torch.ones(1, 2), clear, burnt, ceiling * share[:, 0])
    return {name: float(term) for name, term in terms.items()}


def test_more_light_than_a_clipped_map_shows_costs_the_grid_nothing():
    known, bound = grid_loss(30.0, 0.0), grid_loss(30.0, 1.0)
    assert known["burnt"] > 1 and known["light"] > 0.3 and known["color"] > 0.05
    assert [bound[name] for name in ("burnt", "light", "color")] == pytest.approx([0] * 3, abs=1e-3)
    assert bound["clear"] == known["clear"]


def test_less_light_than_a_clipped_map_shows_costs_as_ever():
    known, bound = grid_loss(3.0, 0.0), grid_loss(3.0, 1.0)
    assert known["burnt"] > 1
    assert bound["burnt"] == pytest.approx(known["burnt"])
    # All but the light vector, which a clipped map does not tell.
    assert 0.1 < bound["light"] < known["light"]


@pytest.mark.parametrize("relative", [0.0, 1.0])
def test_a_component_s_energy_may_be_a_lower_bound(relative: float):
    from panokit.train.losses import component_loss

    def loss(gain: float, lower: float) -> dict[str, float]:
        spread = torch.ones(1, 2, 64) * 0.25
        vector = torch.tensor([[[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]])
        rest = torch.cat([torch.full((1, 64), 0.1), torch.zeros(1, 3), torch.ones(1, 1)], dim=1)
        terms = component_loss(
            torch.tensor([[gain, 1.0]]).log(), torch.ones(1, 2), torch.tensor([[10.0, 1.0]]),
            spread, vector, rest, torch.tensor([[lower, 0.0]]), relative,
        )  # fmt: skip
        return {name: float(term) for name, term in terms.items()}

    assert sum(loss(10.0, 0.0).values()) == pytest.approx(0, abs=2e-3)
    assert sum(loss(40.0, 1.0).values()) == pytest.approx(0, abs=1e-6)
    assert loss(40.0, 0.0)["own"] > 0.5 and loss(40.0, 0.0)["light"] > 0.5
    assert loss(2.0, 1.0)["own"] > 0.5
    assert loss(2.0, 1.0)["own"] == pytest.approx(loss(2.0, 0.0)["own"])
    assert loss(2.0, 1.0)["light"] > 0.3
