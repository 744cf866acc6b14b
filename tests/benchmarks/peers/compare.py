"""panokit's geometry against its peers, in one run on one machine: a Markdown table.

make bench-peers

Accuracy is against waves known in every direction, not against another library. Peers run in
their own environment; one that cannot be imported is listed as not compared.
"""

import json
import subprocess
import sys
import tempfile
import time
from itertools import product
from pathlib import Path

import cv2
import numpy as np
from worker import ANGLE, SEE

from panokit.frames import Rotation, direction_from_azimuth_elevation
from panokit.sphere import (
    Equirectangular,
    apply_map,
    cubemap_directions,
    cubemap_faces,
    energy_ledger,
    equirect_directions,
    irradiance_map,
    perspective_directions,
    perspective_view,
    pixel_map,
    resize_radiance,
    rotate_radiance,
)

SPHERE = Equirectangular()
POSE = Rotation.about_axis((1, 0, 0), ANGLE)
REPEATS = 5


class Waves:
    """Waves in random directions; at 600 a radian they are ten pixels long in a 4096 px map."""

    def __init__(self, frequency):
        rng = np.random.default_rng(0)
        waves = rng.normal(size=(3, 4, 3))
        self.waves = waves / np.linalg.norm(waves, axis=-1, keepdims=True) * frequency
        self.phases = rng.uniform(0, 2 * np.pi, (3, 4))

    def __call__(self, directions):
        picture = np.empty(directions.shape, np.float32)
        for top in range(0, len(directions), 64):
            part = directions[top : top + 64].astype(np.float64)
            for channel in range(3):
                angles = part @ self.waves[channel].T + self.phases[channel]
                picture[top : top + 64, :, channel] = 0.5 + np.sin(angles).mean(axis=-1) / 2
        return picture


def cpu_seconds(work, repeats=REPEATS):
    best = np.inf
    for _ in range(repeats):
        started = time.process_time()
        work()
        best = min(best, time.process_time() - started)
    return best


