"""Which of the pictures found are taken, and why the others are not."""

from collections import Counter
from collections.abc import Container, Iterator, Mapping, Sequence
from itertools import islice

from panokit.capture import Capture, TimePrecision
from panokit.errors import Rejection
from panokit.fetch.geodesy import LatLon
from panokit.fetch.places import Place
from panokit.fetch.provider import Found, Provider
from panokit.fetch.sampling import sample_points
from panokit.fetch.settings import FetchSettings
from panokit.fetch.thinning import Thinning
from panokit.io.captures import StoredCapture

_POINTS_AT_ONCE = 100
_FRUITLESS_ROUNDS = 3


class Selection:
    """The pictures of one place that the settings want, nearest to the sample points first.

    Args:
        settings: Dates, distances, seed.
        place: Where to look; None takes all that the provider has.
        on_disk: Complete captures by key; others keep their distance to them.
        known: Keys of panoramas that are not to be asked for again.

    Attributes:
        passed_over: Reason -> how many pictures were not wanted for it.
        met_again: Captures on disk that the provider offered.
    """

    def __init__(
        self,
        settings: FetchSettings,
        place: Place | None,
        on_disk: Mapping[str, StoredCapture],
        known: Container[str],
    ) -> None:
        self.passed_over: Counter[str] = Counter()
        self.met_again: list[StoredCapture] = []
        self._settings = settings
        self._place = place
        self._on_disk = on_disk
        self._known = known
        self._thinning = Thinning(settings, place, (one.capture for one in on_disk.values()))

    def candidates(self, provider: Provider) -> Iterator[Found | Rejection]:
        """Wanted pictures and failed ones, one by one, until the place yields no more."""
        if self._place is None:
            yield from self._wanted(provider, ())
            return
        points = sample_points(self._place, self._settings.seed)
        fruitless = 0
        while fruitless < _FRUITLESS_ROUNDS:
            fruitless += 1
            around = list(islice(points, _POINTS_AT_ONCE))
            if self._place.points and around:
                fruitless = 0  # each point of a list is looked at
            for found in self._wanted(provider, around):
                fruitless = 0
                yield found

    def _wanted(self, provider: Provider, points: Sequence[LatLon]) -> Iterator[Found | Rejection]:
        for one in provider.find(self._place, points):
            if isinstance(one, Rejection):
                if one.item not in self._known:
                    yield one
                continue
            reason = self._objection(one, provider)
            if reason:
                self.passed_over[reason] += 1
                continue
            self._thinning.take(one.capture)
            yield one

    def _objection(self, found: Found, provider: Provider) -> str:
        """Why a picture is not wanted, "" if it is."""
        capture = found.capture
        if capture.key in self._on_disk:
            self.met_again.append(self._on_disk[capture.key])
            return "existing"
        if capture.key in self._known:
            return "known"
        if not (capture.license.store or provider.may_store):
            return "no-license"
        wanted = {id.casefold() for id in self._settings.licenses}
        if wanted and capture.license.id.casefold() not in wanted:
            return "other-license"
        return "" if self._place is None else self._misfit(found, self._place)

    def _misfit(self, found: Found, place: Place) -> str:
        """Why a picture does not belong to what is wanted of a place, "" if it does."""
        capture, position = found.capture, found.position_deg
        if capture.details.get("imagery_type") == "indoor" and not self._settings.indoor:
            return "indoor"
        if position is None or not place.contains(position):
            return "outside"
        if not self._is_in_time(capture):
            return "out-of-dates"
        return self._thinning.objection(capture)

    def _is_in_time(self, capture: Capture) -> bool:
        """Whether a picture was taken between the dates; months count where days are unknown."""
        start, end = self._settings.date_from, self._settings.date_to
        if start is None and end is None:
            return True
        if capture.time is None:
            return False
        day = capture.time.date()
        if capture.time_precision in (TimePrecision.MONTH, TimePrecision.YEAR):
            start = start and start.replace(day=1)
        return (start is None or day >= start) and (end is None or day <= end)
