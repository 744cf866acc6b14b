"""A pipeline that is killed again and again ends with the bytes of one that was left alone.

    python tests/benchmarks/pipeline_chaos.py [--count 200] [--workers 2] [--kill-every-s 4]

Street panoramas of three cities (scenes x light x turns, from rendered scenes or from the embedded
city) go through fetch, stitch, inpaint, expand, QA and into the library: once undisturbed, once
with workers killed with SIGKILL all the time, the driver three times, and the disk full once. Then
all records and pixels of both runs are compared byte by byte, and their indexes by content.

Prints a Markdown table, and ends with exit code 1 if anything differs, is lost or is there twice.
A full disk is a small tmpfs where that can be mounted, else a limit of the size of files.
"""

import argparse
import os
import random
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2
import numpy as np
import psutil

from panokit.color import srgb_decode_u8, srgb_encode_u8
from panokit.io import read_panorama, write_panorama
from panokit.ledger import Ledger
from panokit.panorama import Panorama
from panokit.probes import Library
from panokit.records import RunFolder
from panokit.synthetic import CitySettings, embedded_city, render_city

CITIES = {"Ashby": (44.0, -28.0), "Birkdale": (44.2, -28.0), "Colmouth": (44.4, -28.0)}
STOPS = (0.0, -0.7, 0.5, -1.4)
STEP_DEG = 0.0006
DISK_FULL = 4
_TOLD = (".sqlite", "log.jsonl", "timings.json", "report.html", "engine.json")


@dataclass(slots=True)
class Harm:
    """What was done to a run.

    Attributes:
        workers: Killed.
        drivers: Killed.
        full: How often the disk was full.
        starts: Of the driver.
    """

    workers: int = 0
    drivers: int = 0
    full: int = 0
    starts: int = 0
    codes: list[int] = field(default_factory=list)


