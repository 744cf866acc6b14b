"""Small worlds for tests, and the rule about skips."""

import os
from pathlib import Path

import numpy as np
import pytest

from panokit.capture import Capture, license_from_spdx
from panokit.envmap import EnvironmentMap
from panokit.frames import Frame, direction_from_azimuth_elevation
from panokit.panorama import Panorama
from panokit.sphere import equirect_directions

# A test that needs the shared data may be skipped where there is none, and one that needs the
# file rights of an ordinary user where root runs it, and one that asks a program or a library of
# the system that pip does not install; nothing else may be.
_MAY_SKIP = {"unprivileged", "tool"}


def pytest_sessionfinish(session):
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or not os.environ.get("PANOKIT_STRICT_SKIPS"):
        return
    allowed = _MAY_SKIP if os.environ.get("PANOKIT_DATA") else _MAY_SKIP | {"data"}
    wrong = [
        report.nodeid
        for report in reporter.stats.get("skipped", [])
        if not allowed & set(report.keywords)
    ]
    if wrong:
        reporter.write_line("These tests must not be skipped here:", red=True)
        for nodeid in wrong:
            reporter.write_line(f"  {nodeid}")
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_runtest_setup(item):
    if "data" in item.keywords and not os.environ.get("PANOKIT_DATA"):
        pytest.skip("PANOKIT_DATA is not set")
    if "unprivileged" in item.keywords and os.geteuid() == 0:
        pytest.skip("root may write everything")


@pytest.fixture
def shared_data() -> Path:
    """The folder of real probes, panoramas and meshes."""
    return Path(os.environ["PANOKIT_DATA"])


@pytest.fixture
def capture() -> Capture:
    return Capture(
        provider="panoramax",
        id="a1b2",
        license=license_from_spdx("CC-BY-SA-4.0", "Somebody"),
        latitude_deg=48.5,
        longitude_deg=7.7,
        heading_deg=30.0,
    )


def sun_radiance(width_px, elevation_deg, azimuth_deg=17.0, sun=6e4, diameter_deg=0.533):
    """A smooth sky with a sun of true size, (H, W, 3) float32."""
    directions = equirect_directions(width_px, width_px // 2)
    toward = direction_from_azimuth_elevation(np.deg2rad(azimuth_deg), np.deg2rad(elevation_deg))
    radiance = (0.4 + 0.2 * directions[..., 1:2]) * np.array([0.8, 1.0, 1.3])
    radiance[directions @ toward > np.cos(np.deg2rad(diameter_deg / 2))] = sun
    return radiance.astype(np.float32)


@pytest.fixture
def sunny() -> EnvironmentMap:
    return EnvironmentMap(radiance=sun_radiance(256, 40, diameter_deg=4), frame=Frame.WORLD)


@pytest.fixture
def street(capture) -> Panorama:
    """A panorama with a gradient, a horizon and fine texture."""
    rng = np.random.default_rng(1)
    directions = equirect_directions(256, 128)
    pixels = 128 + 90 * directions[..., [1, 0, 2]] + rng.normal(0, 6, (128, 256, 1))
    return Panorama(
        pixels=np.clip(pixels, 0, 255).astype(np.uint8), capture=capture, frame=Frame.WORLD
    )
