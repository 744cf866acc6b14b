"""The table of an evaluation, as JSON and as Markdown.

A method that was trained on some of the probes is shown on the others only; one that was
trained on all of them is shown on all and marked "seen": its figures prove nothing.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from panokit.evaluate.expansion import EvaluationResult
from panokit.evaluate.figures import LINES, Line, by_category, summarize_rows
from panokit.evaluate.pairs import compare_pairs, pairs_table
from panokit.evaluate.predictors import PER_FOLD
from panokit.evaluate.scoring import Row
from panokit.io.files import write_bytes, write_json

SCHEMA = "panokit.evaluation.expansion/1"
PROTOCOL = "panokit-expansion-1"
# What the tables by category show.
CATEGORY_LINES = (
    "irradiance_median",
    "light_vector_mean",
    "ball_median",
    "energy_median",
    "pu21_crf_mean",
)

_MARKS = {"seen": " (seen)", "unknown": " (unknown)", "unseen": ""}


def write_evaluation(result: EvaluationResult, out: Path) -> tuple[Path, Path]:
    """Write expansion.json and expansion.md into a folder; returns both paths.

    For a method with a model for each fold, metrics-NAME.json beside them is what its release
    carries as metrics.json.
    """
    out.mkdir(parents=True, exist_ok=True)
    record = evaluation_record(result)
    paths = out / "expansion.json", out / "expansion.md"
    write_json(paths[0], record)
    write_bytes(paths[1], evaluation_markdown(record).encode())
    for method in result.judged:
        if method.endswith(PER_FOLD):
            name = method.removesuffix(PER_FOLD)
            write_json(out / f"metrics-{name}.json", model_metrics(record, method))
    return paths


def evaluation_record(result: EvaluationResult) -> dict[str, Any]:
    """Everything, for `json.dump`."""
    cameras: dict[str, Any] = {}
    pairs: dict[str, Any] = {}
    fresh = [row for row in result.rows if row.seen is not True]
    for camera in result.settings.cameras:
        columns = {}
        for method in result.methods:
            rows = [r for r in result.rows if (r.method, r.camera) == (method, camera)]
            shown, status = _shown([row for row in rows if not row.failed])
            columns[method] = {
                "status": status,
                "pictures": len(shown),
                "failed": sum(bool(row.failed) for row in rows),
                "figures": summarize_rows(shown),
                "categories": by_category(shown, CATEGORY_LINES),
            }
        cameras[camera] = columns
        pairs[camera] = {
            method: {
                other: compare_pairs([r for r in fresh if r.camera == camera], method, other)
                for other in result.methods
                if other != method
            }
            for method in result.judged
        }
    return {
        "schema": SCHEMA,
        "protocol": PROTOCOL,
        "settings": result.settings.model_dump(mode="json"),
        "methods": list(result.methods),
        "judged": list(result.judged),
        "cameras": cameras,
        "pairs": pairs,
        "area_rules": {
            **{str(fold): list(rule) for fold, rule in sorted(result.rules.items())},
            "all": list(result.rule_of_all),
        },
        "unusable": result.unusable,
        "rows": [row.to_json() for row in result.rows],
    }


def model_metrics(record: dict[str, Any], method: str) -> dict[str, Any]:
    """What a released model carries as metrics.json: the table, and its own scores.

    Args:
        record: Of the evaluation.
        method: The model's column.
    """
    others = [name for name in record["methods"] if name not in record["judged"]]
    kept = [*others, method]
    return {
        **{name: record[name] for name in ("schema", "protocol", "settings", "area_rules")},
        "model": method,
        "methods": kept,
        "cameras": {
            camera: {name: columns[name] for name in kept}
            for camera, columns in record["cameras"].items()
        },
        "pairs": {
            camera: {other: pairs[method][other] for other in others}
            for camera, pairs in record["pairs"].items()
        },
        "rows": [row for row in record["rows"] if row["method"] == method],
    }


def evaluation_markdown(record: dict[str, Any]) -> str:
    """The tables of a record as Markdown; bold reaches the goal."""
    settings = record["settings"]
    part = "all folds" if settings["fold"] is None else f"fold {settings['fold']}"
    text = [
        "# Expansion: light recovered from clipped panoramas",
        "",
        f"Protocol {record['protocol']}, {part} of {settings['folds']}. In parentheses 90 % "
        "bootstrap intervals over probes; bold reaches the goal.",
        *_notes(record),
    ]
    for camera, found in record["cameras"].items():
        # A record that was read back from JSON has its columns by name.
        columns = {name: found[name] for name in record["methods"]}
        text += ["", f"## Camera {camera}", "", *_main_table(camera, columns)]
        for key in CATEGORY_LINES:
            line = next(line for line in LINES if line.key == key)
            text += ["", f"### {line.title}, by category, camera {camera}", ""]
            text += _category_table(line, columns)
        for method, pairs in record["pairs"][camera].items():
            text += [
                "",
                f"### {method} against the others, picture by picture, camera {camera}",
                "",
            ]
            text += pairs_table({name: pairs[name] for name in record["methods"] if name in pairs})
    if record["unusable"]:
        text += ["", "## Left out", ""]
        text += [f"- {name}: {why}" for name, why in sorted(record["unusable"].items())]
    return "\n".join(text) + "\n"


def _shown(rows: Sequence[Row]) -> tuple[list[Row], str]:
    """The rows that a method is judged by, and what is known of them."""
    fresh = [row for row in rows if row.seen is not True]
    if rows and not fresh:
        return list(rows), "seen"
    return fresh, "unknown" if any(row.seen is None for row in fresh) else "unseen"


def _notes(record: dict[str, Any]) -> list[str]:
    columns = next(iter(record["cameras"].values()))
    status = {name: column["status"] for name, column in columns.items()}
    notes = []
    for kind, text in (
        ("seen", "was trained on these very probes: its figures prove nothing"),
        ("unknown", "does not say what it was trained on"),
    ):
        names = [name for name, found in status.items() if found == kind]
        notes += ["", f"{', '.join(names)} {text}."] if names else []
    counts = {column["pictures"] for column in columns.values()}
    if len(counts) > 1:
        notes += [
            "",
            "The columns stand on different probes, since some methods were trained on a part "
            "of them or have no model for some folds; choose one fold to compare on the same.",
        ]
    failed = {name: column["failed"] for name, column in columns.items() if column["failed"]}
    if failed:
        said = ", ".join(f"{name} on {count}" for name, count in failed.items())
        notes += ["", f"Failed and left out: {said} pictures."]
    return notes


def _main_table(camera: str, columns: dict[str, Any]) -> list[str]:
    names = [f"{name}{_MARKS[column['status']]}" for name, column in columns.items()]
    table = [f"| figure | goal | {' | '.join(names)} |", "|---" * (len(names) + 2) + "|"]
    counts = [str(column["pictures"]) for column in columns.values()]
    table.append(f"| pictures | | {' | '.join(counts)} |")
    strong = [column["figures"]["strong_energy_median"] for column in columns.values()]
    counts = [str(figure["n"] if figure else 0) for figure in strong]
    table.append(f"| of them with a strong source | | {' | '.join(counts)} |")
    for line in LINES:
        figures = [column["figures"][line.key] for column in columns.values()]
        if any(figure is not None for figure in figures):
            cells = [_cell(line, figure, camera) for figure in figures]
            table.append(f"| {line.title} | {_goal_text(line, camera)} | {' | '.join(cells)} |")
    return table


def _cell(line: Line, figure: dict[str, float] | None, camera: str) -> str:
    if figure is None:
        return ""
    text = _interval(line, figure)
    if line.reaches(figure["value"], camera):
        value, _, interval = text.partition(" ")
        text = f"**{value}** {interval}"
    return text


def _interval(line: Line, figure: dict[str, float] | None) -> str:
    if figure is None:
        return ""
    value, low, high = (f"{figure[name]:.{line.digits}f}" for name in ("value", "low", "high"))
    return f"{value} ({low}–{high})"


def _goal_text(line: Line, camera: str) -> str:
    goal = line.goal_of(camera)
    if goal is None:
        return ""
    low, high = goal
    if low is None:
        return f"≤ {high:g}"
    return f"≥ {low:g}" if high is None else f"{low:g}–{high:g}"


def _category_table(line: Line, columns: dict[str, Any]) -> list[str]:
    names = [f"{name}{_MARKS[column['status']]}" for name, column in columns.items()]
    categories = sorted({c for column in columns.values() for c in column["categories"]})
    table = [f"| category | n | {' | '.join(names)} |", "|---" * (len(names) + 2) + "|"]
    for category in categories:
        found = [column["categories"].get(category) for column in columns.values()]
        n = max(entry["n"] for entry in found if entry)
        cells = [_interval(line, entry[line.key]) if entry else "" for entry in found]
        table.append(f"| {category} | {n} | {' | '.join(cells)} |")
    return table
