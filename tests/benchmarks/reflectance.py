"""CPU time of the sparse reflectance map: the 2018 thesis's search per cell beside the operator.

    python tests/benchmarks/reflectance.py [--batch 24] [--width 256] [--runs 3] [--whole]

The thesis's pseudo-code (its section 3.1) takes the cosines between a cell's normal and those of
the picture, masks the intensities where they are within five degrees, and copies the color of
the brightest pixel. Here that is one masked argmax in numpy for each cell: over all pixels of the
picture, as it was written, and over those of the object only, which is kinder to it. Beside it
the numpy reference (`panokit.reflectance`) and the torch operator (`panokit.networks`), on bodies
with bumps that fill half of the picture. Maps and hits are compared in the same run.

CPU time is of this process on one thread; the search is timed on three samples and multiplied,
unless --whole is given. The operator is timed once more on --threads, by the clock: the search
cannot use a second core. Where there is CUDA, it is timed there, too.
"""

import argparse
import os
import platform
import time
from collections.abc import Callable
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402 - after the number of threads is set
import torch  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from panokit.color import luminance  # noqa: E402
from panokit.networks.stereo import sparse  # noqa: E402
from panokit.reflectance import hemisphere_normals, sparse_reflectance  # noqa: E402

MAP_PX, GATE_DEG = 64, 5.0
Bodies = tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_]]
Found = tuple[NDArray[np.float32], NDArray[np.int32]]


def bodies(count: int, width: int) -> Bodies:
    """Pictures (B, H, W, 3) of 8 bits, normals (B, H, W, 3) and masks (B, H, W) of lit bodies."""
    rng = np.random.default_rng(0)
    y, x = (np.mgrid[:width, :width] + 0.5) / width * 2 - 1
    parts: list[tuple[Any, Any, Any]] = []
    for _ in range(count):
        mask = np.hypot(x, y) < rng.uniform(0.75, 0.85)
        phase, rate = rng.uniform(0, 2 * np.pi, 4), rng.uniform(3, 9, 4)
        across = x + 0.25 * np.sin(rate[0] * x + phase[0]) * np.cos(rate[1] * y + phase[1])
        up = -y + 0.25 * np.sin(rate[2] * x + phase[2]) * np.cos(rate[3] * y + phase[3])
        inward = np.minimum(1, 0.98 / np.maximum(np.hypot(across, up), 1e-9))
        across, up = across * inward, up * inward
        normals = np.stack([across, up, np.sqrt(1 - across**2 - up**2)], axis=-1)
        light = rng.normal(0, 1, 3)
        shade = np.maximum(normals @ light / np.linalg.norm(light), 0) + 0.1
        color = shade[..., None] * rng.uniform(0.3, 1, 3) + rng.normal(0, 0.02, (*x.shape, 3))
        seen = np.round(np.clip(color, 0, 1) * 255) / 255
        parts.append((seen * mask[..., None], normals * mask[..., None], mask))
    pictures, all_normals, masks = (np.stack(one) for one in zip(*parts, strict=True))
    return pictures.astype(np.float32), all_normals.astype(np.float32), masks


def search(picture: NDArray[np.float32], normals: NDArray[np.float32]) -> Found:
    """The thesis's pseudo-code over pixels (N, 3): one masked argmax for each cell."""
    grid, inside = hemisphere_normals(MAP_PX)
    least = np.float32(np.cos(np.deg2rad(GATE_DEG)))
    intensity = luminance(picture.astype(np.float64))
    x, y, z = np.ascontiguousarray(normals.T)
    color = np.zeros((MAP_PX, MAP_PX, 3), np.float32)
    hits = np.zeros((MAP_PX, MAP_PX), np.int32)
    for row, column in zip(*np.nonzero(inside), strict=True):
        a, b, c = grid[row, column]
        near = x * a + y * b + z * c > least
        hits[row, column] = np.count_nonzero(near)
        brightest = np.where(near, intensity, -1).argmax()
        if near[brightest]:
            color[row, column] = picture[brightest]
    return color, hits


