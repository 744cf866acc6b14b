"""A pipeline's TOML file to its settings: strict, and helpful about slips.

An unknown key names the line it stands on and the nearest key that is known; nothing is
ignored in silence. A file may extend another one: what it says goes first, table by table.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from panokit.errors import SettingsError
from panokit.io.files import read_bytes
from panokit.settings import Settings

SettingsType = TypeVar("SettingsType", bound=Settings)
EXTENDS = "extends"
# Files to read lie relative to the pipeline that names them; what is written, to where one is.
_FILES = ("city_list", "area_file", "picture_list", "prices")


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A file that has its say, for messages.

    Attributes:
        path: As it was named.
        text: What stands in it.
    """

    path: str
    text: str


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
    table, sources = _extended(Path(path), ())
    for override in overrides:
        _override(table, override)
    return _validated(table, kind, sources)


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
    return _validated(table, kind, [Source(path=source, text=text)])


def _validated(
    table: dict[str, Any], kind: type[SettingsType], sources: Sequence[Source]
) -> SettingsType:
    """As `validated`; the first source that has the wrong key is named."""
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        first = error.errors()[0]
        names = [str(part) for part in first["loc"]]
        for source in sources:
            line = _line_of(source.text, names)
            if line:
                place = f"{source.path}, line {line}"
                break
        else:
            place = sources[0].path
        raise SettingsError(f"{place}: {_explain(first, names, kind)}") from error


def _extended(path: Path, heirs: tuple[Path, ...]) -> tuple[dict[str, Any], list[Source]]:
    """A file's values on top of those that it extends, and the files, itself first."""
    own = path.resolve()
    if own in heirs:
        circle = " -> ".join(p.name for p in (*heirs[heirs.index(own) :], own))
        raise SettingsError(f"{path} extends itself: {circle}. Take one `extends` out.")
    table, text = read_table(path)
    sources = [Source(path=str(path), text=text)]
    base = table.pop(EXTENDS, None)
    _resolve_files(table, path.parent)
    if base is None:
        return table, sources
    if not isinstance(base, str) or not base:
        line = _line_of(text, [EXTENDS])
        raise SettingsError(
            f'{path}, line {line}: extends = {base!r}: name one file: extends = "other.toml".'
        )
    below, more = _extended(path.parent / base, (*heirs, own))
    return _merged(below, table), sources + more


def _merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Tables are merged key by key; any other value, a list too, takes the place of the other."""
    merged = dict(below)
    for name, value in above.items():
        inner = merged.get(name)
        both = isinstance(inner, Mapping) and isinstance(value, Mapping)
        merged[name] = _merged(inner, value) if both else value  # type: ignore[arg-type]
    return merged


def _resolve_files(table: dict[str, Any], folder: Path) -> None:
    areas = table.get("areas", ())
    tables = [table.get("fetch"), *(areas if isinstance(areas, list) else ())]
    for one in tables:
        for name in _FILES:
            if isinstance(one, dict) and isinstance(one.get(name), str):
                one[name] = str(folder / one[name])


def _override(table: dict[str, Any], text: str) -> None:
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise SettingsError(f"--set takes NAME=VALUE, for instance fetch.count=3, not {text!r}.")
    *parents, last = name.strip().split(".")
    place: Any = table
    for parent in parents:
        place = _inside(place, parent, text)
    try:
        found = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        found = value
    if isinstance(place, list):
        _inside(place, last, text)  # that there is such an item
        place[int(last)] = found
    else:
        place[last] = found


def _inside(place: Any, name: str, text: str) -> Any:
    """The table or list that a name leads to, made if a table has none of that name."""
    if isinstance(place, list):
        if not name.isdigit() or int(name) >= len(place):
            raise SettingsError(f"--set {text}: {name} is no number from 0 to {len(place) - 1}.")
        return place[int(name)]
    inner = place.setdefault(name, {})
    if not isinstance(inner, dict | list):
        raise SettingsError(f"--set {text}: {name} is a value, not a table.")
    return inner


def _explain(error: Any, names: list[str], kind: type[BaseModel]) -> str:
    name = ".".join(names)
    if error["type"] == "extra_forbidden":
        known = _fields_at(kind, names[:-1])
        near = get_close_matches(names[-1], known, n=1, cutoff=0.5)
        hint = f"Did you mean {near[0]!r}?" if near else f"Known keys: {', '.join(known)}."
        return f"there is no setting {name!r}. {hint}"
    message = error["msg"].removeprefix("Value error, ")
    message = message[0].lower() + message[1:]
    if error["type"] == "missing":
        return f"the setting {name!r} is missing."
    if error["type"] == "value_error" and isinstance(error["input"], Mapping):
        return f"{name}: {message}." if name else f"{message}."
    return f"{name} = {error['input']!r}: {message}."


def _fields_at(kind: type[BaseModel], path: list[str]) -> list[str]:
    for name in path:
        field = kind.model_fields.get(name)
        inner = field.annotation if field else None
        for candidate in (inner, *getattr(inner, "__args__", ())):
            if isinstance(candidate, type) and issubclass(candidate, BaseModel):
                kind = candidate
    return list(kind.model_fields)


def _line_of(text: str, names: Sequence[str]) -> int | None:
    """The line of the key that `names` leads to, or of its table, counted from 1.

    A number in `names` counts the tables of a list: `["areas", "1", "count"]` is the key `count`
    below the second `[[areas]]`.
    """
    table: list[str] = []
    seen: dict[str, int] = {}
    found = None
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip()
        if stripped.startswith("["):
            inner = stripped.partition("]")[0].strip("[").strip()
            table = [part.strip().strip('"') for part in inner.split(".")]
            if stripped.startswith("[["):
                seen[inner] = seen.get(inner, -1) + 1
                table.append(str(seen[inner]))
            if table == list(names):
                return number
        keys = [*table, *(part.strip().strip('"') for part in stripped.split("=")[0].split("."))]
        if "=" in stripped and keys == list(names[: len(keys)]) and found is None:
            found = number
    return found
