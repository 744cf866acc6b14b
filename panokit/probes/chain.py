"""The chain of a probe, from the capture to the library, for people to read."""

from collections.abc import Mapping
from typing import Any

from panokit.capture import Capture, TimePrecision
from panokit.probes.probe import Probe

_TIME_FORMATS = {
    TimePrecision.SECOND: "%Y-%m-%d %H:%M:%S UTC",
    TimePrecision.DAY: "%Y-%m-%d",
    TimePrecision.MONTH: "%Y-%m",
    TimePrecision.YEAR: "%Y",
}
_DIGEST_DIGITS = 10
_MOST_VALUES = 4


def chain_lines(probe: Probe) -> list[tuple[str, str]]:
    """What made a probe, oldest first: (stage, what it did), one line each.

    The first line is the capture, the last the library; digests are cut to ten digits.
    """
    lines = [("capture", _capture_text(probe.capture))]
    for step in probe.provenance.steps:
        words = [f"version {step.version}", *_values(step.values)]
        for label, digest in (
            ("settings", step.settings_digest),
            ("weights", step.weights_digest),
        ):
            if digest:
                words.append(f"{label} {digest[:_DIGEST_DIGITS]}")
        if step.input_digests:
            count = len(step.input_digests)
            more = f" and {count - 1} more" if count > 1 else ""
            words.append(f"from {step.input_digests[0][:_DIGEST_DIGITS]}{more}")
        lines.append((step.stage, ", ".join(words)))
    lines.append(("probe", _probe_text(probe)))
    return lines


def _capture_text(capture: Capture | None) -> str:
    if capture is None:
        return "not known"
    words = [f"{capture.provider} {capture.id}"]
    if capture.place:
        words.append(capture.place)
    if capture.latitude_deg is not None and capture.longitude_deg is not None:
        words.append(f"{capture.latitude_deg:.5f} {capture.longitude_deg:.5f}")
    if capture.time is not None and capture.time_precision is not None:
        words.append(capture.time.strftime(_TIME_FORMATS[capture.time_precision]))
    return ", ".join(words)


def _probe_text(probe: Probe) -> str:
    entry = probe.source and probe.source.sha256
    digest = entry or next(
        (str(e["sha256"]) for n, e in probe.files.items() if n.endswith(".exr")), ""
    )
    where = f"in place at {probe.source.path}" if probe.source else "probe.exr"
    return f"{where}, sha256 {digest[:_DIGEST_DIGITS]}"


def _values(values: Mapping[str, Any]) -> list[str]:
    """The first plain values that a step wrote down."""
    told = [
        f"{name.replace('_', ' ')} {value:g}" if isinstance(value, float) else
        f"{name.replace('_', ' ')} {value}"
        for name, value in values.items()
        if isinstance(value, str | int | float) and not isinstance(value, bool) and value != ""
    ]  # fmt: skip
    return told[:_MOST_VALUES]
