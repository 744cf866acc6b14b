"""How long a library of ten thousand probes takes to list, filter, select from and index anew.

    make bench-library            or: python tests/benchmarks/library.py [COUNT]

The records are made up, as large as real ones, and lie on disk as a library has them; only the
maps are missing, which none of these touch. Times are the least of several, in milliseconds of
CPU (all threads) and on the clock; the goal is 100 ms for listing and for every filter.
"""

import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from panokit.probes import Library, ProbeFilter, SelectSettings, select
from panokit.probes.descriptors import LENGTH
from panokit.probes.library import SHELF_NAME
from panokit.qa.checks import RULES

GOAL_MS = 100.0
ROUNDS = 7
CATEGORIES = ("indoor_windows", "indoor_artificial", "outdoor_sunny", "outdoor_overcast",
              "outdoor_night", "sky_only", "street", "indoor_studio")  # fmt: skip
FILTERS = {
    "all": {},
    "category": {"category": "outdoor"},
    "box": {"bbox": (0, 40, 20, 55)},
    "days": {"date_from": "2023-01-01", "date_to": "2023-12-31"},
    "provider": {"provider": "panoramax"},
    "trainable": {"trainable": True},
    "verdict, stops": {"verdict": "pass", "dynamic_range_min_stops": 12.0},
    "kind": {"kind": "lifted"},
    "sun": {"has_sun": True},
    "tag": {"tags": ("bridge",)},
    "part of a name": {"name": "77"},
    "many": {"category": "outdoor", "kind": "native", "trainable": True, "has_sun": True,
             "bbox": (0, 40, 20, 55)},
}  # fmt: skip


def record(rng: np.random.Generator, number: int, id: str) -> dict[str, Any]:
    """A probe.json as `add` writes it."""
    lifted = number % 3 != 0
    day = f"{2020 + number % 6}-{1 + number % 12:02d}-{1 + number % 28:02d}"
    author = f"Author {number % 97}"
    license = {"id": "CC-BY-SA-4.0" if lifted else "CC0-1.0", "attribution": author,
               "url": "https://example.org", "store": True, "derive": True,
               "train": number % 11 != 0, "share_alike": lifted}  # fmt: skip
    sun = {"direction": [0.6, 0.64, -0.48], "azimuth_deg": 51.34, "elevation_deg": 39.79,
           "angular_radius_deg": 0.2666, "irradiance_rgb": [3.0, 2.9, 2.5],
           "evidence": "appearance", "also_in_map": True}  # fmt: skip
    steps = [
        {"stage": stage, "version": "1", "settings_digest": "ab" * 32,
         "input_digests": ["cd" * 32], "weights_digest": "", "values": {"tiles": 91}}
        for stage in (("stitch", "inpaint", "expand") if lifted else ())
    ]  # fmt: skip
    checks = [
        {"name": rule.name, "value": float(rng.uniform(0, 20)), "unit": rule.unit, "low": None,
         "high": None, "verdict": "pass"} for rule in RULES
    ]  # fmt: skip
    capture = {"provider": "panoramax" if lifted else "polyhaven", "id": f"picture-{number}",
               "license": license, "latitude_deg": float(rng.uniform(-60, 70)),
               "longitude_deg": float(rng.uniform(-180, 180)), "time": f"{day}T12:00:00Z",
               "time_precision": "second", "place": f"Place {number % 400}",
               "source_url": f"https://example.org/{number}"}  # fmt: skip
    return {
        "schema": "panokit.map/1",
        "key": "",
        "capture": capture,
        "frame": "world",
        "anchor": "ldr-white",
        "provenance": steps,
        "files": {"probe.exr": {"bytes": 1, "sha256": "ef" * 32}},
        "probe": {
            "id": id,
            "name": f"probe-{number:05d}",
            "width_px": 1024,
            "kind": "lifted" if lifted else "native",
            "category": CATEGORIES[number % len(CATEGORIES)],
            "tags": ["bridge", "river"] if number % 7 == 0 else ["street"],
            "sun": sun if number % 2 else None,
            "descriptor": [round(float(v), 4) for v in rng.normal(0, 1, LENGTH)],
            "report": {"settings_digest": "", "verdict": "pass", "checks": checks},
        },
    }


def make(folder: Path, count: int) -> None:
    """Write the records of `count` probes."""
    rng = np.random.default_rng(0)
    for number in range(count):
        id = f"{rng.integers(1 << 63):016x}"
        place = folder / SHELF_NAME / id
        place.mkdir(parents=True)
        (place / "probe.json").write_text(json.dumps(record(rng, number, id), indent=1))


def least(act: Callable[[], Any], rounds: int = ROUNDS) -> tuple[float, float, Any]:
    """The least milliseconds of CPU and of the clock, and the last result."""
    spent, clocked, result = [], [], None
    for _ in range(rounds):
        cpu, wall = time.process_time(), time.perf_counter()
        result = act()
        spent.append(time.process_time() - cpu)
        clocked.append(time.perf_counter() - wall)
    return 1e3 * min(spent), 1e3 * min(clocked), result


def opened_and_listed(folder: Path, wanted: ProbeFilter) -> int:
    """What a command does: open the library, list, close."""
    with Library.open(folder) as library:
        return len(library.list(wanted))


def main(count: int) -> int:
    """Measure and print; 1 if a listing misses the goal."""
    slow = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make(folder, count)
        cpu, wall, _ = least(lambda: Library.create(folder).close(), rounds=1)
        print(f"{count} records, {count / wall * 1e3:.0f} a second indexed at first")
        with Library.open(folder) as library:
            cpu, wall, _ = least(library.reindex, rounds=2)
            print(f"{'reindex':<22}{cpu:8.0f} ms CPU {wall:8.0f} ms, {count / wall * 1e3:.0f}/s")
        print(f"\n{'open, list and close':<22}{'CPU ms':>8}{'ms':>8}{'probes':>8}")
        for label, values in FILTERS.items():
            wanted = ProbeFilter.model_validate(values)
            cpu, wall, found = least(lambda wanted=wanted: opened_and_listed(folder, wanted))
            slow += min(cpu, wall) > GOAL_MS
            print(f"{label:<22}{cpu:8.1f}{wall:8.1f}{found:8d}")
        with Library.open(folder) as library:
            cpu, wall, found = least(lambda: len(library.list(ProbeFilter())))
            print(f"{'list alone':<22}{cpu:8.1f}{wall:8.1f}{found:8d}")
            wanted = SelectSettings(count=100)
            entries, known = library.list(), library.descriptors()
            cpu, wall, _ = least(lambda: select(entries, known, wanted), rounds=2)
            print(f"{'select 100 of them':<22}{cpu:8.1f}{wall:8.1f}")
            id = entries[count // 2].id
            cpu, wall, _ = least(lambda: library.show(id[:9]))
            print(f"{'show one':<22}{cpu:8.1f}{wall:8.1f}")
    print(f"\nslower than {GOAL_MS:.0f} ms: {slow}")
    return int(slow > 0)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000))
