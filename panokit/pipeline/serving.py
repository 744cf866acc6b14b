"""A run that fetches from a server of its own, on this machine."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from panokit.console import Console
from panokit.fetch.settings import FetchSettings, PlaceSettings
from panokit.pipeline.settings import PipelineSettings, names_places

if TYPE_CHECKING:
    from panokit.synthetic import ServedPicture

EMBEDDED = "embedded"
# Where a picture stands for its place: pictures lie a few steps apart, as islands on a map.
_AROUND_M = 5.0
_HERE = "http://127.0.0.1"


def served_asks(settings: PipelineSettings) -> tuple[FetchSettings, ...]:
    """What a pipeline fetches; of its own server, every picture where no place is named."""
    asks = settings.asks()
    if not settings.serve:
        return asks
    here = tuple(ask.model_copy(update={"endpoint": _HERE}) for ask in asks)
    if any(names_places(ask) for ask in asks):
        return here
    places = places_of(_pictures(settings))
    return tuple(ask.model_copy(update={"places": places}) for ask in here)


@contextmanager
def serving(
    settings: PipelineSettings, console: Console, asks: Sequence[FetchSettings]
) -> Iterator[Sequence[FetchSettings]]:
    """A block in which the pipeline's own server runs, if it has one.

    Args:
        settings: Of the pipeline.
        console: Says where the server is.
        asks: What is to be fetched.

    Yields:
        The same with the server's address.

    Raises:
        UsageError: If there are no pictures to serve, or the port is taken.
    """
    if not settings.serve:
        yield asks
        return
    from panokit.synthetic import StreetServer

    with StreetServer(_pictures(settings), port=settings.serve_port) as server:
        what = "The embedded city" if settings.serve == EMBEDDED else settings.serve
        console.note(f"{what} is served at {server.url}, to this machine only.")
        yield tuple(ask.model_copy(update={"endpoint": str(server.url)}) for ask in asks)


def places_of(pictures: Sequence["ServedPicture"]) -> tuple[PlaceSettings, ...]:
    """The places of some pictures, as areas around them."""
    found: dict[str, list[tuple[float, float]]] = {}
    for picture in pictures:
        found.setdefault(picture.capture.place, []).append(picture.position_deg)
    return tuple(
        PlaceSettings(
            name=place,
            latitude_deg=sum(latitude for latitude, _ in positions) / len(positions),
            longitude_deg=sum(longitude for _, longitude in positions) / len(positions),
            radius_m=_AROUND_M,
        )
        for place, positions in found.items()
    )


def _pictures(settings: PipelineSettings) -> Sequence["ServedPicture"]:
    from panokit.synthetic import embedded_city, pictures_in

    if settings.serve == EMBEDDED:
        return embedded_city()
    return pictures_in(Path(settings.serve))[0]
