"""The sheet of credits that goes wherever pictures, or maps made from them, go."""

import csv
import io
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

from panokit.capture import Capture, License
from panokit.io.files import write_bytes

SHEET, TABLE = "ATTRIBUTION.md", "ATTRIBUTION.csv"
_COLUMNS = ("key", "provider", "id", "license", "license_url", "attribution", "source_url",
            "store", "derive", "train", "share_alike")  # fmt: skip


def write_attribution(folder: Path, captures: Iterable[Capture]) -> None:
    """Write the credits of pictures into a folder: a sheet to read, and a table for programs.

    Args:
        folder: Gets ATTRIBUTION.md and ATTRIBUTION.csv; equal captures give equal files.
        captures: The pictures; one that comes twice is credited once.

    Raises:
        StorageError: If the folder cannot be written.
    """
    unique = sorted({capture.key: capture for capture in captures}.items())
    pictures = [capture for _, capture in unique]
    write_bytes(folder / SHEET, attribution_text(pictures).encode())
    write_bytes(folder / TABLE, _table(pictures).encode())


def attribution_text(captures: Iterable[Capture]) -> str:
    """The credits as Markdown: a part for each license, a line for each author."""
    by_license: dict[str, list[Capture]] = defaultdict(list)
    for capture in captures:
        by_license[capture.license.id].append(capture)
    lines = ["# Credits", ""]
    lines += [
        "Show these credits wherever the pictures, or what was made of them, are shown.",
        "",
    ]
    for name, group in sorted(by_license.items()):
        terms = group[0].license
        lines += [
            f"## {name}",
            "",
            f"{_permits(terms)}{f' <{terms.url}>' if terms.url else ''}",
            "",
        ]
        credited: dict[str, list[str]] = defaultdict(list)
        for capture in group:
            credited[capture.license.attribution or "no author named"].append(capture.key)
        for author, keys in sorted(credited.items()):
            lines.append(f"- {_escaped(author)}: {', '.join(keys)}")
        lines.append("")
    return "\n".join(lines)


def _permits(terms: License) -> str:
    """What a license permits, in one sentence."""
    acts = [("kept", terms.store), ("changed", terms.derive), ("used for training", terms.train)]
    allowed = [act for act, is_allowed in acts if is_allowed]
    denied = [act for act, is_allowed in acts if not is_allowed]
    parts = [f"may be {_and(allowed)}"] if allowed else []
    parts += [f"may not be {_and(denied, 'or')}"] if denied else []
    alike = "; what is made of them carries the same license" if terms.share_alike else ""
    return f"These pictures {', and '.join(parts)}{alike}."


def _and(words: list[str], last: str = "and") -> str:
    return f" {last} ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _escaped(text: str) -> str:
    return " ".join(text.split()).replace("*", "\\*").replace("_", "\\_")


def _table(captures: Iterable[Capture]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for capture in captures:
        terms = capture.license
        writer.writerow(
            [
                *(capture.key, capture.provider, capture.id, terms.id, terms.url),
                *(terms.attribution, capture.source_url),
                *("yes" if flag else "no" for flag in (
                    terms.store, terms.derive, terms.train, terms.share_alike)),
            ]
        )  # fmt: skip
    return text.getvalue()
