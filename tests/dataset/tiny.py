"""A few stereo samples, made by the tiny renderer in seconds; no shards are written."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.capture import Capture, license_from_spdx
from panokit.dataset.make import make_sample
from panokit.dataset.plan import draw_plan
from panokit.dataset.renderers import make_renderer
from panokit.dataset.settings import DatasetSettings, ObjectSettings, RigSettings
from panokit.dataset.stock import open_stock
from panokit.dataset.storage.decode import decode_member
from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.frames import direction_from_azimuth_elevation
from panokit.io import write_environment_map
from panokit.sphere import equirect_directions


def sunny(azimuth_deg: float, elevation_deg: float = 35.0) -> NDArray[np.float32]:
    """A soft sky with a sun, over a darker ground: (32, 64, 3)."""
    directions = equirect_directions(64, 32)
    sun = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))
    near = np.exp(60 * (directions @ sun - 1))[..., None]
    sky = np.where(directions[..., 1:2] > 0, [0.4, 0.5, 0.7], [0.2, 0.18, 0.15])
    return np.asarray(sky + 20 * near, np.float32)


def tiny_members(
    folder: Path, count: int, *, places: int, width_px: int, kinds: Sequence[str] = ("vase",)
) -> list[dict[str, Any]]:
    """Decoded members of samples, each with its key; the sun of each place stands elsewhere.

    Args:
        folder: For the light maps.
        count: Of samples.
        places: Of light, called "place 0" and so on.
        width_px: Of the pictures.
        kinds: Of objects.
    """
    for number in range(places):
        capture = Capture(
            provider="test", id=f"m{number}", place=f"place {number}",
            license=license_from_spdx("CC0-1.0", "Somebody"),
        )  # fmt: skip
        light = EnvironmentMap(radiance=sunny(360.0 / places * number), capture=capture)
        write_environment_map(light, folder / f"m{number}.exr")
    settings = DatasetSettings(
        renderer="analytic", samples=4, validation_share=0, test_share=0,
        objects=ObjectSettings(kinds=tuple(kinds), per_kind=4), rig=RigSettings(width_px=width_px),
    )  # fmt: skip
    stock = open_stock(settings, [folder])
    renderer = make_renderer("analytic")
    found: list[dict[str, Any]] = []
    for index in range(5 * count):
        try:
            made = make_sample(draw_plan(settings, stock, index), settings, stock, renderer)
        except ImageError:
            continue
        files = {name.rpartition(".")[0]: decode_member(name, data)
                 for name, data in made.members.items()}  # fmt: skip
        found.append(files | {"key": made.key})
        if len(found) == count:
            return found
    raise AssertionError("too few usable samples")
