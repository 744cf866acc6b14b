"""How often QA sees deliberate damage, and how often it sees some where there is none.

    make bench-qa                                   (needs PANOKIT_DATA)
    python tests/benchmarks/qa_damage.py PANOKIT_DATA [--fixing] [--city DIR]

Thresholds were fixed on one half of the places of the captured probes (qa_damage_fit.py); this
reads the other half and prints Markdown tables. `--fixing` shows the fixing half instead, for
work on checks. Flips and turns are judged on places of the synthetic city, which need Mitsuba
and are kept in DIR.
"""

import os
import sys
import tempfile
import time
from argparse import ArgumentParser
from collections.abc import Iterable
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

import cv2
import numpy as np
import OpenEXR
from qa_damage_city import flipped, places, sun_moves, turned
from qa_damage_kinds import KINDS, recorded, resized_well
from qa_damage_split import Reference, references

from panokit.envmap import EnvironmentMap
from panokit.errors import ImageError
from panokit.io import read_environment_map
from panokit.qa import Report, Verdict, check, judge
from panokit.qa.checks import RULES
from panokit.qa.measurements import Measurements

cv2.setNumThreads(1)
HEADER = (
    "| damage | eligible | maps | abstained | detected | of those judged | false alarms |\n"
    "|---|---|---|---|---|---|---|"
)


def of_checks(envmap: EnvironmentMap, names: Iterable[str]) -> Verdict:
    """The verdict of some checks alone, which is all that is measured."""
    measured = Measurements(envmap)
    values = {rule.name: rule.measure(measured).value for rule in RULES if rule.name in names}
    return verdict_of(judge(values), names)


def verdict_of(report: Report, names: Iterable[str]) -> Verdict:
    """Of some checks together: FAIL if one fails, NOT_APPLICABLE if none applies."""
    found = [c.verdict for c in report.checks if c.name in names]
    if Verdict.FAIL in found:
        return Verdict.FAIL
    return Verdict.PASS if Verdict.PASS in found else Verdict.NOT_APPLICABLE


def row(name: str, eligible: str, damaged: list[Verdict], sound: list[Verdict]) -> str:
    judged = [v for v in damaged if v is not Verdict.NOT_APPLICABLE]
    hits, alarms = damaged.count(Verdict.FAIL), sound.count(Verdict.FAIL)
    return (
        f"| {name} | {eligible} | {len(damaged)} | {len(damaged) - len(judged)} "
        f"| {percent(hits, len(damaged))} | {percent(hits, len(judged))} "
        f"| {percent(alarms, len(sound))} |"
    )


def percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.0f} % ({part}/{whole})" if whole else "–"


def reference_table(probes: list[Reference], reports: dict[str, Report]) -> None:
    usable = [p for p in probes if p.usable]
    passed = [p for p in usable if reports[p.name].verdict is Verdict.PASS]
    print(f"Usable probes that pass every check: {percent(len(passed), len(usable))}")
    for probe in usable:
        if probe not in passed:
            print(f"- {probe.name} ({probe.category}) fails: {_reasons(reports[probe.name])}")


def marked_table(probes: list[Reference]) -> None:
    print("\n| marked probe | half | what the manifest says | flagged for |\n|---|---|---|---|")
    for probe in probes:
        if not probe.usable:
            side = "scored" if probe.scored else "fixing"
            said = probe.note.replace("|", "/")
            print(f"| {probe.name} | {side} | {said} | {_marked(probe)} |")


def _marked(probe: Reference) -> str:
    try:
        read_environment_map(probe.path)
        refused = ""
    except ImageError as error:
        refused = f"rejected when read ({error.reason}, {_bad(error)}); repaired: "
    reasons = _reasons(check(probe.read()))
    return refused + (reasons or "no check fails")


def _bad(error: ImageError) -> str:
    return ", ".join(f"{count} {name}" for name, count in error.values.items() if count)


def _reasons(report: Report) -> str:
    return "; ".join(
        f"{c.name} {c.value:.3g}{'' if c.unit in ('°', '×', 'σ') else ' '}{c.unit}".strip()
        for c in report.failed
    )


def damage_table(probes: list[Reference], maps: dict[str, EnvironmentMap],
                 reports: dict[str, Report]) -> None:  # fmt: skip
    print(f"\n{HEADER}")
    for number, kind in enumerate(KINDS):
        damaged, sound = [], []
        for probe in probes:
            if not (probe.usable and kind.applies(probe)):
                continue
            rng = np.random.default_rng([number, sum(probe.name.encode())])
            damaged.append(of_checks(kind.damage(maps[probe.name], rng), kind.checks))
            if "energy-ledger" in kind.checks:
                sound.append(of_checks(resized_well(maps[probe.name]), kind.checks))
            else:
                sound.append(verdict_of(reports[probe.name], kind.checks))
        print(row(kind.name, kind.eligible, damaged, sound), flush=True)
    usable = [p for p in probes if p.usable]
    refused = [_refused_with_nan(maps[p.name]) for p in usable]
    print(row("NaN patch of 3x4 pixels", "all", refused, [Verdict.PASS] * len(usable)))


def _refused_with_nan(envmap: EnvironmentMap) -> Verdict:
    radiance = envmap.radiance.copy()
    radiance[50:53, 60:64] = np.nan
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "patch.exr"
        with OpenEXR.File(header, {"RGB": radiance}) as file:
            file.write(str(path))
        try:
            read_environment_map(path)
        except ImageError:
            return Verdict.FAIL
    return Verdict.PASS


def sun_table(folder: Path) -> None:
    maps = places(folder)
    names = ("sun-place", "sun-clock")
    for name, change, moves in (
        ("flipped left to right", flipped, lambda m: sun_moves(m, -1, 1)),
        ("heading off by 180°", turned, lambda m: sun_moves(m, -1, -1)),
    ):
        eligible = [m for m in maps if moves(m)]
        damaged = [of_checks(change(m), names) for m in eligible]
        sound = [of_checks(m, names) for m in eligible]
        print(row(name, "synthetic city by day, where it moves the sun by over 6°", damaged, sound))
    if not maps:
        print("| flipped left to right, heading off by 180° | needs Mitsuba | 0 | | | | |")


def cost(maps: Iterable[EnvironmentMap]) -> None:
    seconds = []
    for envmap in maps:
        if envmap.width_px == 1024:
            started = time.process_time()
            check(envmap)
            seconds.append(time.process_time() - started)
    print(
        f"\nCPU time of all checks of a 1024x512 map, reading it not counted, over {len(seconds)} "
        f"maps: median {np.median(seconds):.2f} s, most {np.max(seconds):.2f} s"
    )


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--fixing", action="store_true")
    parser.add_argument("--city", type=Path, default=Path(tempfile.gettempdir()) / "panokit-qa")
    chosen = parser.parse_args()
    everything = references(chosen.data)
    probes = [p for p in everything if p.scored is not chosen.fixing]
    groups = "fixing" if chosen.fixing else "scored"
    print(f"{len(probes)} probes of the {groups} half, {sum(p.usable for p in probes)} usable\n")
    maps = {p.name: p.read() for p in probes}
    # The first temperature imports a library, which is no part of a map's cost.
    check(recorded(next(iter(maps.values()))))
    reports = {name: check(envmap) for name, envmap in maps.items()}
    reference_table(probes, reports)
    marked_table(everything)
    damage_table(probes, maps, reports)
    sun_table(chosen.city)
    cost(maps.values())


if __name__ == "__main__":
    sys.exit(main())
