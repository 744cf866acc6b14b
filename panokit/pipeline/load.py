"""A pipeline's TOML file to its settings: strict, and helpful about slips.

An unknown key names the line it stands on and the nearest key that is known; nothing is
ignored in silence.
"""

import tomllib
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from panokit.errors import SettingsError
from panokit.io.files import read_bytes
from panokit.settings import Settings

SettingsType = TypeVar("SettingsType", bound=Settings)


def load_settings(
    path: Path, kind: type[SettingsType], overrides: Sequence[str] = ()
) -> SettingsType:
    """The settings that a TOML file gives.

    Args:
        path: The file.
        kind: The settings class.
        overrides: "a.b=value" texts that replace keys of the file.

    Raises:
        SettingsError: If the file is not TOML, or a key or value is wrong; one line, with
            the line number where there is one.
    """
    table, text = read_table(path)
    for override in overrides:
        _override(table, override)
    return validated(table, kind, str(path), text)


def read_table(path: Path) -> tuple[dict[str, Any], str]:
    """A TOML file's values and its text.

    Raises:
        SettingsError: If it is not TOML.
        StorageError: If it cannot be read.
    """
    data = read_bytes(path)
    try:
        text = data.decode()
        return tomllib.loads(text), text
    except UnicodeDecodeError as error:
        raise SettingsError(f"{path} is not a TOML file: it is not text.") from error
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"{path} is not a TOML file: {error}.") from error


def validated(
    table: dict[str, Any], kind: type[SettingsType], source: str, text: str = ""
) -> SettingsType:
    """The settings that a table of values gives; see `load_settings`."""
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        names = [str(part) for part in first["loc"]]
        line = _line_of(text, names)
        place = f"{source}, line {line}" if line else source
        raise SettingsError(f"{place}: {_explain(first, names, kind)}") from error


def _override(table: dict[str, Any], text: str) -> None:
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise SettingsError(f"--set takes NAME=VALUE, for instance fetch.count=3, not {text!r}.")
    *parents, last = name.strip().split(".")
    for parent in parents:
        table = table.setdefault(parent, {})
        if not isinstance(table, dict):
            raise SettingsError(f"--set {text}: {parent} is a value, not a table.")
    try:
        table[last] = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        table[last] = value


def _explain(error: Any, names: list[str], kind: type[BaseModel]) -> str:
    name = ".".join(names)
    if error["type"] == "extra_forbidden":
        known = _fields_at(kind, names[:-1])
        near = get_close_matches(names[-1], known, n=1, cutoff=0.5)
        hint = f"Did you mean {near[0]!r}?" if near else f"Known keys: {', '.join(known)}."
        return f"there is no setting {name!r}. {hint}"
    message = error["msg"][0].lower() + error["msg"][1:]
    if error["type"] == "missing":
        return f"the setting {name!r} is missing."
    return f"{name} = {error['input']!r}: {message}."


def _fields_at(kind: type[BaseModel], path: list[str]) -> list[str]:
    for name in path:
        field = kind.model_fields.get(name)
        inner = field.annotation if field else None
        for candidate in (inner, *getattr(inner, "__args__", ())):
            if isinstance(candidate, type) and issubclass(candidate, BaseModel):
                kind = candidate
    return list(kind.model_fields)


def _line_of(text: str, names: list[str]) -> int | None:
    """The line of the key that `names` leads to, or of its table, counted from 1."""
    keys = [name for name in names if not name.isdigit()]
    table: list[str] = []
    found = None
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip()
        if stripped.startswith("["):
            table = stripped.strip("[]").strip().split(".")
            if table == keys:
                return number
        key = stripped.partition("=")[0].strip().strip('"')
        if "=" in stripped and [*table, key] == keys[: len(table) + 1] and found is None:
            found = number
    return found
