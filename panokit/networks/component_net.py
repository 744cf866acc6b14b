"""The component network: how much brighter than white each burnt-out component is."""

import torch
from torch import Tensor, nn
from torch.nn import functional as F

# The column of `component_features` that holds each component's share of the burnt-out area.
AREA_SHARE = 1


class ComponentNet(nn.Module):
    """A network over the set of a picture's components.

    Each component sees itself and the mean of all, weighted by area; the order of the rows
    does not matter.

    Input: (B, K, F), `panokit.expand.component_features`; rows of zeros are padding.
    Output: log gain of each component's luminance, (B, K), >= 0, and the logit of its being
    the sun, (B, K).
    """

    mean: Tensor
    deviation: Tensor

    def __init__(self, inputs: int, width: int = 64, dropout: float = 0.0) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(inputs))
        self.register_buffer("deviation", torch.ones(inputs))
        self.own = nn.Linear(inputs, width)
        self.mixed = nn.Linear(2 * width, width)
        self.dropout = nn.Dropout(dropout)
        self.head = nn.Linear(width, 1)
        self.sun = nn.Linear(width, 1)
        nn.init.constant_(self.head.bias, 1.5)

    def standardize_by(self, features: Tensor) -> None:
        """Take the scale of the inputs from example rows (N, F)."""
        self.mean.copy_(features.mean(dim=0))
        self.deviation.copy_(features.std(dim=0).clamp(min=1e-3))

    def forward(self, features: Tensor, noise: float = 0.0) -> tuple[Tensor, Tensor]:
        """See the class; `noise` is added to the standardized inputs in training."""
        share = features[..., AREA_SHARE : AREA_SHARE + 1]
        x = ((features - self.mean) / self.deviation).clamp(-4, 4)
        if noise:
            x = x + noise * torch.randn_like(x)
        own = self.dropout(F.silu(self.own(x)))
        context = (share * own).sum(dim=1, keepdim=True).expand_as(own)
        mixed = self.dropout(F.silu(self.mixed(torch.cat([own, context], dim=-1)))) + own
        return F.softplus(self.head(mixed).squeeze(-1)), self.sun(mixed).squeeze(-1)


class ComponentEnsemble(nn.Module):
    """Several component networks as one: the mean of their log gains and of their logits."""

    def __init__(self, members: list[ComponentNet]) -> None:
        super().__init__()
        self.members = nn.ModuleList(members)

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """As `ComponentNet`."""
        results = [member(features) for member in self.members]
        gain = torch.stack([each for each, _ in results]).mean(dim=0)
        return gain, torch.stack([each for _, each in results]).mean(dim=0)
