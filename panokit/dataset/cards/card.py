"""The card of a dataset: what is in it, from its index and dataset.json alone."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from panokit.capture import Capture, license_from_spdx
from panokit.console import size_text
from panokit.dataset.cards.card_figures import draw_histograms
from panokit.dataset.cards.preview import contact_sheet, spread
from panokit.dataset.production.description import read_description
from panokit.dataset.sample import SPLITS
from panokit.dataset.storage.index import BYTES, member_names
from panokit.dataset.storage.member_table import meaning_of
from panokit.dataset.storage.read import StereoDataset
from panokit.io.attribution import SHEET as CREDITS
from panokit.io.attribution import TABLE as CREDITS_TABLE
from panokit.io.attribution import write_attribution
from panokit.io.files import write_bytes
from panokit.io.images import encode_jpeg

CARD, SHEET, HISTOGRAMS = "README.md", "sheet.jpg", "histograms.png"
# What `write_card` writes: goes wherever the samples go.
FILES = (CARD, SHEET, HISTOGRAMS, CREDITS, CREDITS_TABLE)
_SHEET_ROWS = 8
_PACKAGES = ("panokit", "numpy", "scipy", "opencv-contrib-python-headless", "OpenEXR", "mitsuba")


def write_card(folder: Path, table: pa.Table) -> None:
    """Write README.md with its pictures and credits into a dataset's folder.

    Args:
        folder: Of the dataset.
        table: Its index.

    Raises:
        StorageError: If something cannot be read or written.
    """
    folder = Path(folder)
    if table.num_rows:
        dataset = StereoDataset(folder, members=(), index=table)
        sheet = contact_sheet(dataset, spread(len(dataset), _SHEET_ROWS))
        write_bytes(folder / SHEET, encode_jpeg(sheet, quality=92))
        write_bytes(folder / HISTOGRAMS, draw_histograms(table))
    write_attribution(folder, _credited(table))
    write_bytes(folder / CARD, card_text(folder, table).encode())


def card_text(folder: Path, table: pa.Table) -> str:
    """The card as Markdown."""
    description = read_description(folder)
    parts = [
        _head(folder, table, description),
        _splits(table),
        _content(table),
        _members(table),
        _reading(table),
        _making(description),
        _licenses(table),
    ]
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def _head(folder: Path, table: pa.Table, description: Mapping[str, Any]) -> Iterator[str]:
    sizes = Counter(table.column("width_px").to_pylist())
    pictures = " and ".join(f"{size}x{size}" for size in sorted(filter(None, sizes)))
    lit = len(pc.unique(table.column("probe")))
    shown = len(pc.unique(table.column("object")))
    yield f"# {folder.resolve().name}"
    yield ""
    yield (
        f"{table.num_rows:,} stereo pairs of {pictures or 'no'} pixels: {shown:,} objects in the "
        f"light of {lit:,} environment maps, with that light, normals, depth, masks and "
        "reflectance maps. Rendered by panokit."
    )
    asked = int(description["count"])
    if table.num_rows < asked:
        yield (
            f"\n{asked - table.num_rows:,} of the {asked:,} samples that were asked for are not "
            "there: no attempt at them gave a usable picture, or they are not rendered yet."
        )
    if table.num_rows:
        yield f"\n![Samples: both views, normals, light, reflectance]({SHEET})"


def _splits(table: pa.Table) -> Iterator[str]:
    yield "## Splits\n"
    rows = []
    for split in SPLITS:
        part = table.filter(pc.equal(table.column("split"), split))
        counts = (len(pc.unique(part.column(name))) for name in ("place", "probe", "object"))
        rows.append((split, part.num_rows, *counts))
    yield from _table(("split", "samples", "places", "maps", "objects"), rows)
    yield "\nNo place and no object is in two splits; `panokit dataset verify` checks it."


def _content(table: pa.Table) -> Iterator[str]:
    yield "## What is in it\n"
    if table.num_rows:
        yield f"![Histograms of lights, objects, materials and exposure]({HISTOGRAMS})\n"
    for column, name in (("probe_kind", "kind of map"), ("object_kind", "kind of object")):
        counts = Counter(str(value) for value in table.column(column).to_pylist()).most_common()
        shares = ((kind, n, f"{n / table.num_rows:.1%}") for kind, n in counts)
        yield from _table((name, "samples", "share"), shares)
        yield ""
    attempts = pc.sum(table.column("attempt")).as_py() or 0
    yield (
        f"{attempts:,} attempts were rejected and drawn anew (object too dark, burnt out, or "
        "hardly in the picture)."
    )


def _members(table: pa.Table) -> Iterator[str]:
    yield "## Files of a sample\n"
    names = member_names(table)
    sizes = {name: table.column(BYTES + name) for name in names}
    rows = [
        (f"`{name}`", meaning_of(name), size_text(float(pc.mean(size).as_py() or 0)))
        for name, size in sizes.items()
    ]
    yield from _table(("member", "what", "mean size"), rows)
    total = sum(pc.sum(size).as_py() or 0 for size in sizes.values())
    yield f"\n{size_text(total)} in all."


def _reading(table: pa.Table) -> Iterator[str]:
    shards = sorted(set(table.column("shard").to_pylist()))
    train = [name for name in shards if name.startswith("train-")]
    pattern = f"train-{{00000..{len(train) - 1:05d}}}.tar" if len(train) > 1 else "train-00000.tar"
    yield "## How to read it\n"
    yield "```python"
    yield "from panokit.dataset import StereoDataset"
    yield ""
    yield 'train = StereoDataset(".", "train")'
    yield 'train[0]["left"], train[0]["env64"]   # numpy arrays'
    yield "```\n"
    yield f"The shards are tar files as the `webdataset` package reads them (`shards/{pattern}`)."
    yield "`index.parquet` has a row for each sample, with its parameters and where its files lie."


def _making(description: Mapping[str, Any]) -> Iterator[str]:
    maker = description["maker"]
    yield "## How it was made\n"
    yield "```toml"
    yield from _toml(maker.get("settings", {}))
    yield "```\n"
    rows = [(f"renderer {name}", value) for name, value in maker.get("renderer", {}).items()]
    rows += [(f"package {name}", found) for name in _PACKAGES if (found := _version(name))]
    yield from _table(("with", "version"), rows)


def _toml(settings: Mapping[str, Any], table: str = "") -> Iterator[str]:
    plain = {name: value for name, value in settings.items() if not isinstance(value, Mapping)}
    if table:
        yield f"\n[{table}]"
    for name, value in plain.items():
        yield f"{name} = {_toml_value(value)}"
    for name, value in settings.items():
        if isinstance(value, Mapping):
            yield from _toml(value, f"{table}.{name}" if table else name)


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml_value, value))}]"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return str(value)


def _licenses(table: pa.Table) -> Iterator[str]:
    yield "## Licenses and credits\n"
    rows = []
    for what in ("probe", "object"):
        pairs = zip(
            table.column(f"{what}_license").to_pylist(), table.column(what).to_pylist(), strict=True
        )
        by_license: dict[str, set[str]] = {}
        counts: Counter[str] = Counter()
        for license_id, one in pairs:
            by_license.setdefault(str(license_id), set()).add(one)
            counts[str(license_id)] += 1
        noun = {"probe": "maps", "object": "objects"}[what]
        rows += [(noun, id, len(by_license[id]), n) for id, n in counts.most_common()]
    yield from _table(("of", "license", "how many", "samples"), rows)
    yield (
        f"\nWhom to credit is in [{CREDITS}]({CREDITS}). Show the credits wherever the samples, or "
        "what was made of them, are shown; samples lit by share-alike maps carry their license."
    )


def _credited(table: pa.Table) -> Iterator[Capture]:
    """Each map and each object that is not panokit's own, as something to be credited."""
    for what in ("probe", "object"):
        names = (what, f"{what}_license", f"{what}_attribution")
        unique = table.group_by(list(names)).aggregate([]).to_pylist()
        for row in unique:
            id, spdx, attribution = (str(row[name] or "") for name in names)
            if id and not (what == "object" and attribution == "made by panokit"):
                terms = license_from_spdx(spdx, attribution)
                yield Capture(provider=what, id=id, license=terms)


def _table(header: tuple[str, ...], rows: Iterable[tuple[Any, ...]]) -> Iterator[str]:
    yield f"| {' | '.join(header)} |"
    yield f"|{'---|' * len(header)}"
    for row in rows:
        cells = (f"{cell:,}" if isinstance(cell, int) else str(cell) for cell in row)
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
