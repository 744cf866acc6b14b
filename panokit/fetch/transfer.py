"""Many pictures on their way to the disk at once, and their outcomes in a fixed order."""

from collections import deque
from collections.abc import Generator, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from panokit.errors import (
    AuthError,
    ItemError,
    NetworkError,
    OutageError,
    QuotaError,
    Rejection,
)
from panokit.fetch.provider import Found, Provider
from panokit.fetch.settings import FetchSettings
from panokit.fetch.store import Download
from panokit.http import Client
from panokit.io.captures import StoredCapture

# Not fewer: a handful of broken pictures must not keep every run from the ones behind them.
_NETWORK_FAILURES_IN_A_ROW = 8


class Transfer:
    """Fetches pictures until as many are stored as wanted, or none is left.

    A few are under way at once; they are finished in the order in which they were begun, so
    that equal runs have equal outcomes.

    Args:
        provider: Reads the files.
        client: Whose budget is asked before a picture is begun, and which is stopped when
            the transfer fails.
        captures: The folder of capture folders.
        settings: Concurrency, and whether tiles may be missing.
    """

    def __init__(
        self, provider: Provider, client: Client, captures: Path, settings: FetchSettings
    ) -> None:
        self._provider = provider
        self._client = client
        self._captures = captures
        self._settings = settings
        self._under_way: deque[Download] = deque()
        self._network_failures = 0

    def outcomes(
        self, candidates: Iterator[Found | Rejection], wanted: int | None
    ) -> Generator[StoredCapture | Rejection, None, None]:
        """What becomes of the candidates, until `wanted` are stored (None: all of them).

        Raises:
            QuotaError: If the budget ends; pictures under way are finished before.
            PanokitError: If the run cannot go on. Whatever is raised, and if the caller
                stops asking, no half-fetched picture stays on disk.
        """
        stored = 0
        out_of_budget: QuotaError | None = None
        workers = self._settings.concurrency
        with (
            ThreadPoolExecutor(workers, "panokit-fetch-disk") as disk,
            ThreadPoolExecutor(workers, "panokit-fetch") as network,
        ):
            try:
                while True:
                    if out_of_budget is None:
                        left = None if wanted is None else wanted - stored
                        try:
                            yield from self._begin(candidates, left, network, disk)
                        except QuotaError as error:
                            out_of_budget = error
                    if not self._under_way:
                        break
                    outcome = self._finish_oldest()
                    stored += isinstance(outcome, StoredCapture)
                    yield outcome
            except BaseException:
                # Also when the caller goes away: waiting threads must end before the executor.
                self._client.stop()
                while self._under_way:
                    self._under_way.popleft().cancel()
                raise
        if out_of_budget is not None:
            raise out_of_budget

    def _begin(
        self,
        candidates: Iterator[Found | Rejection],
        left: int | None,
        network: ThreadPoolExecutor,
        disk: ThreadPoolExecutor,
    ) -> Iterator[Rejection]:
        """Begin pictures while more are wanted and there is room; passes rejections on."""
        room = 4 * self._settings.concurrency
        while left is None or len(self._under_way) < left:
            outstanding = sum(download.outstanding for download in self._under_way)
            if max(outstanding, len(self._under_way)) >= room:
                return
            candidate = next(candidates, None)
            if candidate is None:
                return
            if isinstance(candidate, Rejection):
                yield candidate
                continue
            files = outstanding + len(candidate.files)
            self._client.budget.check(files, files * self._provider.usd_per_file)
            folder = self._captures / candidate.capture.key
            guarded = self._settings.source != "folder"  # the user's own pictures may be black
            download = Download(
                self._clean(candidate), folder, self._provider, network, disk, guarded=guarded
            )
            self._under_way.append(download)

    def _clean(self, found: Found) -> Found:
        """The picture without credentials, which a server may well echo in what it says of it."""
        capture = replace(
            found.capture,
            details=self._client.redact_json(found.capture.details),
            source_url=self._client.redact(found.capture.source_url),
        )
        return replace(found, capture=capture, raw=self._client.redact_json(found.raw))

    def _finish_oldest(self) -> StoredCapture | Rejection:
        """Wait for the picture begun first; it leaves the queue unless the run must end."""
        download = self._under_way[0]
        key = download.found.capture.key
        try:
            outcome: StoredCapture | Rejection = download.finish(
                allow_missing=self._settings.allow_missing
            )
        except ItemError as error:
            download.cancel()
            outcome = Rejection.from_error(key, "fetch", error)
        except (AuthError, QuotaError, OutageError):
            raise
        except NetworkError as error:
            self._network_failures += 1
            if self._network_failures >= _NETWORK_FAILURES_IN_A_ROW:
                raise
            download.cancel()
            outcome = Rejection(item=key, stage="fetch", reason="network", message=str(error))
        else:
            self._network_failures = 0
        self._under_way.popleft()
        return outcome
