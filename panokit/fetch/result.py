"""What fetching did, or would do."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from panokit.errors import Rejection
from panokit.fetch.plan import FetchPlan
from panokit.io.captures import StoredCapture

EventKind = Literal["place", "stored", "rejected", "short"]

# Verdicts about a picture that stay true; the others may pass, and are tried again.
PERMANENT_REASONS = frozenset({"retired", "not-360"})


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchEvent:
    """Something that happened while fetching, for progress displays and logs.

    Attributes:
        kind: "stored" and "rejected" are about one panorama, "place" and "short" about a place.
        item: The panorama's key, or the place's name.
        message: One line for a person.
        done: Panoramas of this place that are there now.
        wanted: Panoramas of this place that were asked for, 0 for all there are.
        rejection: Of a panorama that was rejected.
    """

    kind: EventKind
    item: str
    message: str = ""
    done: int = 0
    wanted: int = 0
    rejection: Rejection | None = None

    @property
    def verdict(self) -> Rejection | None:
        """The rejection, if it is one that will not change."""
        one = self.rejection
        return one if one is not None and one.reason in PERMANENT_REASONS else None


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchResult:
    """What fetching brought.

    Attributes:
        stored: Fetched now, in the order of the sample points.
        existing: Complete on disk before, of the places asked for.
        rejections: Panoramas that could not be had, and places without any.
        short: Place -> (found, wanted), of the places that have fewer panoramas than wanted.
        passed_over: Reason -> how many pictures were seen but not wanted ("too-close", ...).
        requests: Sent, retries and searches included.
        plan: What a dry run found out; None after a real one.
    """

    stored: tuple[StoredCapture, ...] = ()
    existing: tuple[StoredCapture, ...] = ()
    rejections: tuple[Rejection, ...] = ()
    short: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    passed_over: Mapping[str, int] = field(default_factory=dict)
    requests: int = 0
    plan: FetchPlan | None = None

    @property
    def verdicts(self) -> tuple[Rejection, ...]:
        """The rejections that will not change: a ledger of them saves asking again."""
        return tuple(one for one in self.rejections if one.reason in PERMANENT_REASONS)