def peer(python, task, picture, repeats=2):
    """(CPU seconds, version, result) of a peer, or the reason why it was not compared."""
    with tempfile.TemporaryDirectory() as folder:
        np.save(Path(folder) / "input.npy", picture)
        worker = Path(__file__).parent / "worker.py"
        done = subprocess.run(
            [python, str(worker), task, folder, str(repeats)],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            return "not compared: " + (done.stderr.strip().splitlines() or ["it failed"])[-1]
        told = json.loads(done.stdout.splitlines()[-1])
        if "missing" in told:
            return "not compared: " + told["missing"]
        return told["cpu_s"], told["version"], np.load(Path(folder) / "result.npy")


def psnr(result, truth):
    return float(-10 * np.log10(np.mean((np.float64(result) - truth) ** 2)))


def error_of(before, after):
    return f"{np.abs(energy_ledger(before, after).change).max():.1e}"


def row(name, cpu_s, ours, *figures):
    ratio = "1" if cpu_s == ours else f"{cpu_s / ours:.1f}"
    print(f"| {name} | {cpu_s * 1e3:.1f} | {ratio} | " + " | ".join(figures) + " |", flush=True)


def header(title, *columns):
    print(f"\n### {title}\n")
    print("| what | CPU ms | times panokit | " + " | ".join(columns) + " |")
    print("|---|---|---|" + "---|" * len(columns))


def rotation(python):
    header("4096x2048 float32 turned, maps cached", "PSNR dB", "seam", "poles", "largest error")
    directions = equirect_directions(4096, 2048)
    waves = Waves(600)
    picture = waves(directions)
    size = (4096, 2048)

    def figures(result, truth):
        seam = np.s_[:, [0, 1, -2, -1]]
        poles = np.s_[[0, 1, -2, -1]]
        return (
            f"{psnr(result, truth):.1f}", f"{psnr(result[seam], truth[seam]):.1f}",
            f"{psnr(result[poles], truth[poles]):.1f}", f"{np.abs(result - truth).max():.4f}",
        )  # fmt: skip

    truth = waves(POSE.inverse.apply(directions))
    started = time.process_time()
    found = pixel_map(SPHERE, size, SPHERE, size, POSE)
    made = time.process_time() - started
    linear = apply_map(picture, found)
    ours = cpu_seconds(lambda: apply_map(picture, found))
    row("panokit linear", ours, ours, *figures(linear, truth))
    spline = cpu_seconds(lambda: apply_map(picture, found, interpolation="spline"), 3)
    row("panokit spline", spline, ours,
        *figures(apply_map(picture, found, interpolation="spline"), truth))  # fmt: skip
    row("panokit, making the map once", made, ours, "", "", "", "")
    raw = lambda: cv2.remap(picture, found.column, found.row, cv2.INTER_LINEAR)  # noqa: E731
    row("cv2.remap linear, as most code calls it", cpu_seconds(raw), ours, *figures(raw(), truth))
    # Each peer has its own sense of an angle: it is scored by the one that fits it best.
    candidates = [
        waves(Rotation.about_axis(axis, sign * ANGLE).apply(directions[::8, ::8]))
        for axis, sign in product(np.eye(3), (1, -1))
    ]
    senses = list(product(np.eye(3), (1, -1)))
    for task in ("skylibs rotate order 1", "skylibs rotate order 3", "equilib rotate numpy",
                 "equilib rotate torch"):  # fmt: skip
        told = peer(python, task, picture, 1)
        if isinstance(told, str):
            print(f"| {task} | {told} | | | | | |")
            continue
        cpu_s, version, result = told
        best = int(np.argmax([psnr(result[::8, ::8], other) for other in candidates]))
        axis, sign = senses[best]
        theirs = waves(Rotation.about_axis(axis, sign * ANGLE).apply(directions))
        row(f"{task} ({version})", cpu_s, ours, *figures(result, theirs))


def view(python):
    header(f"4096x2048 float32 to a {SEE} px view of 90 degrees, maps cached", "PSNR dB")
    waves = Waves(150)
    picture = waves(equirect_directions(4096, 2048))
    truth = waves(perspective_directions(SEE, SEE, 90.0))
    mine = perspective_view(picture, SEE, SEE, 90.0)
    ours = cpu_seconds(lambda: perspective_view(picture, SEE, SEE, 90.0), 20)
    row("panokit linear", ours, ours, f"{psnr(mine, truth):.1f}")
    for task in ("py360convert view", "equilib view"):
        told = peer(python, task, picture, 10)
        if isinstance(told, str):
            print(f"| {task} | {told} | | |")
        else:
            row(f"{task} ({told[1]})", told[0], ours, f"{psnr(told[2], truth):.1f}")


def cube(python):
    header("8192x4096 uint8 to six faces of 1024, maps cached", "PSNR dB of the front face")
    waves = Waves(150)
    picture = np.rint(waves(equirect_directions(8192, 4096)) * 255).astype(np.uint8)
    truth = waves(cubemap_directions(1024, "front"))
    mine = cubemap_faces(picture, 1024)["front"] / 255
    ours = cpu_seconds(lambda: cubemap_faces(picture, 1024))
    row("panokit linear", ours, ours, f"{psnr(mine, truth):.1f}")
    told = peer(python, "py360convert cube", picture, 5)
    if isinstance(told, str):
        print(f"| py360convert cube | {told} | | |")
    else:
        row(f"py360convert cube ({told[1]})", told[0], ours, f"{psnr(told[2] / 255, truth):.1f}")


def light(python):
    header("4096x2048 with a sun at 85 degrees to 64x32", "error of the energy")
    directions = equirect_directions(4096, 2048)
    toward = direction_from_azimuth_elevation(0.3, np.deg2rad(85))
    radiance = np.repeat(0.4 + 0.2 * directions[..., 1:2], 3, axis=2)
    radiance[directions @ toward > np.cos(np.deg2rad(0.2665))] = 6e4

    def error(result):
        return error_of(radiance, result)

    ours = cpu_seconds(lambda: resize_radiance(radiance, 64), 15)
    row("panokit", ours, ours, error(resize_radiance(radiance, 64)))
    for name, filter_code in (("cv2 INTER_AREA", cv2.INTER_AREA), ("cv2 linear", cv2.INTER_LINEAR)):
        plain = lambda code=filter_code: cv2.resize(radiance, (64, 32), interpolation=code)  # noqa: E731
        row(name, cpu_seconds(plain, 15), ours, error(plain()))
    told = peer(python, "skylibs shrink", radiance, 2)
    if isinstance(told, str):
        print(f"| skylibs shrink | {told} | | |")
    else:
        row(f"skylibs shrink ({told[1]})", told[0], ours, error(told[2]))
    small = resize_radiance(radiance, 1024)
    irradiance_map(small, 64)
    turn = cpu_seconds(lambda: rotate_radiance(small, POSE))
    print("\n### Without a peer\n\n| what | CPU ms | error of the energy |\n|---|---|---|")
    print(f"| irradiance map 64x32 from 1024x512 | "
          f"{cpu_seconds(lambda: irradiance_map(small, 64), 15) * 1e3:.1f} | |")  # fmt: skip
    print(f"| `rotate_radiance` of 1024x512 | {turn * 1e3:.0f} | "
          f"{error_of(small, rotate_radiance(small, POSE))} |")  # fmt: skip


def main():
    python = sys.argv[1]
    print(f"OpenCV {cv2.__version__}, NumPy {np.__version__}, Python {sys.version.split()[0]}")
    for part in (rotation, view, cube, light):
        part(python)


if __name__ == "__main__":
    main()
