"""Fetch street panoramas: settings in, captures on disk out, within budgets."""

from collections import Counter
from collections.abc import Callable, Container, Iterator, Sequence
from contextlib import ExitStack, closing
from itertools import islice
from pathlib import Path
from typing import Any

from panokit.errors import Rejection
from panokit.fetch.places import Place
from panokit.fetch.plan import plan_of
from panokit.fetch.prices import price_of
from panokit.fetch.provider import Found, position_of
from panokit.fetch.result import EventKind, FetchEvent, FetchPlan, FetchResult
from panokit.fetch.run_lock import only_run, remove_unfinished
from panokit.fetch.selection import Selection
from panokit.fetch.settings import FetchSettings
from panokit.fetch.sources import SOURCES
from panokit.fetch.store import stored_captures
from panokit.fetch.transfer import Transfer
from panokit.fetch.where import areas_of, keys_of, wanted_of, without_pictures
from panokit.http import Budget, Client, Policy
from panokit.io.captures import StoredCapture

Report = Callable[[FetchEvent], None]


def fetch(
    settings: FetchSettings,
    out: Path,
    *,
    client: Client | None = None,
    report: Report | None = None,
    known: Container[str] = (),
) -> FetchResult:
    """Fetch the panoramas that the settings ask for and that are not on disk yet.

    Each becomes a folder `out/captures/KEY` whose record is written last. A second run goes
    on where the first one ended, however that was.

    Args:
        settings: What, from where, how much.
        out: The run folder.
        client: Sends the requests, within its own policy and budget; it is stopped if the run
            fails. By default one is made from the settings.
        report: Is told of each panorama as it happens.
        known: Keys of panoramas (`Capture.key`) known not to be worth asking for.

    Returns:
        What was fetched, what was there, and what could not be had. With `dry_run` nothing
        is fetched, and `plan` says what it would take.

    Raises:
        PlaceError: If a place is not known.
        LicenseError: If the source's terms were not accepted.
        AuthError: If a key is missing or refused.
        QuotaError: If a quota or budget is used up; what was fetched is kept.
        NetworkError: If the source cannot be reached.
        StorageError: If the disk is full or the folder cannot be written.
    """
    places = areas_of(settings)
    with ExitStack() as stack:
        client = client or stack.enter_context(_client(settings))
        fetching = _Fetching(settings, out, client, report, known)
        if not settings.dry_run:
            stack.enter_context(only_run(Path(out)))
            remove_unfinished(Path(out))
        return fetching.run(places)


