"""What every source of pictures offers: find what is near some points, read a file of it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from panokit.capture import Capture, TileGrid, View
from panokit.errors import Rejection
from panokit.fetch.geodesy import LatLon
from panokit.fetch.places import Place
from panokit.io.captures import tile_name


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A picture that a provider has, not fetched yet.

    Attributes:
        capture: What the provider says of it.
        address: Where its pixels are; only its provider reads this.
        grid: How its tiles lie, or None for one whole picture or for views.
        views: The overlapping views it comes in, or () for one whole picture or for tiles.
        suffix: Of a whole picture's file.
        bytes: About how large it is.
        raw: The provider's own description, kept in the record as it came.
    """

    capture: Capture
    address: str = ""
    grid: TileGrid | None = None
    views: tuple[View, ...] = ()
    suffix: str = ".jpg"
    bytes: int = 0
    raw: Any = field(default=None, repr=False)

    @property
    def position_deg(self) -> LatLon | None:
        """(latitude, longitude), or None where it is not known."""
        return position_of(self.capture)

    def filed_under(self, place: str) -> "Found":
        """The same picture, as one of a city or area."""
        return replace(self, capture=self.capture.at_place(place))

    @property
    def files(self) -> tuple[str, ...]:
        """The names of its files, as they will be stored."""
        if self.views:
            return tuple(view.name for view in self.views)
        if self.grid is None:
            return (f"image{self.suffix}",)
        return tuple(tile_name(column, row) for column, row in self.grid.cells())


def position_of(capture: Capture) -> LatLon | None:
    """Where a picture was taken, as (latitude, longitude), or None where it is not known."""
    latitude, longitude = capture.latitude_deg, capture.longitude_deg
    return None if latitude is None or longitude is None else (latitude, longitude)


class Provider(Protocol):
    """A source of pictures. Both methods may ask the network; `read` runs in many threads."""

    @property
    def usd_per_file(self) -> float:
        """What the source charges for one file."""

    @property
    def may_store(self) -> bool:
        """Whether pictures may be kept that carry no license for it: by consent, or the user's."""

    def find(self, place: Place | None, points: Sequence[LatLon]) -> Iterable[Found | Rejection]:
        """Pictures near these points, lazily.

        Without a place, those that the settings name by id; a source without places gives all
        it has. What is listed but cannot be had (any more) comes as a `Rejection`. The same picture
        may come again.
        """

    def read(self, found: Found, name: str) -> bytes:
        """One of the files of a picture, whole and checked.

        Raises:
            ItemError: If it cannot be had or is not what it should be.
        """
