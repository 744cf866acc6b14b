"""Everything a released expansion model computes, as one network and so as one file."""

import torch
from torch import Tensor, nn

from panokit.networks.component_net import ComponentEnsemble
from panokit.networks.gain_net import GainEnsemble

# The U-net halves the grid four times: under a roll by 16 cells its answer only rolls. The mean
# over rolls in between follows rolls by 4 cells exactly and those by one nearly.
ROLLS = (0, 4, 8, 12)


class ExpansionNet(nn.Module):
    """The gain networks over several rolls of the grid, and the component networks.

    Inputs: grid (1, 16, 64, 128), `panokit.expand.features.CHANNELS`, and features
    (1, K, F), `panokit.expand.component_features`, K >= 1.
    Outputs: log gain of burnt-out light per channel (3, 64, 128), the two slopes of the
    response curve (2), log gain of each component (K), logit of its being the sun (K), and
    how much the grid counts in the log of a component's energy, a constant.
    """

    weight_of_grid: Tensor

    def __init__(
        self, gain: GainEnsemble, components: ComponentEnsemble, grid_weight: float = 0.5
    ) -> None:
        super().__init__()
        self.gain = gain
        self.components = components
        self.register_buffer("weight_of_grid", torch.tensor(float(grid_weight)))

    def forward(
        self, grid: Tensor, features: Tensor
    ) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor]:
        """See the class."""
        log_gain, slopes = self.gain(torch.cat([_roll(grid, cells) for cells in ROLLS]))
        back = [_roll(log_gain[i], -cells) for i, cells in enumerate(ROLLS)]
        component_gain, sun = self.components(features)
        return (
            torch.stack(back).mean(dim=0),
            slopes.log().mean(dim=0).exp(),
            component_gain[0],
            sun[0],
            # A constant that depends on nothing would not be exported.
            self.weight_of_grid + 0 * component_gain.sum(),
        )


def _roll(x: Tensor, cells: int) -> Tensor:
    """Along the last axis, by slices, which every ONNX runtime has."""
    cut = x.shape[-1] - cells % x.shape[-1]
    return torch.cat([x[..., cut:], x[..., :cut]], dim=-1)
