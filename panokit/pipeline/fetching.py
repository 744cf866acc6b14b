"""The fetch stage of a run: progress, ledger, and a record that it is finished."""

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol, TypeVar
from urllib.parse import urlsplit

from panokit.console import Console
from panokit.errors import RecordError, Rejection
from panokit.fetch.result import PERMANENT_REASONS, FetchEvent, FetchResult
from panokit.fetch.settings import VERSION, FetchSettings
from panokit.fetch.where import total_wanted
from panokit.io.attribution import write_attribution
from panokit.io.captures import RECORD, StoredCapture, read_capture
from panokit.io.files import read_json, sha256_of_file, write_json
from panokit.ledger import Ledger
from panokit.pipeline.batch import BatchResult
from panokit.pipeline.settings import QuotaSettings
from panokit.provenance import digest_of
from panokit.records import Receipt, RunFolder, stage_key

if TYPE_CHECKING:
    from panokit.http import Client

SCHEMA = "panokit.fetch/1"
_RECORD = "fetch.json"
_Amount = TypeVar("_Amount", int, float)
_LOOPBACK = ("127.0.0.1", "localhost", "::1")


class Prepare(Protocol):
    """Gets ready to fetch, such as by starting a server: a block within which to fetch."""

    def __call__(
        self, asks: Sequence[FetchSettings]
    ) -> AbstractContextManager[Sequence[FetchSettings]]:
        """What to fetch in the block."""
        ...


def fetch_batch(
    asks: FetchSettings | Sequence[FetchSettings],
    run: RunFolder,
    console: Console,
    *,
    quota: QuotaSettings | None = None,
    prepare: Prepare | None = None,
) -> BatchResult:
    """Fetch what the settings ask for, unless an earlier run finished doing so.

    A folder is always looked at again: it costs nothing, and may hold more by now.

    Args:
        asks: What to fetch: one after the other, within one quota.
        run: Where to.
        console: Says how it goes.
        quota: How much all of them together may spend.
        prepare: Is entered only if there is something to fetch.

    Raises:
        QuotaError: If the quota is used up; what was fetched is kept.
    """
    asks = (asks,) if isinstance(asks, FetchSettings) else tuple(asks)
    key = _key(asks)
    is_folder = any(ask.source == "folder" for ask in asks)
    finished = None if is_folder else _finished(run, key)
    if finished is not None:
        return finished
    with (prepare or nullcontext)(asks) as ready:
        result = _fetch_all(ready, run, console, quota or QuotaSettings())
    if not any(ask.dry_run for ask in asks):
        write_json(
            run.root / _RECORD,
            {
                "schema": SCHEMA,
                "key": key,
                "final": _is_final(result),
                "captures": [stored.capture.key for stored in _all(result)],
                "rejections": [rejection.to_json() for rejection in result.rejections],
            },
        )
    fresh = {stored.capture.key for stored in result.stored}
    return BatchResult(
        stage="fetch",
        receipts=tuple(_receipt(s, fresh=s.capture.key in fresh) for s in _all(result)),
        rejections=result.rejections,
    )


def recorded_captures(run: RunFolder) -> list[str] | None:
    """The keys of the captures that the last fetch stage to reach its end had, None if none did."""
    try:
        record: dict[str, Any] = read_json(run.root / _RECORD)
        return list(record["captures"])
    except (RecordError, KeyError, TypeError):
        return None


def forget_rejections(run: RunFolder) -> None:
    """Let the next fetch ask again for what could not be had."""
    Ledger(run.ledger).clear()
    run.log("forget-rejections")
    (run.root / _RECORD).unlink(missing_ok=True)


def _fetch_all(
    asks: Sequence[FetchSettings], run: RunFolder, console: Console, quota: QuotaSettings
) -> FetchResult:
    """All asks, one after the other; each is held to its own budget and all to the quota."""
    from panokit.http import Budget, Client, Policy

    whole = FetchResult()
    spent_requests, spent_usd = 0, 0.0
    for ask in asks:
        budget = Budget(
            _least(ask.max_requests, quota.max_requests, spent_requests),
            _least(ask.max_cost_usd, quota.max_cost_usd, spent_usd),
        )
        policy = Policy(rate_per_s=ask.requests_per_s, burst=ask.concurrency)
        with Client(policy, budget=budget) as client:
            found = fetch_into(ask, run, console, client=client)
        spent_requests += budget.requests
        spent_usd += budget.cost_usd
        whole = replace(
            whole,
            stored=(*whole.stored, *found.stored),
            existing=(*whole.existing, *found.existing),
            rejections=(*whole.rejections, *found.rejections),
        )
    return whole


