"""What reading light costs: comparing views, feeding a step, and one pair through ONNX Runtime.

    python tests/benchmarks/lighting.py [--data DATASET] [--work DIR] [--width 16] [--input 64]

Prints Markdown tables, CPU time of this process on one thread:
  the kinds of similarity (pointwise, epipolar, row, full): time and memory by size of features;
  a step of training beside the loading of its batch, decoded from shards or read from a pack
  (needs --data);
  latency of the stereo network for a pair of 128x128 pictures, by width.
"""

import argparse
import os
import platform
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402 - after the number of threads is set
import onnxruntime  # noqa: E402
import torch  # noqa: E402

from panokit.dataset.storage.read import StereoDataset  # noqa: E402
from panokit.networks.stereo.settings import StereoNetSettings  # noqa: E402
from panokit.networks.stereo.similarity import similarity, similarity_channels  # noqa: E402
from panokit.train.run import start  # noqa: E402
from panokit.train.stereo.loop import Steps  # noqa: E402
from panokit.train.stereo.losses import MapLoss  # noqa: E402
from panokit.train.stereo.pack import PICTURES, open_pack  # noqa: E402
from panokit.train.stereo.recipe import LightingRecipe  # noqa: E402
from panokit.train.stereo.release import FILE, release_lighting  # noqa: E402
from panokit.train.stereo.tasks import batch_of, build_network  # noqa: E402
from panokit.train.team import ALONE  # noqa: E402

BATCH, FEATURES, REACH = 24, 64, 4
KINDS = ("pointwise", "epipolar", "row", "full")


def cpu_ms(work: Callable[[], Any], runs: int) -> float:
    """The median CPU time of some runs after one that does not count, in milliseconds."""
    work()
    seconds = []
    for _ in range(runs):
        begun = time.process_time()
        work()
        seconds.append(time.process_time() - begun)
    return 1000 * statistics.median(seconds)


def comparisons(sizes: tuple[int, ...], runs: int) -> None:
    """The kinds of similarity for a pair of pictures; features are an eighth of their width."""
    print(f"One pair, {FEATURES} features, epipolar with a reach of {REACH}:\n")
    print("| picture | kind | channels | CPU-ms | MB of the result |")
    print("|---|---|---|---|---|")
    for size in sizes:
        small = size // 8
        left, right = torch.randn(2, 1, FEATURES, small, small).unbind()
        for kind in KINDS:
            with torch.inference_mode():
                spent = cpu_ms(lambda k=kind, a=left, b=right: similarity(a, b, k, REACH), runs)
                bytes_of = similarity(left, right, kind, REACH).nbytes
            channels = similarity_channels(kind, REACH, small)
            print(f"| {size} | {kind} | {channels} | {spent:.2f} | {bytes_of / 1e6:.3f} |")


def feeding(data: Path, work: Path, width: int, size: int, runs: int) -> None:
    """A batch from shards, from a pack, and the step that it is for."""
    recipe = LightingRecipe(id="bench", network=StereoNetSettings(width=width, input_px=size))
    members = (*(f"{name}.png" for name in PICTURES), "env64.exr")
    source = StereoDataset(data, "train", members=members)
    rng = np.random.default_rng(0)

    def picked() -> np.ndarray:
        return np.sort(rng.choice(len(pack), BATCH, replace=False))

    begun = time.process_time()
    pack = open_pack(data, "train", size, work, limit=10 * BATCH)
    packing = (time.process_time() - begun) / len(pack)
    decoded = cpu_ms(lambda: [source[int(n)] for n in picked()], max(2, runs // 5))
    read = cpu_ms(lambda: batch_of(recipe, pack, picked(), 0), runs)
    network = build_network(recipe).to(memory_format=torch.channels_last)
    schedule = Steps(steps=100, learning_rate=1e-3, weight_decay=0, ema_decay=0.9)
    run, loss_of = (
        start(network, schedule, ALONE, seed=0),
        MapLoss(recipe.loss, recipe.coding.coding),
    )
    inputs, truth = batch_of(recipe, pack, picked(), 0)
    ready = [2 * one - 1 for one in inputs.values()]
    steps = {}
    for precision in ("fp32", "bf16"):

        def step(precision: str = precision) -> None:
            with ALONE.autocast(precision):
                code = network(*ready)
            run.advance(torch.stack(list(loss_of(code.float(), truth).values())).sum())

        steps[precision] = cpu_ms(step, max(3, runs // 3))
    print(f"\nA batch of {BATCH} at {size}x{size}, network of width {width}:\n")
    print("| what | CPU-ms |\n|---|---|")
    print(
        f"| decoded from shards (256-pixel pictures or as the dataset has them) | {decoded:.0f} |"
    )
    print(f"| read from a pack | {read:.1f} |")
    print(f"| the step, single precision | {steps['fp32']:.0f} |")
    print(f"| the step, bfloat16 | {steps['bf16']:.0f} |")
    if packing > 1e-4:
        print(f"\nPacking took {1000 * packing:.0f} CPU-ms a sample, once.")


def latency(widths: tuple[int, ...], size: int, runs: int) -> None:
    """p50 and p95 of a pair through ONNX Runtime, one thread."""
    print(f"\nOne pair of {size}x{size} through ONNX Runtime {onnxruntime.__version__}:\n")
    print("| width | parameters | p50 CPU-ms | p95 CPU-ms | p50 ms | p95 ms |")
    print("|---|---|---|---|---|---|")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    for width in widths:
        recipe = LightingRecipe(id="b", network=StereoNetSettings(width=width, input_px=size))
        network = build_network(recipe).eval()
        with tempfile.TemporaryDirectory() as folder:
            release_lighting(recipe, network, Path(folder))
            session = onnxruntime.InferenceSession(
                str(Path(folder) / FILE), options, providers=["CPUExecutionProvider"]
            )
        views = {
            one.name: np.random.default_rng(0).random((1, 3, size, size), np.float32)
            for one in session.get_inputs()
        }
        spent, waited = [], []
        for number in range(runs + 3):
            cpu, wall = time.process_time(), time.perf_counter()
            session.run(None, views)
            if number >= 3:
                spent.append(1000 * (time.process_time() - cpu))
                waited.append(1000 * (time.perf_counter() - wall))
        figures = [float(np.percentile(one, p)) for one in (spent, waited) for p in (50, 95)]
        count = sum(weights.numel() for weights in network.parameters())
        row = " | ".join(f"{value:.1f}" for value in figures)
        print(f"| {width} | {count / 1e6:.2f} M | {row} |", flush=True)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path)
    parser.add_argument("--work", type=Path, default=Path("work"))
    parser.add_argument("--width", type=int, default=16)
    parser.add_argument("--input", type=int, default=64)
    parser.add_argument("--runs", type=int, default=15)
    chosen = parser.parse_args()
    torch.set_num_threads(1)
    load = os.getloadavg()[0]
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} CPUs, load {load:.1f}\n")
    comparisons((64, 128, 256), chosen.runs)
    if chosen.data is not None:
        feeding(chosen.data, chosen.work, chosen.width, chosen.input, chosen.runs)
    latency((8, 16, 32, 64), 128, chosen.runs)


if __name__ == "__main__":
    main()