class _Fetching:
    """One call of `fetch`, and what it has collected so far."""

    def __init__(
        self,
        settings: FetchSettings,
        out: Path,
        client: Client,
        report: Report | None,
        known: Container[str],
    ) -> None:
        self._settings = settings
        self._client = client
        self._report = report
        self._known = known
        self._price = price_of(settings.source, settings.prices)
        captures = Path(out) / "captures"
        self._on_disk = stored_captures(captures)
        self._named = [key for key in keys_of(settings) if key in self._on_disk]
        missing = without_pictures(settings, lambda key: key in self._on_disk or key in known)
        self._provider = SOURCES[settings.source](missing, client)
        self._transfer = Transfer(self._provider, client, captures, settings)
        self._planned: list[Found] = []
        self._stored: list[StoredCapture] = []
        self._existing: list[StoredCapture] = []
        self._rejections: list[Rejection] = []
        self._short: dict[str, tuple[int, int]] = {}
        self._passed_over: Counter[str] = Counter()

    def run(self, places: Sequence[Place | None]) -> FetchResult:
        """Bring every place to its wanted count, as far as it goes."""
        for place in places:
            self._run_place(place)
        return FetchResult(
            stored=tuple(self._stored),
            existing=tuple(self._existing),
            rejections=tuple(self._rejections),
            short=dict(self._short),
            passed_over=dict(self._passed_over),
            requests=self._client.budget.requests,
            plan=self._plan() if self._settings.dry_run else None,
        )

    def _run_place(self, place: Place | None) -> None:
        existing = self._already_there(place)
        wanted = wanted_of(place, self._settings)
        missing = None if wanted is None else max(wanted - len(existing), 0)
        name = "the pictures named" if place is None else place.name
        self._tell("place", name, done=len(existing), wanted=wanted or 0)
        selection = Selection(self._settings, place, self._on_disk, self._known)
        fresh = 0
        if missing != 0:
            candidates = _filed(selection.candidates(self._provider), place)
            bring = self._list if self._settings.dry_run else self._fetch
            fresh = bring(candidates, missing)
        self._existing += [*existing, *(selection.met_again if place is None else ())]
        self._passed_over.update(selection.passed_over)
        if place is not None and fresh < (missing or 0):
            have = len(existing) + fresh
            self._fall_short(place, have, wanted or 0, selection.passed_over)

    def _fetch(self, candidates: Iterator[Found | Rejection], missing: int | None) -> int:
        """Fetch until none is missing; gives how many were stored."""
        before = len(self._stored)
        with closing(self._transfer.outcomes(candidates, missing)) as outcomes:
            for outcome in outcomes:
                if isinstance(outcome, Rejection):
                    self._reject(outcome)
                    continue
                self._stored.append(outcome)
                key = outcome.capture.key
                self._on_disk[key] = outcome
                self._tell("stored", key, done=len(self._stored) - before, wanted=missing or 0)
        return len(self._stored) - before

    def _list(self, candidates: Iterator[Found | Rejection], missing: int | None) -> int:
        """Find what fetching would take, without doing it; gives how many pictures."""
        listed = list(islice(self._passing_rejections(candidates), missing))
        self._planned += listed
        return len(listed)

    def _passing_rejections(self, candidates: Iterator[Found | Rejection]) -> Iterator[Found]:
        for one in candidates:
            if isinstance(one, Rejection):
                self._reject(one)
            else:
                yield one

    def _plan(self) -> FetchPlan:
        return plan_of(self._planned, self._price)

    def _reject(self, rejection: Rejection) -> None:
        self._rejections.append(rejection)
        self._tell("rejected", rejection.item, rejection.message, rejection=rejection)

    def _fall_short(self, place: Place, have: int, wanted: int, passed_over: Counter[str]) -> None:
        """Say that a place has fewer pictures than wanted; without any it is rejected."""
        reasons = ", ".join(f"{count} {reason}" for reason, count in passed_over.most_common())
        shape = "radius" if place.is_disc else "area" if place.polygons else "box"
        remedies = [f"a larger {'distance to snap' if place.points else shape}"]
        remedies += ["a smaller minimum distance"] if passed_over["too-close"] else []
        remedies += ["other dates"] if passed_over["out-of-dates"] else []
        message = (
            f"{have or 'none'} of {wanted} panoramas found"
            f"{f' (passed over: {reasons})' if reasons else ''}. "
            f"Try {', '.join(remedies)} or another source."
        )
        self._short[place.name] = have, wanted
        self._tell("short", place.name, message, done=have)
        if have == 0:
            self._rejections.append(
                Rejection(item=place.name, stage="fetch", reason="no-imagery", message=message)
            )

    def _already_there(self, place: Place | None) -> list[StoredCapture]:
        """The source's captures on disk that are of this place, whatever it was called.

        Without a place, those that are asked for by id.
        """
        if place is None:
            return [self._on_disk[key] for key in self._named]
        there = []
        for stored in self._on_disk.values():
            capture = stored.capture
            point = position_of(capture)
            is_inside = point is not None and place.contains(point)
            if capture.provider == self._settings.source and (
                is_inside or capture.place == place.name
            ):
                there.append(stored)
        return there

    def _tell(self, kind: EventKind, item: str, message: str = "", **more: Any) -> None:
        if self._report is not None:
            self._report(FetchEvent(kind=kind, item=item, message=message, **more))


def _filed(
    candidates: Iterator[Found | Rejection], place: Place | None
) -> Iterator[Found | Rejection]:
    """The candidates, filed under the place they were found for."""
    for one in candidates:
        if place is None or isinstance(one, Rejection):
            yield one
        else:
            yield one.filed_under(place.name)


def _client(settings: FetchSettings) -> Client:
    """A client as patient, fast and thrifty as the settings say."""
    return Client(
        Policy(rate_per_s=settings.requests_per_s, burst=settings.concurrency),
        budget=Budget(settings.max_requests, settings.max_cost_usd),
    )
