"""How alike two views are: cosines between their features.

In parallel views a point of the object lies in the same row of both, further right in the left
one by its disparity. "epipolar" therefore compares each place of the left view with those within
reach along the row of the right view; "row" with the whole row; "full" with every place; and
"pointwise" with the same place only, as the 2018 thesis did. Memory grows accordingly.
"""

import torch
from torch import Tensor
from torch.nn import functional as F

_EPSILON = 1e-6


def similarity_channels(kind: str, reach: int, size: int) -> int:
    """How many channels `similarity` gives for features of `size` x `size`."""
    return {"pointwise": 1, "epipolar": 2 * reach + 1, "row": size, "full": size * size}[kind]


def similarity(left: Tensor, right: Tensor, kind: str, reach: int) -> Tensor:
    """Cosines between the features of two views.

    Args:
        left: (B, C, H, W).
        right: (B, C, H, W).
        kind: "pointwise", "epipolar", "row" or "full".
        reach: Of "epipolar", in features.

    Returns:
        (B, D, H, W) in [-1, 1]. Channel d of "epipolar" is the cosine of the left feature at
        column x with the right one at x - (d - reach); of "row" with the right one at column d;
        of "full" with the right one at place d, row by row. Beyond the edge it is 0.
    """
    left, right = unit(left), unit(right)
    if kind == "pointwise":
        return (left * right).sum(dim=1, keepdim=True)
    if kind == "epipolar":
        width = left.shape[-1]
        padded = F.pad(right, (reach, reach))
        # At shift s the right view is read s columns further left.
        shifted = [
            (left * padded[..., reach - s : reach - s + width]).sum(dim=1)
            for s in range(-reach, reach + 1)
        ]
        return torch.stack(shifted, dim=1)
    if kind == "row":
        return torch.einsum("bchx,bchy->byhx", left, right)
    places = right.flatten(2)
    return torch.einsum("bchx,bcp->bphx", left, places)


def unit(x: Tensor) -> Tensor:
    """Features (B, C, H, W) of length 1 at each place (L2 normalization over channels)."""
    return x / (x.square().sum(dim=1, keepdim=True) + _EPSILON**2).sqrt()
