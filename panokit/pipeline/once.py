"""Work that is done once: a folder, and a record beside it that says what it was made from."""

import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from panokit.errors import RecordError
from panokit.io.files import read_json, write_json
from panokit.records import Receipt

SCHEMA = "panokit.stage/1"
_KEY_DIGITS = 10


def folder_of(root: Path, name: str, key: str) -> Path:
    """Where what is made with a key goes: other settings have another folder."""
    return root / f"{name}-{key[:_KEY_DIGITS]}"


def record_of(folder: Path) -> Path:
    """The record beside a folder; written last."""
    return folder.with_name(f"{folder.name}.json")


def do_once(
    stage: str, item: str, folder: Path, key: str, work: Callable[[], Mapping[str, Any]]
) -> Receipt:
    """Do some work, unless its record says that it is done.

    Args:
        stage: The stage.
        item: What is made.
        folder: Where it goes.
        key: What it is made from and with.
        work: Fills the folder, going on where an earlier run stopped; gives figures worth
            keeping, the same for the same key.
    """
    record = record_of(folder)
    known = _read(record)
    if known is not None and known.get("key") == key and folder.is_dir():
        return Receipt(
            item=item, stage=stage, path=folder, key=key, fresh=False, values=known["values"]
        )
    started, cpu_started = time.monotonic(), _cpu_s()
    values = dict(work())
    write_json(
        record, {"schema": SCHEMA, "stage": stage, "item": item, "key": key, "values": values}
    )
    return Receipt(
        item=item,
        stage=stage,
        path=folder,
        key=key,
        seconds=time.monotonic() - started,
        cpu_s=_cpu_s() - cpu_started,
        values=values,
    )


def _cpu_s() -> float:
    """Processor time of this process and of those that it has started and seen end."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _read(record: Path) -> dict[str, Any] | None:
    try:
        value = read_json(record)
    except RecordError:
        return None
    return value if isinstance(value, dict) and isinstance(value.get("values"), dict) else None