def main() -> int:
    """Run both, compare, tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--scenes", type=int, default=0, help="rendered; 0: the embedded city")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--width-px", type=int, default=1024)
    parser.add_argument("--kill-every-s", type=float, default=4.0)
    parser.add_argument("--driver-lives-s", type=float, default=25.0)
    parser.add_argument("--model", default="expand-2")
    parser.add_argument("--work", type=Path, default=None)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    work = asked.work or Path(tempfile.mkdtemp(prefix="panokit-chaos-"))
    work.mkdir(parents=True, exist_ok=True)
    pictures = make_pictures(work / "pictures", asked.count, asked.scenes, asked.width_px)
    pipeline = write_pipeline(work / "chaos.toml", pictures, asked)
    started, cpu = time.monotonic(), children_cpu_s()
    calm = work / "calm"
    code = subprocess.run(
        command(pipeline, calm), check=False, stdout=subprocess.DEVNULL
    ).returncode
    calm_s, calm_cpu_s = time.monotonic() - started, children_cpu_s() - cpu
    if code != 0:
        print(f"The undisturbed run ended with exit code {code}.")
        return 1
    started = time.monotonic()
    with small_disk(work / "harmed", tree_bytes(calm) // 3) as disk:
        harm = disturb(pipeline, work / "harmed" / "run", disk, asked)
        harmed_s = time.monotonic() - started
        problems = compare(calm, work / "harmed" / "run")
    tell(asked, calm, harm, (calm_s, calm_cpu_s, harmed_s), problems, disk.kind)
    return 1 if problems or harm.codes[-1] != 0 else 0


def make_pictures(folder: Path, count: int, scenes: int, width_px: int) -> Path:
    """`count` pictures: scenes x light x turns, spread over three cities."""
    if scenes:
        city = folder.with_name("scenes")
        paths = render_city(CitySettings(count=scenes, width_px=width_px, samples=4,
                                         truth_width_px=64, truth_samples=1), city)  # fmt: skip
        sources = [read_panorama(path) for path in paths]
    else:
        sources = [replace(read_panorama(picture.image), capture=picture.capture)
                   for picture in embedded_city()]  # fmt: skip
    for number in range(count):
        scene, rest = number % len(sources), number // len(sources)
        name = f"scene{scene:02d}-light{rest % len(STOPS)}-turn{rest // len(STOPS):02d}"
        path = folder / f"{name}.jpg"
        if not path.with_suffix(".json").exists():
            stops, turn = STOPS[rest % len(STOPS)], rest // len(STOPS)
            write_panorama(_variant(sources[scene], name, number, width_px, stops, turn), path)
    return folder


def _variant(
    source: Panorama, name: str, number: int, width_px: int, stops: float, turn: int
) -> Panorama:
    size = (width_px, width_px // 2)
    pixels = cv2.resize(source.pixels, size, interpolation=cv2.INTER_AREA)
    shift = turn * width_px // 7
    pixels = np.roll(srgb_encode_u8(srgb_decode_u8(pixels) * np.float32(2**stops)), -shift, axis=1)
    city = list(CITIES)[number % len(CITIES)]
    place = number // len(CITIES)
    latitude, longitude = CITIES[city]
    capture = source.capture
    assert capture is not None
    heading = (capture.heading_deg or 0.0) + 360 * shift / width_px
    return Panorama(
        pixels=np.ascontiguousarray(pixels),
        frame=source.frame,
        capture=replace(
            capture,
            id=name,
            place=city,
            latitude_deg=latitude + STEP_DEG * (place % 10),
            longitude_deg=longitude + STEP_DEG * (place // 10),
            heading_deg=heading % 360,
            width_px=width_px,
            height_px=width_px // 2,
        ),
    )


def write_pipeline(path: Path, pictures: Path, asked: argparse.Namespace) -> Path:
    """The pipeline of both runs; a fixed port, because captures keep the address they came from."""
    of_city = [sum(n % len(CITIES) == k for n in range(asked.count)) for k in range(len(CITIES))]
    areas = [
        f"[[areas]]\ncount = {count}\nplaces = [{{ name = '{name}', latitude_deg = {latitude}, "
        f"longitude_deg = {longitude}, radius_m = 5000 }}]\n"
        for (name, (latitude, longitude)), count in zip(CITIES.items(), of_city, strict=True)
        if count
    ]
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    path.write_text(
        f"name = 'chaos'\nserve = '{pictures}'\nserve_port = {port}\nengine = 'local'\n"
        f"workers = {asked.workers}\nmax_rejected_share = 1.0\n\n"
        + "\n".join(areas)
        + "\n[fetch]\nmin_distance_m = 0\nwidth_px = 256\nrequests_per_s = 500\n"
        f"\n[expand]\nmodel = '{asked.model}'\nwidth_px = {asked.width_px // 4}\n"
    )
    return path


def command(pipeline: Path, out: Path) -> list[str]:
    """The driver's."""
    return [sys.executable, "-m", "panokit", "run", str(pipeline), "--out", str(out)]


@dataclass(slots=True)
class Disk:
    """A disk that is too small until `grow` is called."""

    kind: str
    folder: Path

    def grow(self) -> None:
        """Give it room."""
        if self.kind == "tmpfs":
            subprocess.run(["mount", "-o", "remount,size=8g", str(self.folder)], check=True)
        self.kind += ", grown"

    def limits(self) -> list[str]:
        """What comes before a command: where no tmpfs can be had, files may not be large."""
        return ["prlimit", "--fsize=40000"] if self.kind == "limit" else []


@contextmanager
def small_disk(folder: Path, size: int) -> Iterator[Disk]:
    """A folder on a disk of so many bytes, if this process may mount one."""
    folder.mkdir(parents=True, exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={max(size, 1 << 20)}", "tmpfs", str(folder)]
    mounted = subprocess.run(mount, check=False, capture_output=True).returncode == 0
    try:
        yield Disk(kind="tmpfs" if mounted else "limit", folder=folder)
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], check=False)