def _least(own: _Amount | None, quota: _Amount | None, spent: _Amount) -> _Amount | None:
    limits = [own, None if quota is None else max(quota - spent, 0)]
    return min((limit for limit in limits if limit is not None), default=None)


def fetch_into(
    settings: FetchSettings, run: RunFolder, console: Console, *, client: "Client | None" = None
) -> FetchResult:
    """Fetch into a run folder, with progress, log and ledger."""
    # Here, because a run that is finished asks nobody.
    from panokit.fetch import fetch
    from panokit.fetch.store import stored_captures

    ledger = Ledger(run.ledger)
    known = {r.item for r in ledger.rejections("fetch") if r.reason in PERMANENT_REASONS}
    total = total_wanted(settings)
    with console.stage("fetch", total, unit="panoramas") as tick:
        # In a place another picture is taken for one that cannot be had; named ones are not.
        is_replaced = False

        def report(event: FetchEvent) -> None:
            nonlocal is_replaced
            if event.kind == "place":
                is_replaced = event.wanted > 0
                for _ in range(min(event.done, event.wanted or event.done)):
                    tick()
            if event.kind == "stored" or (event.kind == "rejected" and not is_replaced):
                tick(rejected=event.kind == "rejected")
            if event.kind in ("rejected", "short"):
                console.note(f"fetch: {event.item}: {event.message}")
            if event.verdict is not None and not settings.dry_run:
                ledger.add(event.verdict)  # at once: the run may be killed before its end
                run.log("rejected", **event.verdict.to_json())
            if not settings.dry_run:
                run.log(f"fetch-{event.kind}", item=event.item, message=event.message)

        result = fetch(settings, run.root, client=client, report=report, known=known)
    if not settings.dry_run:
        captures = stored_captures(run.captures).values()
        if captures:
            write_attribution(run.root, (stored.capture for stored in captures))
        run.log("fetched", requests=result.requests, passed_over=dict(result.passed_over))
    return result


def _is_final(result: FetchResult) -> bool:
    """Whether asking again would bring the same; a passing failure is tried again."""
    final = PERMANENT_REASONS | {"no-imagery"}
    return all(rejection.reason in final for rejection in result.rejections)


def _all(result: FetchResult) -> list[StoredCapture]:
    stored = {s.capture.key: s for s in (*result.existing, *result.stored)}
    return [stored[key] for key in sorted(stored)]


def _key(asks: Sequence[FetchSettings]) -> str:
    """What decides which pictures are fetched; a local look-alike may move to another port."""
    asked = [_asked(ask) for ask in asks]
    return stage_key("fetch", VERSION, digest_of(asked[0] if len(asked) == 1 else asked), [])


def _asked(settings: FetchSettings) -> dict[str, Any]:
    pace = {"concurrency", "requests_per_s", "max_requests", "max_cost_usd", "prices"}
    asked = settings.model_dump(mode="json", exclude=pace)
    if urlsplit(settings.endpoint).hostname in _LOOPBACK:
        asked["endpoint"] = "loopback"
    # What the lists say counts, not where they lie.
    for name in ("city_list", "area_file", "picture_list"):
        path = getattr(settings, name)
        asked[name] = path and sha256_of_file(path)
    return asked


def _finished(run: RunFolder, key: str) -> BatchResult | None:
    """The outcome of an earlier run that was asked for the same, if it is all still there."""
    try:
        record: dict[str, Any] = read_json(run.root / _RECORD)
        if record["key"] != key or not record["final"]:
            return None
        captures = [read_capture(run.captures / name) for name in record["captures"]]
    except (RecordError, KeyError, TypeError):
        return None
    if not all((s.folder / name).is_file() for s in captures for name in s.files):
        return None
    return BatchResult(
        stage="fetch",
        receipts=tuple(_receipt(stored, fresh=False) for stored in captures),
        rejections=tuple(Rejection(**rejection) for rejection in record["rejections"]),
    )


def _receipt(stored: StoredCapture, *, fresh: bool) -> Receipt:
    return Receipt(
        item=stored.capture.key,
        stage="fetch",
        path=stored.folder / RECORD,
        key=digest_of([stored.capture.to_json(), dict(stored.files)]),
        fresh=fresh,
    )
