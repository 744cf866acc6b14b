"""`panokit dataset`: render stereo samples, look at them, check them."""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from panokit.cli.options import Flag, Json
from panokit.console import Console, duration_text, size_text
from panokit.dataset.production.settings import ProductionSettings
from panokit.dataset.settings import DatasetSettings
from panokit.errors import UsageError

if TYPE_CHECKING:
    from panokit.dataset.production.estimate import Estimate
    from panokit.dataset.production.library_maker import LibraryMaker
    from panokit.dataset.production.produce import RenderResult

_Flat = Parameter(name="*")
_DatasetFolder = Annotated[Path, Parameter(help="The dataset's folder.")]
_MOST_PROBLEMS = 20


def render(
    *,
    probes: Annotated[list[Path], Parameter(consume_multiple=True)],
    out: Path,
    settings_file: Annotated[Path | None, Parameter(name="--settings")] = None,
    production: Annotated[ProductionSettings, _Flat] = ProductionSettings(),
    settings: Annotated[DatasetSettings, _Flat] = DatasetSettings(),
    index: int | None = None,
    dry_run: Flag = False,
    json: Json = False,
) -> int:
    """Render stereo pairs of unknown objects in known light.

    Stop it whenever you like; the same command goes on. See docs/commands/dataset.md.

    Parameters
    ----------
    probes
        Probe libraries, run folders, or folders of HDR maps.
    out
        Where the dataset goes.
    settings_file
        A TOML file of these options, such as pipelines/datasets/stereo-10k.toml.
    index
        Render this one sample only, as files in OUT/KEY.
    dry_run
        Render a few samples, write nothing, say how large and long all would be.
    """
    from panokit.dataset.production.library_maker import open_maker
    from panokit.dataset.production.produce import render_dataset
    from panokit.dataset.storage.layout import DatasetFolder

    console = Console(as_json=json)
    production, settings = _settled(settings_file, production, settings)
    # A dry run and a single sample leave nothing behind but what was asked for.
    packed = None if dry_run or index is not None else DatasetFolder(out).lights
    maker = open_maker(settings, probes, packed=packed)
    if index is not None:
        return _render_one(maker, out, index, console)
    if dry_run:
        return _dry_run(maker, out, production, console)
    result = render_dataset(maker, out, production, console)
    return _tell(result, console)


def preview(
    folder: _DatasetFolder,
    /,
    *,
    out: Path = Path("preview.png"),
    count: int = 8,
    split: str | None = None,
    json: Json = False,
) -> int:
    """Write a sheet of samples to look at.

    Parameters
    ----------
    out
        The picture: .png or .jpg.
    count
        How many samples, spread over the dataset.
    split
        Only of this split: train, validation or test.
    """
    from panokit.dataset.cards.preview import contact_sheet, open_for_preview, spread
    from panokit.io import encode_jpeg, encode_png, write_bytes

    encoders = {".png": encode_png, ".jpg": encode_jpeg, ".jpeg": encode_jpeg}
    if out.suffix.lower() not in encoders:
        raise UsageError(f"--out {out}: the picture is a .png or .jpg.")
    if count < 1:
        raise UsageError(f"--count {count}: give at least 1.")
    console = Console(as_json=json)
    dataset = open_for_preview(folder, split)
    numbers = spread(len(dataset), count)
    sheet = contact_sheet(dataset, numbers)
    write_bytes(out, encoders[out.suffix.lower()](sheet))
    console.result(f"{len(numbers)} of {len(dataset)} samples in {out}")
    console.value({"path": str(out), "keys": [str(dataset.keys[number]) for number in numbers]})
    return 0


def verify(folder: _DatasetFolder, /, *, json: Json = False) -> int:
    """Read all of a dataset again: digests, every file, the splits."""
    from dataclasses import asdict

    from panokit.dataset.storage.verify import verify_dataset

    console = Console(as_json=json)
    found = verify_dataset(folder, console)
    for problem in found.problems[:_MOST_PROBLEMS]:
        console.result(f"{problem.place} ({problem.reason}): {problem.message}")
    more = len(found.problems) - _MOST_PROBLEMS
    if more > 0:
        reasons = Counter(problem.reason for problem in found.problems).most_common()
        console.result(f"and {more} more; {', '.join(f'{n} {reason}' for reason, n in reasons)}")
    verdict = f"{len(found.problems)} problems" if found.problems else "all is well"
    missing = f"; {found.missing} missing" if found.missing else ""
    console.result(f"{found.samples} samples in {found.shards} shards{missing}: {verdict}")
    console.value(asdict(found))
    return 1 if found.problems else 0


