"""Small light maps to fill libraries with."""

import numpy as np
import pytest

from panokit.capture import Capture, license_from_spdx
from panokit.envmap import Anchor, EnvironmentMap
from panokit.frames import Frame
from panokit.provenance import Provenance, Step


@pytest.fixture
def make_map():
    """Maps that differ by `seed`, from one place, under an open license unless told otherwise."""

    def make(seed=0, *, place="Bristol", spdx="CC-BY-SA-4.0", width=32):
        radiance = np.random.default_rng(seed).uniform(0.1, 1, (width // 2, width, 3))
        radiance[width // 8, seed % width] = 500
        return EnvironmentMap(
            radiance=radiance.astype(np.float32),
            frame=Frame.WORLD,
            anchor=Anchor.LDR_WHITE,
            capture=Capture(
                provider="panoramax",
                id=f"picture-{seed}",
                license=license_from_spdx(spdx, "© A. Mapper"),
                place=place,
            ),
            provenance=Provenance((Step(stage="expand", version="1", values={"model": "x"}),)),
        )

    return make
