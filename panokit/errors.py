"""Every error panokit raises on purpose, and the form that a bad item takes in a batch.

    PanokitError                 exit code 70   something panokit did not foresee
    +-- UsageError                2   a wrong argument; nothing was done
    |   +-- SettingsError         2   an unknown or contradictory setting
    |   +-- PlaceError            2   a city or area that is not known
    +-- ItemError                 3   one picture, map or record is not usable
    |   +-- ImageError            3   pixels that are not what they should be
    |   +-- RecordError           3   a record that is missing or damaged
    +-- StorageError              4   a folder or disk that cannot be read or written
    +-- MissingExtraError         5   an optional package is not installed
    +-- MissingLibraryError       5   a library of the system is not installed
    +-- ModelError                6   a released model is missing or not what its card says
    +-- NetworkError              7   the network or a server, after all retries
    |   +-- AuthError             8   a key that is missing or refused
    |   +-- QuotaError            9   a quota or budget that is used up
    |   +-- OutageError           7   a whole service that is down or refuses to work
    +-- LicenseError             10   terms that forbid what was asked
    +-- RejectionsError           1   more items were rejected than the run allows

A bad *call* is an exception. A bad *item* is data: in a batch, an `ItemError` about one
panorama becomes a `Rejection`, the run goes on and reports it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar


class PanokitError(Exception):
    """The base of every error that panokit raises on purpose.

    The message says what is wrong with what value, and then what to do about it.
    """

    exit_code: ClassVar[int] = 70


class UsageError(PanokitError, ValueError):
    """A wrong argument: nothing was done."""

    exit_code = 2


class SettingsError(UsageError):
    """An unknown, missing or contradictory setting."""


class PlaceError(UsageError):
    """A city or area that is not known."""


class ItemError(PanokitError):
    """One picture, map or record that cannot be used.

    Args:
        message: What is wrong and what to do about it, in one line.
        reason: A short stable code, for counting ("truncated", "not-equirectangular").
        values: The figures behind the verdict.
    """

    exit_code = 3

    def __init__(
        self, message: str, *, reason: str = "unusable", values: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(message)
        self.reason = reason
        self.values = dict(values or {})


class ImageError(ItemError):
    """Pixels that are not what they should be."""


class RecordError(ItemError):
    """A record that is missing, damaged or of another version."""


class StorageError(PanokitError, OSError):
    """A folder or disk that cannot be read or written."""

    exit_code = 4


class MissingExtraError(PanokitError, ImportError):
    """An optional package is not installed; the message names the extra that brings it."""

    exit_code = 5

    def __init__(self, package: str, extra: str, purpose: str) -> None:
        super().__init__(
            f"{purpose} needs the package {package!r}, which is not installed. "
            f'Install it with: pip install "panokit[{extra}]"'
        )


class MissingLibraryError(PanokitError, ImportError):
    """A library of the system is not installed; the message names the package that brings it."""

    exit_code = 5


class ModelError(PanokitError):
    """A released model is missing, or its file is not what its card says."""

    exit_code = 6


class NetworkError(PanokitError):
    """The network or a server failed, after all retries."""

    exit_code = 7


class AuthError(NetworkError):
    """A key is missing or was refused."""

    exit_code = 8


class QuotaError(NetworkError):
    """A quota or a budget is used up; a later run goes on from here."""

    exit_code = 9


class OutageError(NetworkError):
    """A whole service is down, or answers with web pages: asking for something else is vain."""


class LicenseError(PanokitError):
    """The terms of a source forbid what was asked."""

    exit_code = 10


class RejectionsError(PanokitError):
    """The run is finished, but more items were rejected than its settings allow."""

    exit_code = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Rejection:
    """One item that a stage could not use: an outcome of a batch, not an exception.

    Attributes:
        item: The id of the item, as the run knows it.
        stage: The stage that rejected it.
        reason: A short stable code, for counting.
        message: One line for a person.
        values: The figures behind the verdict.
    """

    item: str
    stage: str
    reason: str
    message: str
    values: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def from_error(cls, item: str, stage: str, error: ItemError) -> "Rejection":
        """The rejection that says of `item` what `error` said."""
        return cls(
            item=item,
            stage=stage,
            reason=error.reason,
            message=str(error),
            values=dict(error.values),
        )

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {
            "item": self.item,
            "stage": self.stage,
            "reason": self.reason,
            "message": self.message,
            "values": dict(self.values),
        }