def _settled(
    path: Path | None, production: ProductionSettings, settings: DatasetSettings
) -> tuple[ProductionSettings, DatasetSettings]:
    """What the file says, with what was typed in its place."""
    if path is None:
        return production, settings
    from panokit.pipeline.load import read_table, validated

    table, text = read_table(path)
    own = {name: table.pop(name) for name in ProductionSettings.model_fields if name in table}
    both = (
        (own, production, ProductionSettings),
        (table, settings, DatasetSettings),
    )
    first, second = (
        validated(_merged(inner, typed.model_dump(exclude_unset=True)), kind, str(path), text)
        for inner, typed, kind in both
    )
    return first, second  # type: ignore[return-value]


def _merged(table: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(table)
    for name, value in changes.items():
        inner = merged.get(name)
        both = isinstance(inner, Mapping) and isinstance(value, Mapping)
        merged[name] = _merged(inner, value) if both else value  # type: ignore[arg-type]
    return merged


def _render_one(maker: "LibraryMaker", out: Path, index: int, console: Console) -> int:
    from panokit.dataset.production.repeat import render_one

    one = render_one(maker, out, index)
    console.result(f"Sample {index}, attempt {one.attempt}, in {one.folder}")
    if one.shard:
        same = f"differs from {one.shard} in {', '.join(one.different)}"
        console.result(same if one.different else f"The same bytes as in {one.shard}")
    console.value({"folder": str(one.folder), "shard": one.shard, "different": list(one.different)})
    return 1 if one.different else 0


def _dry_run(
    maker: "LibraryMaker", out: Path, production: ProductionSettings, console: Console
) -> int:
    from dataclasses import asdict

    from panokit.dataset.production.estimate import estimate_dataset

    console.note("Rendering a few samples to measure...")
    found = estimate_dataset(maker, out, production)
    _tell_stock(maker, console)
    _tell_estimate(found, console)
    console.value(asdict(found))
    return 0


def _tell_stock(maker: "LibraryMaker", console: Console) -> None:
    stock = maker.stock
    rows = []
    for split, ids in stock.lights_of.items():
        places = {stock.lights.all[id].place for id in ids}
        rows.append(
            (
                split,
                str(len(places)),
                str(len(ids)),
                str(sum(map(len, stock.objects_of[split].values()))),
            )
        )
    console.table(("split", "places", "maps", "objects"), rows)


def _tell_estimate(found: "Estimate", console: Console) -> None:
    splits = ", ".join(f"{n:,} {split}" for split, n in found.splits.items())
    each = f"{found.seconds_per_sample:.2f} s of processor and {size_text(found.bytes_per_sample)}"
    console.result(f"samples:  {splits}, in {found.shards} shards")
    console.result(f"each:     {each} (of {found.measured} rendered)")
    if found.rejected:
        reasons = ", ".join(f"{n} {reason}" for reason, n in found.rejected.items())
        console.result(f"rejected: {reasons}")
    rate = sum(found.splits.values()) / found.seconds * 3600
    console.result(
        f"time:     {duration_text(found.seconds)} with {found.workers} workers on free cores: "
        f"{rate:,.0f} samples/h"
    )
    room = "" if found.fits else ": THEY DO NOT FIT"
    console.result(
        f"disk:     {size_text(found.bytes)} of {size_text(found.free_bytes)} free{room}"
    )


def _tell(result: "RenderResult", console: Console) -> int:
    console.result(f"{result.samples} samples in {result.folder} ({size_text(result.bytes)})")
    if result.made:
        rate = result.made / max(result.seconds, 1e-3) * 3600
        console.result(
            f"{result.made} made now in {duration_text(result.seconds)}: {rate:,.0f} an hour, "
            f"{result.cpu_s / result.made:.2f} s of processor each"
        )
    else:
        console.result("nothing to do")
    if result.rejected:
        reasons = sorted(result.rejected.items(), key=lambda item: -item[1])
        told = ", ".join(f"{n} {reason}" for reason, n in reasons)
        console.result(f"attempts rejected and drawn anew: {told}")
    if result.missing:
        console.result(
            f"{len(result.missing)} could not be made: see failures.jsonl there; "
            "--retry-missing tries again"
        )
    console.value(
        {
            "folder": str(result.folder),
            "samples": result.samples,
            "missing": dict(result.missing),
            "rejected": dict(result.rejected),
            "made": result.made,
            "seconds": round(result.seconds, 3),
            "cpu_s": round(result.cpu_s, 3),
            "bytes": result.bytes,
        }
    )
    return 1 if result.missing else 0
