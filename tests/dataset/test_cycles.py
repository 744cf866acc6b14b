"""Cycles beside Mitsuba, and what happens where Blender is missing or breaks."""

from dataclasses import replace

import numpy as np
import psutil
import pytest
from scipy.ndimage import median_filter

from panokit.dataset.objects.kinds import make_object
from panokit.dataset.renderers import make_renderer
from panokit.dataset.renderers.cycles import blender_command
from panokit.dataset.scene import Mesh, Quality
from panokit.errors import PanokitError, UsageError
from tests.dataset.scenes import GLOSSY, WHITE, ball, masked_mean, scene, sun_light, view

MATTE = replace(WHITE, base_color=(0.6, 0.5, 0.4), specular=0.4, roughness=0.7)


@pytest.fixture(scope="module")
def cycles():
    try:
        renderer = make_renderer("blender")
    except PanokitError as error:
        pytest.skip(str(error))
    yield renderer
    renderer.close()


@pytest.mark.tool
@pytest.mark.render
@pytest.mark.parametrize(
    ("kind", "material", "azimuth_deg"),
    [("vase", MATTE, 110), ("chair", MATTE, -110), ("teapot", GLOSSY, 150)],
)
def test_cycles_and_mitsuba_agree(cycles, kind, material, azimuth_deg):
    mesh = make_object(kind, 5)
    mesh = Mesh(vertices=mesh.vertices, faces=mesh.faces, part=mesh.part * 0, smooth=True)
    what = scene(mesh, sun_light(azimuth_deg, 35), material)
    camera = view(pitch_deg=-15, heading_deg=10, width_px=96)
    quality = Quality(samples=256, bounces=4)
    ours, theirs = (
        renderer.render(what, (camera,), quality, 1)[0]
        for renderer in (make_renderer("mitsuba"), cycles)
    )
    means = [masked_mean(one.radiance, one.coverage) for one in (ours, theirs)]
    assert means[1] == pytest.approx(means[0], rel=0.03)
    # The sun is on the same side: the pictures are alike, not only their means.
    inner = (ours.coverage > 0.999) & (theirs.coverage > 0.999)
    smooth = [np.log(median_filter(one.radiance.mean(axis=2), 3) + 1e-3) for one in (ours, theirs)]
    assert np.corrcoef(smooth[0][inner], smooth[1][inner])[0, 1] > 0.95
    assert theirs.coverage == pytest.approx(ours.coverage, abs=0.3)
    both = (ours.part > 0) & (theirs.part > 0)
    assert np.abs(ours.normal - theirs.normal)[both].mean() < 0.01
    assert np.abs(ours.depth - theirs.depth)[both].mean() < 0.003


@pytest.mark.tool
def test_blender_goes_when_its_renderer_goes():
    try:
        renderer = make_renderer("blender")
    except PanokitError as error:
        pytest.skip(str(error))
    process = psutil.Process(renderer.process_id)
    renderer.close()
    assert not process.is_running() or process.status() == psutil.STATUS_ZOMBIE
    with pytest.raises(PanokitError, match="closed"):
        renderer.render(scene(ball(), sun_light(0), WHITE), (view(),), Quality(samples=1), 1)


def test_without_blender_the_error_says_how_to_get_it(monkeypatch, tmp_path):
    for name in ("PANOKIT_BLENDER", "PANOKIT_BLENDER_PYTHON"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(PanokitError, match="PANOKIT_BLENDER"):
        make_renderer("blender")


@pytest.mark.parametrize("name", ["PANOKIT_BLENDER", "PANOKIT_BLENDER_PYTHON"])
def test_a_wrong_path_is_named(monkeypatch, name):
    monkeypatch.delenv("PANOKIT_BLENDER", raising=False)
    monkeypatch.delenv("PANOKIT_BLENDER_PYTHON", raising=False)
    monkeypatch.setenv(name, "/nowhere/blender")
    with pytest.raises(PanokitError, match="/nowhere/blender"):
        blender_command()


def test_a_python_with_bpy_is_started_without_blender_s_options(monkeypatch):
    monkeypatch.delenv("PANOKIT_BLENDER", raising=False)
    monkeypatch.setenv("PANOKIT_BLENDER_PYTHON", "/bin/sh")
    command = blender_command()
    assert command[0] == "/bin/sh"
    assert "-b" not in command
    assert command[1].endswith("cycles_script.py")


def fake_blender(path, script):
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return str(path)


def test_a_blender_that_dies_leaves_its_last_words(monkeypatch, tmp_path):
    program = fake_blender(tmp_path / "blender", "echo no license to render; exit 3")
    monkeypatch.setenv("PANOKIT_BLENDER", program)
    with pytest.raises(PanokitError, match="no license to render"):
        make_renderer("blender")


def test_a_blender_that_fails_or_cannot_filter_says_so(monkeypatch, tmp_path):
    answers = """echo '@panokit {"version": "9.9", "denoise": false}'
read job; echo '@panokit {"error": "Trace\\\\nOut of paint"}'; read job; exit 1"""
    monkeypatch.setenv("PANOKIT_BLENDER", fake_blender(tmp_path / "blender", answers))
    renderer = make_renderer("blender")
    what = scene(ball(), sun_light(0), WHITE)
    with pytest.raises(UsageError, match="without a denoiser"):
        renderer.render(what, (view(),), Quality(denoise=True), 1)
    with pytest.raises(PanokitError, match="Out of paint"):
        renderer.render(what, (view(),), Quality(samples=1), 1)
    with pytest.raises(PanokitError, match="stopped"):
        renderer.render(what, (view(),), Quality(samples=1), 1)
    renderer.close()
