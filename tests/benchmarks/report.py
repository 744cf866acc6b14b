"""How large a report of 200 light probes is, and how soon it is open: a Markdown table.

    python tests/benchmarks/report.py PANOKIT_DATA [COUNT]

The probes of the shared data, and the same turned by a seventh, two sevenths ... of a turn until
there are enough. A probe has all that a report says of one: checks, limits, its license. The page
is opened from disk in a headless Chromium that is bound to two cores, with WebGL in software: a
machine with a graphics card draws faster. "Open" is the load event, when every map of the page is
there; "usable" is when the gallery can be filtered and a map can be asked for. CPU is that of
all of the browser's processes from asking for the page to its load event. Five fresh browsers;
what else runs on the machine shows in the times, so its load is told.
"""

import os
import shutil
import statistics
import sys
import tempfile
import time
from itertools import count, islice
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import psutil

from panokit.io import read_environment_map
from panokit.report import (
    Badge,
    Cell,
    Column,
    Count,
    Counts,
    Gallery,
    Page,
    Table,
    Text,
    layer_width_px,
    light_map,
    write_page,
)
from panokit.report.pictures import median_luminance

MOST_BYTES = 60e6
MOST_SECONDS = 3.0
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
ARGUMENTS = [
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-sandbox",
]
CHECKS = 25
USABLE = """
  new MutationObserver((_, observer) => {
    const tools = document.getElementById("gallery-tools");
    if (tools && !tools.hidden) { window.usable = performance.now(); observer.disconnect(); }
  }).observe(document, { subtree: true, childList: true, attributes: true });
"""


def probes(folder):
    """Name and map of every probe, then of every probe turned."""
    files = sorted((folder / "probes").glob("*.hdr"))
    for turn in count():
        for file in files:
            envmap = read_environment_map(file)
            shift = turn * envmap.width_px // 7
            turned = np.ascontiguousarray(np.roll(envmap.radiance, shift, axis=1))
            yield f"{file.stem}_{turn}" if turn else file.stem, envmap.with_changes(radiance=turned)


def entry(name, envmap, width_px):
    """A probe with as many words as a report has."""
    columns = (Column(label="Figure"), Column(label="Value", numeric=True))
    rows = tuple(
        (
            Cell(text=f"Check {number}", note="What the figure says, in one plain sentence."),
            Cell(text="0.123", note="at most 0.5", badge=Badge(text="ok")),
        )
        for number in range(CHECKS)
    )
    return light_map(
        envmap,
        name,
        width_px=width_px,
        badge=Badge(text="No defect"),
        category=name.split("_")[0],
        figures={"Median": median_luminance(envmap.radiance)},
        subtitle="Poly Haven · 1024x512 · relative scale",
        facts=(
            Table(title="Checks", columns=columns, rows=rows, headings=False),
            Text(title="License", paragraphs=("CC0-1.0",)),
        ),
    )


def make(folder, number, path):
    """Write the page; CPU seconds for each probe, beyond reading it."""
    width, spent, entries = layer_width_px(number), 0.0, []
    for name, envmap in islice(probes(folder), number):
        started = time.process_time()
        entries.append(entry(name, envmap, width))
        spent += time.process_time() - started
    started = time.process_time()
    head = (Counts(counts=(Count(label="light maps", value=str(number)),)),)
    gallery = Gallery(title="Maps", entries=tuple(entries))
    write_page(Page(title="Light probes", head=head, sections=(gallery,)), path)
    return width, (spent + time.process_time() - started) / number


def browser_cpu():
    """Seconds that all browser processes below this one have used."""
    spent = 0.0
    for process in psutil.Process().children(recursive=True):
        try:
            if "chrom" in process.name():
                times = process.cpu_times()
                spent += times.user + times.system
        except psutil.Error:
            continue
    return spent


def open_once(playwright, program, path):
    """Seconds until the page is usable, until it is open, and until a map is drawn; and CPU."""
    browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
    try:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.add_init_script(USABLE)
        page.wait_for_timeout(500)
        before = browser_cpu()
        page.goto(path.as_uri(), wait_until="load", timeout=60_000)
        cpu = browser_cpu() - before
        opened = page.evaluate("() => performance.getEntriesByType('navigation')[0].loadEventEnd")
        usable = page.evaluate("() => window.usable")
        started = time.perf_counter()
        page.locator(".open").first.click()
        while not page.evaluate("() => document.getElementById('view').dataset.drawn"):
            page.wait_for_timeout(10)
        return usable / 1000, opened / 1000, time.perf_counter() - started, cpu
    finally:
        browser.close()


def main(folder, number=200, rounds=5):
    from playwright.sync_api import sync_playwright

    program = os.environ.get("PANOKIT_CHROMIUM") or next(filter(None, map(shutil.which, BROWSERS)))
    cores = sorted(os.sched_getaffinity(0))[:2]
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "report.html"
        width, cpu = make(folder, number, path)
        size = path.stat().st_size
        os.sched_setaffinity(0, cores)
        with sync_playwright() as playwright:
            times = [open_once(playwright, program, path) for _ in range(rounds)]
    print(f"{number} probes, maps {width}x{width // 2}; {rounds} browsers on {len(cores)} cores;")
    print(f"load average {os.getloadavg()[0]:.1f}\n")
    print("| figure | goal | fastest | median | slowest |\n|---|---|---|---|---|")
    print(f"| size of the file | < 60 MB | | {size / 1e6:.1f} MB | |")
    rows = (
        ("usable", ""),
        ("open", "< 3 s"),
        ("first map drawn after a click", ""),
        ("CPU of the browser until open", ""),
    )
    for (label, goal), values in zip(rows, zip(*times, strict=True), strict=True):
        three = min(values), statistics.median(values), max(values)
        print(f"| {label} | {goal} | " + " | ".join(f"{value:.2f} s" for value in three) + " |")
    print(f"| CPU to write, for each probe | | | {cpu:.3f} s | |")
    opened = statistics.median(row[1] for row in times)
    return 0 if number != 200 or (size < MOST_BYTES and opened < MOST_SECONDS) else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), *map(int, sys.argv[2:])))
