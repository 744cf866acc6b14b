"""Mitsuba: nothing compiled twice, flat memory, one CPU, no LLVM, the noise filter."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest

from panokit.dataset.materials import draw_material
from panokit.dataset.objects.kinds import KINDS, make_object
from panokit.dataset.renderers import make_renderer
from panokit.dataset.renderers.mitsuba_paths import touched_pixels
from panokit.dataset.renderers.raster import look
from panokit.dataset.scene import Mesh, Quality, Scene
from panokit.dataset.settings import ObjectSettings
from panokit.errors import UsageError
from tests.dataset.scenes import GLOSSY, WHITE, ball, boxes, scene, sun_light, uniform_light, view

pytestmark = pytest.mark.render
FEW = Quality(samples=4)
ROOT = Path(__file__).parent.parent.parent
ONE_BALL = """
import os, sys
if sys.argv[2] == "one-cpu":
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
import mitsuba
if sys.argv[2] == "scalar":
    mitsuba.set_variant("scalar_rgb")
from pathlib import Path
from panokit.dataset.renderers import make_renderer
from panokit.dataset.scene import Quality
from panokit.io import read_environment_map
from tests.dataset.scenes import GLOSSY, ball, scene, view
light = read_environment_map(Path(sys.argv[1]))
renderer = make_renderer("mitsuba")
what = scene(ball(), light, GLOSSY, floor_m=-0.5)
camera = view(width_px=24)
seen = renderer.render(what, (camera,), Quality(samples=256), 1)[0]
dense = renderer.reflectance(GLOSSY, light, Quality(samples=64), 1, 16)
print(renderer.describe()["variant"], seen.radiance.sum(), seen.coverage.sum(), seen.shadow.mean(),
      dense.sum(), seen.part.sum(), seen.normal.sum(), seen.depth.sum(), seen.albedo.sum())
"""


@pytest.fixture(scope="module")
def renderer():
    return make_renderer("mitsuba")


def random_scene(number: int) -> Scene:
    """Another object, materials and light for each number; one to three parts."""
    rng = np.random.default_rng(number)
    mesh = make_object(sorted(KINDS)[number % len(KINDS)], number)
    parts = np.minimum(mesh.part, number % 3)
    mesh = Mesh(vertices=mesh.vertices, faces=mesh.faces, part=parts, smooth=mesh.smooth)
    materials = [draw_material(rng, ObjectSettings()) for _ in range(mesh.part_count)]
    if number % 4 == 3:
        # Lobes that are exactly zero are the ones that would be compiled away.
        materials[0] = replace(materials[0], metallic=0.0, sheen=0.0, clearcoat=0.0, flatness=0.0)
    return Scene(mesh=mesh, materials=tuple(materials), light=sun_light(37.0 * number))


def test_no_kernel_is_compiled_after_the_second_scene(renderer):
    import drjit

    before = drjit.flag(drjit.JitFlag.KernelHistory)
    drjit.set_flag(drjit.JitFlag.KernelHistory, True)
    new = []
    try:
        for number in range(9):
            drjit.kernel_history_clear()
            what, cameras = random_scene(number), (view(), view(heading_deg=5.0 + number))
            renderer.render(what, cameras, FEW, number)
            renderer.reflectance(what.materials[0], what.light, FEW, number, 16)
            kernels = [k for k in drjit.kernel_history() if k["type"] == drjit.KernelType.JIT]
            # The scalar variant is compiled once and for all.
            assert bool(kernels) == renderer.describe()["variant"].startswith("llvm")
            new.append(sum(not k["cache_hit"] or k["cache_disk"] for k in kernels))
    finally:
        drjit.set_flag(drjit.JitFlag.KernelHistory, before)
    assert new[2:] == [0] * 7


@pytest.mark.slow
def test_memory_is_flat_over_sixty_scenes(renderer):
    process, sizes = psutil.Process(), []
    for number in range(60):
        what = random_scene(number)
        cameras = (view(width_px=128), view(width_px=128, side_m=0.2))
        renderer.render(what, cameras, Quality(samples=16), number)
        renderer.reflectance(what.materials[0], what.light, Quality(samples=16), number, 64)
        sizes.append(process.memory_info().rss / 2**20)
    assert np.mean(sizes[-10:]) - np.mean(sizes[15:25]) < 20


def run_ball(light_file, how: str) -> list[str]:
    done = subprocess.run(
        [sys.executable, "-c", ONE_BALL, str(light_file), how],
        capture_output=True, text=True, timeout=300, check=False,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.fixture(scope="module")
def light_file(tmp_path_factory):
    from panokit.io import write_environment_map

    path = tmp_path_factory.mktemp("light") / "sun.exr"
    write_environment_map(sun_light(120, 40), path)
    return path


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="needs Linux")
def test_one_cpu_suffices(light_file):
    """Mitsuba's own reader of EXR files waits forever there; panokit's is used."""
    assert float(run_ball(light_file, "one-cpu")[1]) > 0


def test_without_llvm_the_pictures_are_the_same_but_for_noise(light_file):
    fast, slow = (run_ball(light_file, how) for how in ("any", "scalar"))
    assert slow[0] == "scalar_rgb"
    assert [float(x) for x in slow[1:]] == pytest.approx([float(x) for x in fast[1:]], rel=0.02)


def test_filtered_noise_is_less_noise(renderer):
    pytest.importorskip("mitsuba_oidn")
    what, camera = scene(ball(), sun_light(60), GLOSSY), view(width_px=96)
    raw, clean, truth = (
        renderer.render(what, (camera,), Quality(samples=count, denoise=filtered), 3)[0]
        for count, filtered in ((16, False), (16, True), (1024, False))
    )
    inner = truth.coverage > 0.999
    errors = [
        np.sqrt(np.mean((one.radiance[inner] - truth.radiance[inner]) ** 2)) for one in (raw, clean)
    ]
    assert errors[1] < 0.8 * errors[0]
    assert clean.radiance[inner].mean() == pytest.approx(truth.radiance[inner].mean(), rel=0.02)
    assert np.array_equal(clean.coverage, raw.coverage)
    assert not clean.radiance[clean.coverage == 0].any()


@pytest.mark.parametrize("kind", ["chair", "plant", "candlestick"])
def test_paths_go_through_every_pixel_that_sees_the_object(kind):
    mesh, camera = make_object(kind, 3), view(pitch_deg=-20, heading_deg=40, width_px=64)
    covered = look(mesh.vertices, mesh.faces, camera, 5).face.reshape(64, 5, 64, 5) >= 0
    touched = touched_pixels(mesh, camera)
    assert touched[covered.any(axis=(1, 3))].all()
    # And not through many more.
    assert touched.sum() < 2.5 * covered.any(axis=(1, 3)).sum()


def test_an_object_that_fills_the_picture_and_one_beside_it(renderer):
    what = scene(ball(), uniform_light(), WHITE)
    close = view(distance_m=0.8, fov_deg=20)
    aside = view(side_m=5)
    seen, none = renderer.render(what, (close, aside), FEW, 1)
    assert seen.coverage.min() == pytest.approx(1)
    assert none.coverage.max() == 0
    assert not none.part.any()
    assert not none.radiance.any()


def test_four_materials_are_too_many(renderer):
    with pytest.raises(UsageError, match="Up to 3"):
        renderer.render(scene(boxes(4), uniform_light(), *[WHITE] * 4), (view(),), FEW, 1)
