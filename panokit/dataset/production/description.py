"""dataset.json: what was asked for, and whether a folder may go on with what is asked now."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from panokit.dataset.production.maker import SampleMaker
from panokit.dataset.storage.layout import DatasetFolder
from panokit.errors import RecordError, SettingsError, StorageError
from panokit.io.files import read_json, write_json
from panokit.provenance import digest_of

SCHEMA = "panokit.dataset/1"
_SHOWN = 3


def describe(maker: SampleMaker, count: int, shard_samples: int) -> dict[str, Any]:
    """The content of dataset.json."""
    made_by = dict(maker.describe())
    return {
        "schema": SCHEMA,
        "key": digest_of([SCHEMA, made_by]),
        "count": count,
        "shard_samples": shard_samples,
        "maker": made_by,
    }


def check_and_write(folder: DatasetFolder, wanted: Mapping[str, Any]) -> None:
    """Record what is asked for, if the folder has no dataset yet or one of the same kind.

    Raises:
        SettingsError: If it has one that was made otherwise.
        StorageError: If it cannot be written.
    """
    found = read_description(folder.root) if folder.description.exists() else None
    if found is None:
        if any(folder.shards.glob("*.tar")):
            raise SettingsError(
                f"{folder.root} has shards, but no {folder.description.name} that says how they "
                "were made. Choose another --out."
            )
        write_json(folder.description, dict(wanted))
        return
    check_same(folder.root, found, wanted)
    if wanted["count"] < found["count"]:
        raise SettingsError(
            f"{folder.root} was to have {found['count']} samples and may grow, but not shrink to "
            f"{wanted['count']}. Give --count {found['count']} or more, or another --out."
        )
    if wanted["count"] > found["count"]:
        write_json(folder.description, dict(wanted))


def check_same(root: Path, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Compare two descriptions but for the number of samples.

    Raises:
        SettingsError: If they differ; it names what.
    """
    parts = ("maker", "shard_samples")
    differences = [
        text for part in parts for text in _differences(found.get(part), wanted[part], part)
    ]
    if differences:
        more = len(differences) - _SHOWN
        shown = "; ".join(differences[:_SHOWN]) + (f"; and {more} more" if more > 0 else "")
        raise SettingsError(
            f"{root} holds a dataset that was made otherwise: {shown}. All samples of a dataset "
            "are made alike: ask for the same, or choose another --out."
        )


def read_description(folder: Path) -> dict[str, Any]:
    """The dataset.json of a dataset.

    Raises:
        StorageError: If there is none.
        RecordError: If it is damaged or of another version.
    """
    path = DatasetFolder(Path(folder)).description
    if not path.exists():
        raise StorageError(
            f"There is no dataset in {folder}: no {path.name}. Make one with "
            "`panokit dataset render`."
        )
    value = read_json(path)
    if not isinstance(value, dict) or value.get("schema") != SCHEMA:
        raise RecordError(
            f"{path} is not the {SCHEMA} of this version of panokit. Choose another folder.",
            reason="other-schema",
        )
    return value


def _differences(found: Any, wanted: Any, place: str) -> Iterator[str]:
    """The leaves in which two nested values differ, told for people."""
    if isinstance(found, Mapping) and isinstance(wanted, Mapping):
        for name in sorted({*found, *wanted}):
            inner = name if place in ("maker", "settings") else f"{place}.{name}"
            yield from _differences(found.get(name), wanted.get(name), inner)
    elif _plain(found) != _plain(wanted):
        yield f"{place} was {_text(found)} and is {_text(wanted)}"


def _plain(value: Any) -> Any:
    """As JSON has it: a tuple is a list there."""
    return list(map(_plain, value)) if isinstance(value, list | tuple) else value


def _text(value: Any) -> str:
    if value is None or isinstance(value, Mapping):
        return "not there" if value is None else "there"
    text = str(value)
    return f"{text[:12]}..." if len(text) > 32 else text or "nothing"
