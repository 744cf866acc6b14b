"""What a source charges and allows: a table of the package, and one of the user's own."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from panokit.errors import SettingsError
from panokit.io.files import read_bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Price:
    """What one source charges and allows.

    Attributes:
        unit: What is counted: "tile", "view", "picture".
        usd_per_1000: List price beyond the free amount.
        free_per_month: Units a month that cost nothing.
        per_day: The usual daily quota, or None.
        per_minute: The usual quota per minute, or None.
        page: Where it is written.
    """

    unit: str
    usd_per_1000: float
    free_per_month: int = 0
    per_day: int | None = None
    per_minute: int | None = None
    page: str = ""

    @property
    def usd_per_unit(self) -> float:
        """The list price of one."""
        return self.usd_per_1000 / 1000


def price_of(source: str, path: Path | None = None) -> Price:
    """What a source charges.

    Args:
        source: As in the settings of fetch.
        path: The user's own table; a source that is not in it costs what the package says.

    Raises:
        SettingsError: If the table is not one; the message names what is wrong in it.
        StorageError: If it cannot be read.
    """
    own = {} if path is None else _parse(read_bytes(path).decode("utf-8", "replace"), str(path))
    return own.get(source) or _bundled()[source]


@cache
def _bundled() -> dict[str, Price]:
    name = "prices.toml"
    return _parse(files("panokit.fetch").joinpath(name).read_text(encoding="utf-8"), name)


def _parse(text: str, where: str) -> dict[str, Price]:
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"{where} is not a TOML table: {error}.") from None
    return {source: _price(entry, f"{where}, [{source}]") for source, entry in table.items()}


def _price(entry: Any, where: str) -> Price:
    known = {field.name: field for field in fields(Price)}
    if not isinstance(entry, Mapping) or not {"unit", "usd_per_1000"} <= set(entry) <= set(known):
        raise SettingsError(
            f"{where}: a price has unit and usd_per_1000, and may have free_per_month, per_day, "
            "per_minute and page."
        )
    for name, value in entry.items():
        is_text = name in ("unit", "page")
        is_fine = isinstance(value, str) if is_text else _is_amount(value)
        if not is_fine or (name in ("per_day", "per_minute") and value < 1):
            raise SettingsError(f"{where}: {name} = {value!r} is not an amount.")
    return Price(**entry)


def _is_amount(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 <= value < 1e12
