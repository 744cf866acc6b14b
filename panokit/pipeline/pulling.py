"""HDR maps of Poly Haven into a probe library, resumably."""

import shutil
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from panokit.console import Console
from panokit.errors import ItemError, Rejection
from panokit.fetch.polyhaven import PolyHaven, RemoteMap
from panokit.fetch.settings import PullSettings
from panokit.http import Budget, Client, Policy
from panokit.io import read_environment_map
from panokit.probes import Library
from panokit.probes.library import SHELF_NAME

_INCOMING = ".incoming"


@dataclass(frozen=True, slots=True, kw_only=True)
class PullResult:
    """What pulling brought, or would bring.

    Attributes:
        added: Pulled now; in a dry run, what would be.
        existing: Names of maps that the library had.
        rejections: Maps that could not be had.
        requests: Sent, retries included.
    """

    added: tuple[RemoteMap, ...] = ()
    existing: tuple[str, ...] = ()
    rejections: tuple[Rejection, ...] = ()
    requests: int = 0

    @property
    def bytes(self) -> int:
        """How much came over the network, or would."""
        return sum(remote.bytes for remote in self.added)


def pull_into(
    settings: PullSettings, folder: Path, console: Console, *, client: Client | None = None
) -> PullResult:
    """Pull the maps that the settings ask for and that the library does not have.

    Each is checked against the digest that the service publishes, added with its license, and
    the file that came is removed: the library keeps the map. A second run goes on where the
    first one ended.

    Args:
        settings: Which maps, how large.
        folder: Of the library; it is made if need be.
        console: Shows progress.
        client: Sends the requests; one is made from the settings if not given.

    Raises:
        UsageError: If a name is not known.
        NetworkError: If the service cannot be reached.
        QuotaError: If the budget of requests is used up.
        StorageError: If the library cannot be written.
    """
    if client is None:
        # A map of 16384 px may be near a gigabyte, and take its time.
        policy = Policy(
            rate_per_s=settings.requests_per_s,
            burst=4,
            total_timeout_s=3600.0,
            max_body_bytes=1 << 31,
        )
        with Client(policy, budget=Budget(settings.max_requests)) as own:
            return pull_into(settings, folder, console, client=own)
    there = _names_in(folder)
    service = PolyHaven(settings, client)
    maps = service.wanted()
    if not settings.dry_run:
        # Tells of a folder that cannot be written before anything is fetched.
        Library.create(folder).close()
        # Where a killed run had put the file it was at.
        shutil.rmtree(folder / _INCOMING, ignore_errors=True)
    known = {capture.id for capture in maps if f"{capture.id}_{settings.resolution}" in there}
    existing = [f"{id}_{settings.resolution}" for id in sorted(known)]
    added: list[RemoteMap] = []
    rejections: list[Rejection] = []
    missing = [capture for capture in maps if capture.id not in known]
    with console.stage("pull", len(missing)) as tick:
        for found in service.look_up(missing):
            outcome = _pull_one(found, service, folder, there, dry_run=settings.dry_run)
            match outcome:
                case Rejection():
                    rejections.append(outcome)
                    console.note(f"pull: {outcome.message}")
                case RemoteMap():
                    added.append(outcome)
                case _:
                    existing.append(outcome)
            tick(rejected=isinstance(outcome, Rejection))
    return PullResult(
        added=tuple(added),
        existing=tuple(existing),
        rejections=tuple(rejections),
        requests=client.budget.requests,
    )


def _pull_one(
    found: RemoteMap | Rejection,
    service: PolyHaven,
    folder: Path,
    there: set[str],
    *,
    dry_run: bool,
) -> RemoteMap | Rejection | str:
    """What becomes of one map: pulled, rejected, or the name under which it is there."""
    if isinstance(found, Rejection):
        return found
    if found.name in there:
        return found.name
    try:
        if not dry_run:
            _add(service, found, folder)
    except ItemError as error:
        return Rejection.from_error(found.name, "pull", error)
    return found


def _add(service: PolyHaven, remote: RemoteMap, folder: Path) -> None:
    with Library.create(folder) as library:
        path = service.download(remote, folder / _INCOMING)
        try:
            envmap = read_environment_map(path).with_changes(capture=remote.capture)
            library.add(envmap, name=remote.name)
        finally:
            path.unlink(missing_ok=True)
            with suppress(OSError):
                path.parent.rmdir()


def _names_in(folder: Path) -> set[str]:
    """The names of the maps of Poly Haven that a library has; none if it does not exist."""
    if not (folder / SHELF_NAME).is_dir():
        return set()
    with Library.open(folder) as library:
        return {entry.name for entry in library.list()}
