"""Renders with Blender's Cycles, the thesis's renderer, in a process of its own.

Blender is never loaded into this process: its license and its packages are its own. It is found
through `PANOKIT_BLENDER` (the program), `PANOKIT_BLENDER_PYTHON` (a Python that has the module
`bpy`), or as `blender` on the PATH. One process is started per renderer and fed job by job.
"""

import json
import os
import shutil
import subprocess
import tempfile
import weakref
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.objects.creases import corner_normals
from panokit.dataset.objects.solids import Solids
from panokit.dataset.renderers.analytic import sphere_normals
from panokit.dataset.renderers.cycles_passes import read_exr_channels, shadow_of, view_passes
from panokit.dataset.renderers.texturing import box_coordinates
from panokit.dataset.scene import Material, Mesh, Quality, Scene, View, ViewPasses
from panokit.envmap import EnvironmentMap
from panokit.errors import PanokitError, UsageError
from panokit.frames import TOOL_FROM_PANOKIT

VERSION = "1"
SCRIPT = Path(__file__).with_name("cycles_script.py")
FLOOR_ALBEDO, _FLOOR_HALF_SIDE_M = 0.4, 20.0
MOST_PARTS = 3
_BLENDER = TOOL_FROM_PANOKIT["blender"].matrix
_ANSWER = "@panokit "
_FAR_M = 10.0


def blender_command() -> list[str]:
    """How Blender is started on this machine, without the script's own arguments.

    Raises:
        PanokitError: If none is found.
    """
    python = os.environ.get("PANOKIT_BLENDER_PYTHON")
    named = os.environ.get("PANOKIT_BLENDER")
    if python and not named:
        if shutil.which(python) is None:
            raise PanokitError(
                f"PANOKIT_BLENDER_PYTHON names {python!r}, which is not a program. "
                "Name a Python that has the module bpy."
            )
        return [python, str(SCRIPT)]
    program = shutil.which(named or "blender")
    if program is None:
        wrong = (
            f"PANOKIT_BLENDER names {named!r}, which is not a program"
            if named
            else ("No Blender was found")
        )
        raise PanokitError(
            f"{wrong}. Install Blender 3.4 or newer and set PANOKIT_BLENDER to its program, set "
            "PANOKIT_BLENDER_PYTHON to a Python with bpy, or render with Mitsuba."
        )
    options = ["-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python"]
    return [program, *options, str(SCRIPT)]


