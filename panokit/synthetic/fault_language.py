"""Faults in words, for the command line: "429 10% delay=0.5, slow 1%, session-uses=300".

A clause is a trouble or a switch; commas part them. A trouble is a kind, how often it comes
("10%", "0.1", or "x3" for the first three requests) and options; a switch is a name, with
`=value` where it takes one.
"""

from collections.abc import Callable
from typing import Any, get_args

from panokit.errors import UsageError
from panokit.synthetic.faults import Faults, Trouble, TroubleKind

# "429" alone means all three ways to state the delay, for that is what a client must stand.
_KINDS = {kind: kind for kind in get_args(TroubleKind)} | {"429": "429-any", "429-seconds": "429"}


def _cells(text: str) -> frozenset[tuple[int, int, int]]:
    cells = []
    for cell in text.split("+"):
        zoom, column, row = (int(part) for part in cell.split("/"))
        cells.append((zoom, column, row))
    return frozenset(cells)


def _one_of(*names: str) -> Callable[[str], str]:
    def parse(text: str) -> str:
        if text not in names:
            raise ValueError(text)
        return text

    return parse


# Option of a trouble -> field and how to read it.
_OPTIONS: dict[str, tuple[str, Callable[[str], Any]]] = {
    "at": ("path", str),
    "delay": ("retry_after_s", float),
    "seconds": ("slow_s", float),
    "first": ("attempts", int),
}
# Switch -> field and how to read its value; None for those without one.
_SWITCHES: dict[str, tuple[str, Callable[[str], Any] | None]] = {
    "seed": ("seed", int),
    "api-disabled": ("api_disabled", None),
    "session-lifetime": ("session_lifetime_s", float),
    "session-uses": ("session_uses", int),
    "out-of-range": ("out_of_range", _one_of("black", "not-found")),
    "edge-tiles": ("edge_tiles", _one_of("padded", "cropped")),
    "tile-body": ("tile_body_px", int),
    "missing-tiles": ("missing_tiles", _cells),
    "black-tiles": ("black_tiles", _cells),
    "retired": ("retired", lambda text: frozenset(text.split("+"))),
    "sparse-metadata": ("sparse_metadata", None),
    "quota-per-minute": ("quota_per_minute", int),
    "quota-per-day": ("quota_per_day", int),
    "signature-required": ("signature_required", None),
    "url-lifetime": ("url_lifetime_s", float),
    "dense-box": ("dense_box", int),
    "thinned": ("thinned", None),
}


def parse_faults(text: str) -> Faults:
    """The faults that a text describes; none for an empty one.

    Raises:
        UsageError: If a word is not understood; the message lists those that are.
    """
    troubles: list[Trouble] = []
    switches: dict[str, Any] = {}
    for clause in filter(None, (part.strip() for part in text.split(","))):
        first, *rest = clause.split()
        name = first.partition("=")[0]
        if first in _KINDS:
            troubles.append(_trouble(clause, _KINDS[first], rest))
        elif name in _SWITCHES and not rest:
            switches |= _switch(clause)
        else:
            raise UsageError(
                f"{clause!r} is no fault. Troubles are {', '.join(sorted(_KINDS))}, as in "
                f"'500 5%'; switches are {', '.join(_SWITCHES)}, as in 'session-uses=300'."
            )
    if sum(trouble.rate or 0.0 for trouble in troubles if not trouble.path) > 1:
        raise UsageError("The rates of the faults are more than 100% together.")
    return Faults(troubles=tuple(troubles), **switches)


def _trouble(clause: str, kind: str, words: list[str]) -> Trouble:
    values: dict[str, Any] = {}
    for word in words:
        name, sign, value = word.partition("=")
        try:
            if sign:
                field, read = _OPTIONS[name]
                values[field] = read(value)
            elif word.startswith("x"):
                values["times"] = int(word[1:])
            else:
                values["rate"] = float(word.rstrip("%")) / (100 if word.endswith("%") else 1)
        except (KeyError, ValueError):
            raise UsageError(
                f"{word!r} in {clause!r} is not understood. Write a rate (10%), a number of times "
                f"(x3), or one of {', '.join(f'{option}=...' for option in _OPTIONS)}."
            ) from None
    return Trouble(kind=kind, **values)  # type: ignore[arg-type]


def _switch(clause: str) -> dict[str, Any]:
    name, sign, value = clause.partition("=")
    field, read = _SWITCHES[name]
    if (read is None) == bool(sign):
        needs = "takes no value" if read is None else f"needs a value, as in {name}=..."
        raise UsageError(f"The fault {name} {needs}.")
    try:
        return {field: True if read is None else read(value)}
    except ValueError:
        raise UsageError(f"{value!r} is no value for the fault {name}.") from None
