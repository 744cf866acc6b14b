"""Figures, limits and verdicts of one map."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from panokit.errors import RecordError


class Verdict(StrEnum):
    """What a check says."""

    PASS = "pass"
    FAIL = "fail"
    NOT_APPLICABLE = "not-applicable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One figure of a map, held against its limits.

    Attributes:
        name: A short stable name, for settings and counting ("wrap-seam").
        value: The figure, or None where it cannot be had.
        unit: Of value and limits, "" for a plain number.
        low: The least value that passes, or None.
        high: The largest value that passes, or None.
        meaning: What the figure says, in one plain sentence.
        family: What it is about: "geometry", "radiometry", "content", "sun" or "plausibility".
        note: Why there is no figure, or what this one points to; it has no part in the verdict.
    """

    name: str
    value: float | None
    unit: str
    low: float | None = None
    high: float | None = None
    meaning: str = ""
    family: str = ""
    note: str = field(default="", compare=False)

    @property
    def verdict(self) -> Verdict:
        """Always what value and limits give; never stored apart from them."""
        if self.value is None:
            return Verdict.NOT_APPLICABLE
        # Written so that a NaN, which compares false with everything, fails.
        high_enough = self.low is None or self.value >= self.low
        low_enough = self.high is None or self.value <= self.high
        return Verdict.PASS if high_enough and low_enough else Verdict.FAIL

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "name": self.name,
            "family": self.family,
            "value": self.value,
            "unit": self.unit,
            "low": self.low,
            "high": self.high,
            "verdict": str(self.verdict),
            "note": self.note,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """All checks of one map.

    `panokit.qa.judge(report.values, settings)` gives the report again, from the figures alone.

    Attributes:
        checks: In the order they are shown.
        settings_digest: Of the settings with the limits.
    """

    checks: tuple[Check, ...]
    settings_digest: str

    @property
    def verdict(self) -> Verdict:
        """FAIL if any check fails, else PASS."""
        return Verdict.FAIL if self.failed else Verdict.PASS

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that fail."""
        return tuple(check for check in self.checks if check.verdict is Verdict.FAIL)

    @property
    def values(self) -> dict[str, float | None]:
        """Name -> figure."""
        return {check.name: check.value for check in self.checks}

    @property
    def notes(self) -> dict[str, str]:
        """Name -> note, of the checks that have one."""
        return {check.name: check.note for check in self.checks if check.note}

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "verdict": str(self.verdict),
            "settings_digest": self.settings_digest,
            "checks": [check.to_json() for check in self.checks],
        }

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> "Report":
        """The report that `to_json` wrote; verdicts follow from figures and limits.

        Raises:
            RecordError: If it is not one.
        """
        try:
            checks = tuple(
                Check(**{k: v for k, v in check.items() if k != "verdict"})
                for check in record["checks"]
            )
            return cls(checks=checks, settings_digest=record["settings_digest"])
        except (KeyError, TypeError, AttributeError) as error:
            raise RecordError(
                f"This is not a QA report ({error}). Run panokit qa again.",
                reason="bad-qa-report",
            ) from error
