"""What Probe library does, without a browser: filters, one probe in words, selections, exports."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from panokit.app.packing import packed
from panokit.errors import Rejection, SettingsError, UsageError
from panokit.probes import Library, export_probes, select
from panokit.probes.entry import Entry
from panokit.probes.probe import Probe
from panokit.probes.settings import ExportSettings, ProbeFilter, SelectSettings
from panokit.qa.verdicts import Check, Verdict
from panokit.report.entries import light_map
from panokit.report.page import render_viewer
from panokit.report.wording import format_figure, format_limit, words_of

_MAP_PX = 768
_FLAGS = {"yes": True, "no": False}
_FLAG_FIELDS = ("trainable", "derivable", "storable", "has_sun")
_KINDS = {"native": "captured in HDR", "lifted": "made of a photograph", "synthetic": "rendered"}


@dataclass(kw_only=True)
class Shelf:
    """What one tab has before it.

    Attributes:
        library: The folder, or None before one is named.
        typed: What the filters' form holds; field of `ProbeFilter` -> text.
        entries: The probes that pass.
        selected: Those that are ticked, id -> name.
    """

    library: Path | None
    typed: dict[str, str] = field(default_factory=dict)
    entries: tuple[Entry, ...] = ()
    selected: dict[str, str] = field(default_factory=dict)


def filter_of(typed: Mapping[str, str]) -> ProbeFilter:
    """The filter that a form describes: field of `ProbeFilter` -> what was typed or chosen.

    Empty texts let all pass; flags are "yes" and "no"; a box and tags have commas between.

    Raises:
        SettingsError: If something typed is no date, no number, or not possible.
    """
    values: dict[str, Any] = {}
    for name, raw in typed.items():
        text = raw.strip()
        if not text:
            continue
        if name in _FLAG_FIELDS:
            values[name] = _FLAGS[text]
        elif name in ("tags", "bbox"):
            values[name] = tuple(part.strip() for part in text.split(",") if part.strip())
        else:
            values[name] = text
    try:
        return ProbeFilter.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        name = str(first["loc"][0]).replace("_", " ") if first["loc"] else "the filter"
        said = first["msg"].removeprefix("Value error, ")
        raise SettingsError(
            f"{name}: {said[0].lower()}{said[1:]}. Change it, or empty it."
        ) from error


def find(library: Path, typed: Mapping[str, str]) -> tuple[tuple[Entry, ...], int]:
    """The probes that a form lets pass, as `panokit probes list` has them, and how many there are.

    Raises:
        UsageError: If there is no library.
        SettingsError: If the form cannot be understood.
    """
    wanted = filter_of(typed)
    with Library.open(library) as shelves:
        return shelves.list(wanted), len(shelves)


def options_of(library: Path) -> dict[str, list[str]]:
    """What a library has to choose from: categories, licenses, providers, places."""
    with Library.open(library) as shelves:
        entries = shelves.list()
    return {
        name: sorted({getattr(entry, name) for entry in entries} - {""})
        for name in ("category", "license", "provider", "place")
    }


def preview(library: Path, id: str) -> bytes:
    """The picture of a probe, JPEG.

    Raises:
        UsageError: If there is none.
    """
    # An id is hex digits: nothing else is looked for on the disk.
    if not id.isalnum():
        raise UsageError(f"There is no probe {id!r}.")
    path = library / "probes" / id / "preview.jpg"
    try:
        return path.read_bytes()
    except OSError as error:
        raise UsageError(f"The probe {id} has no picture.") from error


def probe_page(library: Path, id: str) -> bytes:
    """The HDR viewer with a probe's map, as a page.

    Raises:
        RecordError: If the file is no longer what was added.
        StorageError: If it is gone.
    """
    with Library.open(library) as shelves:
        probe, envmap = shelves.show(id), shelves.read(id)
    return render_viewer(light_map(envmap, probe.name, width_px=_MAP_PX)).encode()


def probe_of(library: Path, id: str) -> Probe:
    """All that is known of a probe."""
    with Library.open(library) as shelves:
        return shelves.show(id)


def probe_facts(probe: Probe) -> list[tuple[str, str]]:
    """Where a probe is from and what it is, in words."""
    capture, sun = probe.capture, probe.sun
    rows = [
        ("Kind", _KINDS.get(probe.kind, probe.kind)),
        ("Category", probe.category.replace("_", " ")),
        ("Place", capture.place if capture else ""),
        ("Taken", capture.time.strftime("%Y-%m-%d") if capture and capture.time else ""),
        ("Size", f"{probe.width_px} × {probe.width_px // 2} px"),
        ("1.0 stands for", str(probe.anchor)),
        ("Frame", str(probe.frame)),
        ("Tags", ", ".join(probe.tags)),
        ("Id", probe.id),
    ]
    if sun:
        azimuth, elevation = sun.get("azimuth_deg"), sun.get("elevation_deg")
        if azimuth is not None and elevation is not None:
            rows.insert(4, ("Sun", f"azimuth {azimuth:.0f}°, elevation {elevation:.0f}°"))
    return [(label, text) for label, text in rows if text]


def license_facts(probe: Probe) -> list[tuple[str, str]]:
    """What one may do with a probe, and whom to credit."""
    terms, capture = probe.license, probe.capture
    permits = [
        word
        for word, allowed in (
            ("keep copies", terms.store),
            ("make new works", terms.derive),
            ("train models", terms.train),
        )
        if allowed
    ]
    rows = [
        ("License", "not known" if terms.id == "unknown" else terms.id),
        ("Permits", ", ".join(permits) or "nothing that is known"),
        ("Credit", terms.attribution),
        ("Source", capture.source_url if capture else ""),
    ]
    return [(label, text) for label, text in rows if text]


def check_rows(probe: Probe) -> list[tuple[str, str, str, str]]:
    """What QA said: check, figure, limit, and "pass", "fail" or "" where nothing is judged."""
    rows = []
    for one in probe.report.checks:
        judged = str(one.verdict) if one.verdict in (Verdict.PASS, Verdict.FAIL) else ""
        figure = "does not apply" if one.value is None else format_figure(one.value, one.unit)
        rows.append((words_of(one.name), figure, _limits(one), judged))
    return rows


def _limits(check: Check) -> str:
    low, high = (None if v is None else format_limit(v) for v in (check.low, check.high))
    if low is not None and high is not None:
        return f"{low} to {high}"
    return f"at least {low}" if low is not None else f"at most {high}" if high is not None else ""


def provenance_rows(probe: Probe) -> list[tuple[str, str]]:
    """The steps that made a probe, in order."""
    return [
        (f"{number}. {step.stage}", f"version {step.version}" + _model_of(step.values))
        for number, step in enumerate(probe.provenance.steps, start=1)
    ]


def choose(library: Path, typed: Mapping[str, str], settings: SelectSettings) -> tuple[str, ...]:
    """The ids of some probes that are balanced and different, as `panokit probes select` has it.

    Raises:
        UsageError: If the filter lets nothing pass.
    """
    wanted = filter_of(typed)
    with Library.open(library) as shelves:
        criteria = wanted.model_dump(mode="json", exclude_defaults=True)
        return select(shelves.list(wanted), shelves.descriptors(), settings, criteria).ids


def export(
    library: Path,
    ids: Sequence[str],
    settings: ExportSettings,
    out: Path,
    on_done: Callable[[], None],
) -> tuple[Path, str, str, tuple[str, ...]]:
    """Probes for another tool, with their credits, in one archive.

    Returns:
        The archive, its media type, its name, and a sentence for each probe that is not in it.

    Raises:
        UsageError: If none could be exported.
    """
    problems: list[str] = []

    def done(outcome: object) -> None:
        if isinstance(outcome, Rejection):
            problems.append(outcome.message)
        on_done()

    with Library.open(library) as shelves:
        export_probes(shelves, list(ids), out, settings, on_done=done)
    files = sorted(path for path in out.rglob("*") if path.is_file())
    if not files:
        raise UsageError("None of the probes could be exported. " + " ".join(problems[:3]))
    # The credits first: one file alone is never what is sent.
    files.sort(key=lambda path: path.name != "ATTRIBUTION.md")
    content, media_type, name = packed(files, "probes", settings.to)
    return content, media_type, name, tuple(problems)


def _model_of(values: Mapping[str, Any]) -> str:
    model = values.get("model")
    return f", {model}" if isinstance(model, str) else ""
