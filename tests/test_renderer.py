import subprocess

import numpy as np
import pytest

from panokit import renderer
from panokit.errors import MissingExtraError, PanokitError
from panokit.renderer import (
    describe_renderer,
    environment_emitter,
    environment_parameter,
    load_mitsuba,
    working_variant,
)


@pytest.fixture
def forget():
    """Every test decides anew which variant works, and leaves no decision behind."""
    working_variant.cache_clear()
    yield
    working_variant.cache_clear()


def outcomes(monkeypatch, returncodes):
    def run(command, **_):
        return subprocess.CompletedProcess(command, returncodes[command[-1]], "", "LLVM ERROR: no")

    monkeypatch.setattr(renderer.subprocess, "run", run)


@pytest.mark.usefixtures("forget")
def test_a_variant_that_kills_its_process_is_not_used(monkeypatch):
    # What libLLVM 15 does: SIGABRT, which no exception handler sees.
    outcomes(monkeypatch, {"llvm_ad_rgb": -6, "scalar_rgb": 0})
    assert working_variant() == "scalar_rgb"


@pytest.mark.usefixtures("forget")
def test_no_working_variant_says_what_each_did(monkeypatch):
    outcomes(monkeypatch, {"llvm_ad_rgb": -6, "scalar_rgb": 1})
    with pytest.raises(PanokitError, match=r"llvm_ad_rgb: exit -6, LLVM ERROR.*scalar_rgb"):
        working_variant()
    assert "does not work here" in describe_renderer()


@pytest.mark.usefixtures("forget")
def test_missing_mitsuba_names_the_extra(monkeypatch):
    monkeypatch.setattr(renderer, "find_spec", lambda name: None)
    for call in (working_variant, load_mitsuba):
        with pytest.raises(MissingExtraError, match=r"panokit\[render\]"):
            call()


def test_parameter_is_padded_and_reaches_both_poles():
    rows = np.linspace(0, 1, 8, dtype=np.float32)[:, None, None] * np.ones((8, 16, 3), np.float32)
    rows[:, 0] = 5
    padded = environment_parameter(rows)
    assert padded.shape == (8, 18, 3)
    np.testing.assert_allclose(padded[:, 1], 5, rtol=1e-6)
    assert (padded[:, -1] == padded[:, 1]).all()
    assert (padded[:, 0] == padded[:, -2]).all()
    # A ramp over row centers stays one over rows from pole to pole, but for the ends.
    assert padded[4, 5, 0] == pytest.approx((4 / 7 * 8 - 0.5) / 7, abs=0.005)


@pytest.mark.render
def test_environment_looks_the_same_from_inside():
    mitsuba = load_mitsuba()
    radiance = np.full((32, 64, 3), 0.1, np.float32)
    # A beacon to the east, 28 degrees up: column 3/4, row (90 - 28) / 180.
    radiance[10:12, 47:49] = 9.0
    emitter = mitsuba.load_dict(environment_emitter(radiance))
    interaction = mitsuba.SurfaceInteraction3f()

    def seen(*direction):
        interaction.wi = mitsuba.Vector3f(
            *(-np.array(direction) / np.linalg.norm(direction)).tolist()
        )
        return float(np.array(emitter.eval(interaction)).ravel()[0])

    up = np.tan(np.deg2rad(28))
    assert seen(1, up, 0) > 4
    assert seen(-1, up, 0) == pytest.approx(0.1, abs=0.01)
    assert seen(0, up, -1) == pytest.approx(0.1, abs=0.01)
    assert seen(1, -up, 0) == pytest.approx(0.1, abs=0.01)


@pytest.mark.render
@pytest.mark.usefixtures("forget")
def test_description_names_the_variant():
    assert working_variant() in describe_renderer()
