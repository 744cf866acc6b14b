"""What the camera sees behind the object, put where it belongs in the map.

The rig's angle of view is a constant of the dataset, so which pixel of the background shows which
direction is one, too: that part of the map need not be learned.
"""

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional as F

from panokit.color.hdr_coding import HdrCoding
from panokit.networks.stereo.coding import encode, srgb_decode
from panokit.sphere import equirect_directions
from panokit.sphere.perspective import perspective_pixel

# The background is averaged down to this width before it is read: of 40 degrees a sixteenth is
# 2.5, about the height of a pixel of the 64x64 map, so that none is read between two pixels.
_READ_PX = 16


class BackgroundWindow(nn.Module):
    """The background as code values at its directions of the map.

    Args:
        fov_deg: Horizontal and vertical angle of view of the square picture.
        output_px: Width and height of the map, an anamorphic equirectangular picture in the
            camera's frame.
        coding: Of the map.
    """

    grid: Tensor
    inside: Tensor

    def __init__(self, fov_deg: float, output_px: int, coding: HdrCoding) -> None:
        super().__init__()
        grid, inside = _grid(fov_deg, output_px)
        self.register_buffer("grid", grid, persistent=False)
        self.register_buffer("inside", inside, persistent=False)
        self.coding = coding

    def forward(self, background: Tensor) -> Tensor:
        """(B, 3, S, S) display-encoded in [-1, 1] to (B, 4, output, output).

        Three channels of code values, zero where nothing is known, and one that says where it is.
        """
        linear = srgb_decode(((background.float() + 1) / 2).clamp(0, 1))
        size = linear.shape[-1]
        small = F.avg_pool2d(linear, size // _READ_PX) if size > _READ_PX else linear
        grid = self.grid.expand(small.shape[0], -1, -1, -1)
        seen = F.grid_sample(small, grid, padding_mode="border", align_corners=False)
        inside = self.inside.expand(small.shape[0], -1, -1, -1)
        return torch.cat([encode(seen, self.coding) * inside, inside], dim=1)


def _grid(fov_deg: float, size: int) -> tuple[Tensor, Tensor]:
    """Where to read, (1, size, size, 2) from -1 to 1, and whether that is in the picture."""
    directions = equirect_directions(size, size)
    column, row, inside = perspective_pixel(directions, _READ_PX, _READ_PX, fov_deg)
    places = (np.stack([column, row], axis=-1) + 0.5) / _READ_PX * 2 - 1
    grid = np.where(inside[..., None], places, 0).astype(np.float32)
    return torch.from_numpy(grid)[None], torch.from_numpy(inside.astype(np.float32))[None, None]