def least_seconds(
    work: Callable[[], Any], runs: int, clock: Callable[[], float] = time.process_time
) -> tuple[float, Any]:
    """The least time of some runs, of the processor if not said otherwise, and what came out."""
    seconds = []
    for _ in range(runs):
        start = clock()
        found = work()
        seconds.append(clock() - start)
    return min(seconds), found


def by_torch(made: Bodies, device: str = "cpu") -> list[Found]:
    """The operator on the batch; the way to a device and back is part of it."""
    pictures, normals, masks = (torch.from_numpy(one).to(device) for one in made)
    color, hits = sparse.sparse_reflectance(
        pictures.permute(0, 3, 1, 2), normals.permute(0, 3, 1, 2), masks
    )
    color = color.permute(0, 2, 3, 1)
    return list(zip(color.cpu().numpy(), hits.cpu().numpy(), strict=True))


def by_reference(made: Bodies) -> list[Found]:
    """The numpy reference, one sample after the other."""
    return [
        (one.color, one.hits)
        for one in (sparse_reflectance(*sample) for sample in zip(*made, strict=True))
    ]


def are_equal(some: list[Found], others: list[Found]) -> bool:
    """Whether maps and hits are equal to the last bit."""
    return all(
        np.array_equal(a, b)
        for one, other in zip(some, others, strict=False)
        for a, b in zip(one, other, strict=True)
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--batch", type=int, default=24)
    parser.add_argument("--width", type=int, default=256)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--whole", action="store_true", help="time the search on all samples")
    chosen = parser.parse_args()
    torch.set_num_threads(1)
    made = bodies(chosen.batch, chosen.width)
    few = [one[: chosen.batch if chosen.whole else 3] for one in made]
    share = chosen.batch / len(few[0])
    by_reference([one[:1] for one in made])  # tables are made with the first call
    seconds, found = {}, {}
    seconds["search over the picture"], found["picture"] = least_seconds(
        lambda: [search(p.reshape(-1, 3), n.reshape(-1, 3)) for p, n, _ in zip(*few, strict=True)],
        1,
    )
    seconds["search over the object"], found["object"] = least_seconds(
        lambda: [search(p[m], n[m]) for p, n, m in zip(*few, strict=True)], 1
    )
    seconds = {name: value * share for name, value in seconds.items()}
    seconds["numpy reference"], found["numpy"] = least_seconds(
        lambda: by_reference(made), chosen.runs
    )
    seconds["torch operator"], found["torch"] = least_seconds(lambda: by_torch(made), chosen.runs)
    torch.set_num_threads(chosen.threads)
    name = f"torch operator, {chosen.threads} threads, by the clock"
    seconds[name], found["threads"] = least_seconds(
        lambda: by_torch(made), chosen.runs, time.perf_counter
    )
    if torch.cuda.is_available():
        name = "torch operator, CUDA, by the clock"
        by_torch(made, "cuda")
        seconds[name], found["cuda"] = least_seconds(
            lambda: by_torch(made, "cuda"), chosen.runs, time.perf_counter
        )
    load = os.getloadavg()[0]
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} CPUs, load {load:.1f}")
    print(f"{chosen.batch} pictures of {chosen.width}x{chosen.width}, objects on "
          f"{made[2].mean():.0%} of them, maps of {MAP_PX}x{MAP_PX}\n")  # fmt: skip
    print("| how | s a batch | times the search over the picture | over the object |")
    print("|---|---|---|---|")
    whole, own = seconds["search over the picture"], seconds["search over the object"]
    for name, value in seconds.items():
        print(f"| {name} | {value:.3f} | {whole / value:.1f} | {own / value:.1f} |")
    equal = {name: are_equal(found["picture"], others) for name, others in found.items()}
    print(f"\nMaps and hits equal to the search's: {equal}")
    if not all(equal.values()):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
