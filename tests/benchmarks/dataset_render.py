"""CPU time of dataset samples: whole samples by size, and Mitsuba beside Cycles.

    python tests/benchmarks/dataset_render.py PANOKIT_DATA [--samples N] [--without-blender]

Prints Markdown tables. A sample is everything that `make_sample` writes: two views with all
passes, the backgrounds, the aligned maps and the dense reflectance map. CPU time is user and
system time of this process and of Blender, each on one thread; start-up and the first three
samples, in which kernels are compiled, are left out. Both renderers get the same plans: the
same objects, materials, maps, cameras and paths per pixel.
"""

import argparse
import os
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

import cv2  # noqa: E402 - after the number of threads is set
import psutil  # noqa: E402

from panokit.dataset.make import make_sample  # noqa: E402
from panokit.dataset.plan import draw_plan  # noqa: E402
from panokit.dataset.renderers import make_renderer  # noqa: E402
from panokit.dataset.settings import DatasetSettings, RigSettings  # noqa: E402
from panokit.dataset.stock import open_stock  # noqa: E402
from panokit.errors import ItemError, PanokitError  # noqa: E402

WARM_UP = 3
cv2.setNumThreads(1)


class Timed:
    """A renderer whose own CPU time is added up.

    Args:
        renderer: What renders.
        clock: CPU seconds used so far.
    """

    def __init__(self, renderer: Any, clock: Callable[[], float]) -> None:
        self._renderer, self._clock, self.seconds = renderer, clock, 0.0

    def describe(self) -> Any:
        return self._renderer.describe()

    def render(self, *arguments: Any) -> Any:
        start = self._clock()
        passes = self._renderer.render(*arguments)
        self.seconds += self._clock() - start
        return passes

    def reflectance(self, *arguments: Any) -> Any:
        start = self._clock()
        picture = self._renderer.reflectance(*arguments)
        self.seconds += self._clock() - start
        return picture


def cpu_clock(renderer: Any) -> Callable[[], float]:
    """CPU seconds of this process, and of Blender where the renderer has one."""
    others = [psutil.Process(renderer.process_id)] if hasattr(renderer, "process_id") else []

    def seconds() -> float:
        return time.process_time() + sum(sum(one.cpu_times()[:2]) for one in others)

    return seconds


def measure(name: str, width_px: int, samples: int, count: int, probes: Path) -> dict[str, Any]:
    """Medians and means over samples of one renderer at one size."""
    settings = DatasetSettings(rig=RigSettings(width_px=width_px), samples=samples)
    stock = open_stock(settings, [probes])
    renderer = make_renderer(name)
    clock = cpu_clock(renderer)
    timed = Timed(renderer, clock)
    whole, render, bytes_written, shares = [], [], [], []
    index = 0
    while len(whole) < count + WARM_UP:
        plan = draw_plan(settings, stock, index)
        index += 1
        timed.seconds, start = 0.0, clock()
        try:
            sample = make_sample(plan, settings, stock, timed)
        except ItemError:
            continue
        whole.append(clock() - start)
        render.append(timed.seconds)
        bytes_written.append(sum(map(len, sample.members.values())))
        shares.append(sample.figures["mask_share"])
    description = dict(renderer.describe())
    if hasattr(renderer, "close"):
        renderer.close()
    return {
        "renderer": " ".join(str(description[key]) for key in ("name", "version")),
        "variant": description.get("variant", ""),
        "whole": statistics.mean(whole[WARM_UP:]),
        "median": statistics.median(whole[WARM_UP:]),
        "render": statistics.mean(render[WARM_UP:]),
        "bytes": statistics.mean(bytes_written),
        "mask": statistics.mean(shares),
    }


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--samples", type=int, default=20)
    parser.add_argument("--without-blender", action="store_true")
    chosen = parser.parse_args()
    probes = chosen.data / "probes"
    load = os.getloadavg()[0]
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} CPUs, load {load:.1f}\n")
    print("| size | paths | renderer | CPU-s a sample | median | of which rendering | kB | mask |")
    print("|---|---|---|---|---|---|---|---|")
    rows = {}
    runs = [("mitsuba", 256), ("mitsuba", 128)]
    runs += [] if chosen.without_blender else [("blender", 256), ("blender", 128)]
    for name, width_px in runs:
        try:
            row = measure(name, width_px, 64, chosen.samples, probes)
        except PanokitError as error:
            print(f"\n{name}: not measured ({error})")
            continue
        rows[name, width_px] = row
        print(
            f"| {width_px}x{width_px} | 64 | {row['renderer']} {row['variant']} | "
            f"{row['whole']:.2f} | {row['median']:.2f} | {row['render']:.2f} | "
            f"{row['bytes'] / 1000:.0f} | {row['mask']:.2f} |",
            flush=True,
        )
    for width_px in (256, 128):
        if {("mitsuba", width_px), ("blender", width_px)} <= rows.keys():
            one, other = rows["mitsuba", width_px], rows["blender", width_px]
            print(
                f"\n{width_px}x{width_px}: Cycles takes "
                f"{other['render'] / one['render']:.1f} times "
                f"the CPU time of Mitsuba for rendering, {other['whole'] / one['whole']:.1f} times "
                "for whole samples."
            )


if __name__ == "__main__":
    main()
