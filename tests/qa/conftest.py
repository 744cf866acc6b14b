"""A light map with a sky, a ground, texture and a sun: smooth on the sphere, so undamaged.

Grain near the horizon makes it as sharp as a picture; at the poles it would be a pinwheel.
"""

import numpy as np
import pytest

from panokit.capture import Capture, license_from_spdx
from panokit.envmap import Anchor, EnvironmentMap
from panokit.frames import Frame, direction_from_azimuth_elevation
from panokit.provenance import Provenance, Step
from panokit.sphere import energy, equirect_directions


@pytest.fixture
def make_map():
    """Maps by width, sun azimuth and sun radiance; expanded from a synthetic capture."""

    def make(width=256, *, sun=3e4, azimuth_deg=40.0, key="place-1", synthetic=False):
        directions = equirect_directions(width, width // 2)
        x, y, z = np.moveaxis(directions, -1, 0)
        sky = np.clip(y * 8 + 0.5, 0, 1)[..., None]
        texture = 0.03 * (np.sin(9 * x + 4 * z) + np.sin(13 * z - 5 * y) + np.sin(21 * x * z))
        toward = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(35))
        glow = np.exp((directions @ toward - 1) * 4000)[..., None]
        grain = np.random.default_rng(1).normal(1, 0.02, (width // 2, width, 1))
        grain[np.abs(y) > 0.8] = 1
        radiance = grain * (
            sky * np.array([0.35, 0.5, 0.8])
            + (1 - sky) * np.array([0.2, 0.17, 0.13]) * (1 + texture[..., None])
            + glow * sun
        )
        radiance = radiance.astype(np.float32)
        capture = Capture(
            provider="panoramax",
            id=key,
            license=license_from_spdx("CC-BY-SA-4.0", "© A. Mapper"),
            place="Sample City",
            details={"synthetic": True} if synthetic else {},
        )
        step = Step(stage="expand", version="1", values={"energy_after": energy(radiance).tolist()})
        return EnvironmentMap(
            radiance=radiance,
            frame=Frame.WORLD,
            anchor=Anchor.LDR_WHITE,
            capture=capture,
            provenance=Provenance((step,)),
        )

    return make