class CyclesRenderer:
    """Renders with Cycles on one thread; see the module.

    Raises:
        PanokitError: If Blender is not found or does not start.
    """

    def __init__(self) -> None:
        command = blender_command()
        self._folder = Path(tempfile.mkdtemp(prefix="panokit-cycles-"))
        self._job = 0
        self._said: deque[str] = deque(maxlen=20)
        # The stream stays open as long as this renderer lives.
        self._process = subprocess.Popen(
            [*command, "--", str(self._folder)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        self.close = weakref.finalize(self, _close, self._process, self._folder)
        self._hello = self._answer()

    @property
    def process_id(self) -> int:
        """Of Blender, for those who measure what it takes."""
        return self._process.pid

    def describe(self) -> Mapping[str, Any]:
        """Name and version."""
        return {"name": "cycles", "version": self._hello["version"], "recipe": VERSION}

    def render(
        self, scene: Scene, views: tuple[View, ...], quality: Quality, seed: int
    ) -> tuple[ViewPasses, ...]:
        """The passes of each view.

        Raises:
            UsageError: If there are more than three materials, or noise is to be filtered and
                this Blender cannot.
            PanokitError: If Blender fails.
        """
        if len(scene.materials) > MOST_PARTS:
            raise UsageError(f"Up to {MOST_PARTS} materials, not {len(scene.materials)}.")
        low, high = scene.mesh.bounds
        floor = None
        if scene.floor_m is not None:
            middle = (low + high) / 2
            place = _BLENDER @ np.array([middle[0], scene.floor_m, middle[2]])
            floor = [*place.tolist(), _FLOOR_HALF_SIDE_M]
        files = self._run(
            scene.mesh,
            scene.materials,
            scene.light,
            {"views": [_view(view) for view in views], "floor": floor}
            | self._quality(quality, seed),
        )
        passes = []
        for index, view in enumerate(views):
            beauty, guides = (files[f"{index}-{shot}"] for shot in ("beauty", "guides"))
            shadow = None
            if floor is not None:
                shadow = shadow_of(files[f"{index}-both"], files[f"{index}-bare"])
            passes.append(view_passes(beauty, guides, scene.materials, view, shadow))
        return tuple(passes)

    def reflectance(
        self, material: Material, light: EnvironmentMap, quality: Quality, seed: int, width_px: int
    ) -> NDArray[np.float32]:
        """A sphere of triangles, path-traced; a texture counts by its mean color."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = _BLENDER, _BLENDER @ np.array([0, 0, _FAR_M])
        view = {"matrix": matrix.tolist(), "fov": None, "shift": 0.0, "guides": False}
        plain = Material(**(_figures(material) | {"texture": None}))
        job = {"views": [view | {"size": [width_px, width_px]}], "floor": None}
        files = self._run(_ball(), (plain,), light, job | self._quality(quality, seed))
        seen = files["0-beauty"]
        whole = seen["Combined"][..., :3] / np.maximum(seen["Combined"][..., 3:], 1e-6)
        _, inside = sphere_normals(width_px)
        return np.where(inside[..., None], whole, 0).astype(np.float32)

    def _quality(self, quality: Quality, seed: int) -> dict[str, Any]:
        if quality.denoise and not self._hello["denoise"]:
            raise UsageError(
                f"Blender {self._hello['version']} was built without a denoiser. "
                "Render without one, or with Mitsuba."
            )
        return {
            "samples": quality.samples,
            "bounces": quality.bounces,
            "denoise": quality.denoise,
            "seed": 2 * seed,
            "floor_albedo": FLOOR_ALBEDO,
        }

    def _run(
        self,
        mesh: Mesh,
        materials: tuple[Material, ...],
        light: EnvironmentMap,
        job: dict[str, Any],
    ) -> dict[str, dict[str, NDArray[np.float32]]]:
        """Channels by layer of each file, by the number of the view and the kind of picture."""
        if not self.close.alive:
            raise PanokitError("This renderer is closed. Make another one.")
        self._job += 1
        name = f"job{self._job}"
        arrays: dict[str, Any] = {
            "light": light.radiance,
            "corners": mesh.vertices[mesh.faces] @ _BLENDER.T,
            "normals": corner_normals(mesh) @ _BLENDER.T,
            "places": box_coordinates(mesh),
            "part": mesh.part,
        }
        for index, material in enumerate(materials):
            if material.texture is not None:
                arrays[f"texture{index}"] = material.texture
        np.savez(self._folder / f"{name}.npz", allow_pickle=False, **arrays)
        job = job | {"materials": [_sockets(material) for material in materials]}
        (self._folder / f"{name}.json").write_text(json.dumps(job), encoding="utf-8")
        answer = self._ask(name)
        if "error" in answer:
            raise PanokitError(f"Blender failed: {answer['error'].strip().splitlines()[-1]}")
        pictures = {}
        for path in map(Path, answer["files"]):
            pictures[path.stem.partition("-")[2]] = read_exr_channels(path)
            path.unlink()
        for suffix in (".npz", ".json"):
            (self._folder / f"{name}{suffix}").unlink()
        return pictures

    def _ask(self, line: str) -> dict[str, Any]:
        stream = self._process.stdin
        try:
            if stream is not None:
                stream.write(line + "\n")
                stream.flush()
        except OSError as error:
            raise PanokitError(f"Blender has stopped: {self._last_words()}") from error
        return self._answer()

    def _answer(self) -> dict[str, Any]:
        for line in self._process.stdout or ():
            if line.startswith(_ANSWER):
                value: dict[str, Any] = json.loads(line.removeprefix(_ANSWER))
                return value
            if line.strip():
                self._said.append(line.strip())
        raise PanokitError(f"Blender has stopped: {self._last_words()}")

    def _last_words(self) -> str:
        return " / ".join(list(self._said)[-3:]) or "it said nothing"


def _close(process: "subprocess.Popen[str]", folder: Path) -> None:
    if process.stdin is not None:
        process.stdin.close()
    try:
        process.wait(timeout=10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    if process.stdout is not None:
        process.stdout.close()
    shutil.rmtree(folder, ignore_errors=True)


def _view(view: View) -> dict[str, Any]:
    # A camera of Blender looks along its own -Z with +Y up, as ours does.
    matrix = np.eye(4)
    matrix[:3, :3] = _BLENDER @ view.world_from_camera.matrix
    matrix[:3, 3] = _BLENDER @ np.asarray(view.position)
    return {
        "matrix": matrix.tolist(),
        "fov": float(np.deg2rad(view.fov_deg)),
        "shift": -view.shift_px / view.width_px,
        "size": [view.width_px, view.height_px],
        "guides": True,
    }


def _figures(material: Material) -> dict[str, Any]:
    return {name: getattr(material, name) for name in material.__slots__}


def _sockets(material: Material) -> dict[str, Any]:
    """What Blender's shader is given; it has no flatness, and its gloss is a roughness.

    The widths of the varnish are those of Burley 2012, between which the gloss chooses.
    """
    gloss = material.clearcoat_gloss
    return {
        "base_color": list(material.base_color),
        "roughness": material.roughness,
        "metallic": material.metallic,
        "specular": material.specular,
        "sheen": material.sheen,
        "clearcoat": material.clearcoat,
        "clearcoat_roughness": float(np.sqrt(0.1 + (0.001 - 0.1) * gloss)),
    }


def _ball() -> Mesh:
    """A sphere of radius 1."""
    solids, angle = Solids(), np.linspace(0, np.pi, 65)
    profile = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    profile[[0, -1], 0] = 0
    solids.lathe(0, profile, segments=128)
    return solids.mesh(longest_m=2.0)