def disturb(pipeline: Path, out: Path, disk: Disk, asked: argparse.Namespace) -> Harm:
    """Start the pipeline until it is done, doing harm all the while."""
    harm = Harm()
    rng = random.Random(asked.seed)
    while True:
        harm.starts += 1
        is_small = not disk.kind.endswith("grown")
        driver = subprocess.Popen(
            [*disk.limits(), *command(pipeline, out)], stdout=subprocess.DEVNULL
        )
        over = threading.Event()
        killer = threading.Thread(target=_kill_workers, args=(driver.pid, over, harm, asked, rng))
        killer.start()
        try:
            may_kill = not is_small and harm.drivers < 3
            driver.wait(asked.driver_lives_s if may_kill else None)
        except subprocess.TimeoutExpired:
            driver.send_signal(signal.SIGKILL)
            driver.wait()
            harm.drivers += 1
        over.set()
        killer.join()
        harm.codes.append(driver.returncode)
        if is_small:
            harm.full += driver.returncode == DISK_FULL
            disk.grow()
        elif driver.returncode != -signal.SIGKILL:
            return harm


def _kill_workers(
    driver: int, over: threading.Event, harm: Harm, asked: argparse.Namespace, rng: random.Random
) -> None:
    while not over.wait(asked.kill_every_s * rng.uniform(0.5, 1.5)):
        try:
            children = psutil.Process(driver).children(recursive=True)
            workers = [p for p in children if any("spawn_main" in part for part in p.cmdline())]
            if workers:
                rng.choice(workers).kill()
                harm.workers += 1
        except psutil.Error:
            continue


def tree(root: Path) -> dict[str, bytes]:
    """Every file that must be the same; the log and what is made of it know durations."""
    return {
        str(path.relative_to(root)): path.read_bytes()
        for path in sorted(root.rglob("*"))
        if path.is_file() and not path.name.endswith(_TOLD)
    }


def compare(calm: Path, harmed: Path) -> list[str]:
    """What differs between two runs."""
    one, other = tree(calm), tree(harmed)
    problems = [f"lost: {name}" for name in one.keys() - other.keys()]
    problems += [f"too many: {name}" for name in other.keys() - one.keys()]
    problems += [
        f"differs: {name}" for name in one.keys() & other.keys() if one[name] != other[name]
    ]
    contents = [Ledger(RunFolder(root).ledger).content() for root in (calm, harmed)]
    if contents[0] != contents[1]:
        problems.append("the ledgers differ")
    shelves = []
    for root in (calm, harmed):
        with Library.open(root / "library") as library:
            shelves.append((library.list(), library.descriptors()))
    if shelves[0] != shelves[1]:
        problems.append("the indexes of the libraries differ")
    return problems


def tree_bytes(root: Path) -> int:
    """Of all files."""
    return sum(path.stat().st_size for path in root.rglob("*") if path.is_file())


def children_cpu_s() -> float:
    """Processor time of all processes that this one has waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def tell(
    asked: argparse.Namespace,
    calm: Path,
    harm: Harm,
    times: Sequence[float],
    problems: Sequence[str],
    disk: str,
) -> None:
    """A Markdown table."""
    counts = Ledger(RunFolder(calm).ledger).counts()
    stages = ", ".join(f"{stage} {count}" for stage, (count, _, _) in counts.items())
    rows = {
        "panoramas": f"{asked.count} of 3 cities, {asked.width_px} px wide",
        "done in each stage": stages,
        "undisturbed": f"{times[0]:.0f} s, {times[1]:.0f} s of processor, {asked.workers} workers",
        "disturbed": f"{times[2]:.0f} s",
        "workers killed": str(harm.workers),
        "drivers killed": str(harm.drivers),
        "disk full": f"{harm.full} ({disk})",
        "starts": f"{harm.starts}, exit codes {harm.codes}",
        "files compared": str(len(tree(calm))),
        "differences": str(len(problems)),
        "load of the machine": f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} cores",
    }
    print("| figure | value |\n|---|---|")
    for name, value in rows.items():
        print(f"| {name} | {value} |")
    for problem in problems[:20]:
        print(f"- {problem}")


if __name__ == "__main__":
    raise SystemExit(main())
