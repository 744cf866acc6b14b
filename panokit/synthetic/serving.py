"""Serve a folder of pictures, or the embedded city, as the street-imagery services do."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from panokit.synthetic.embedded import embedded_city
from panokit.synthetic.fault_language import parse_faults
from panokit.synthetic.faults import Faults
from panokit.synthetic.folder import pictures_in
from panokit.synthetic.pictures import ServedPicture
from panokit.synthetic.server import StreetServer
from panokit.synthetic.settings import ServeSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Serving:
    """A server and what it will serve; enter `server` to start it.

    Attributes:
        server: Not started yet, but its address is fixed.
        pictures: All of them.
        invented: Names of the pictures whose place on the map was invented.
    """

    server: StreetServer
    pictures: Sequence[ServedPicture]
    invented: Sequence[str] = ()

    @property
    def bbox(self) -> tuple[float, float, float, float]:
        """West, south, east and north of the pictures, in degrees, with a small margin."""
        latitudes, longitudes = zip(*(p.position_deg for p in self.pictures), strict=True)
        margin = 1e-4
        return (
            min(longitudes) - margin,
            min(latitudes) - margin,
            max(longitudes) + margin,
            max(latitudes) + margin,
        )


def serve(
    images: Path | None = None,
    settings: ServeSettings | None = None,
    *,
    faults: Faults | None = None,
) -> Serving:
    """Make a server for a folder of equirectangular pictures, or for the embedded city.

    Args:
        images: The folder; see `folder.pictures_in`. None serves the embedded city.
        settings: Port, credentials, and faults in words.
        faults: What to do wrong, in place of the settings' words.

    Raises:
        UsageError: If there is no picture in the folder, the port is taken, or the faults are
            not understood.
    """
    settings = settings or ServeSettings()
    pictures, invented = (list(embedded_city()), []) if images is None else pictures_in(images)
    server = StreetServer(
        pictures,
        faults=faults or parse_faults(settings.faults),
        key=settings.key,
        token=settings.token,
        port=settings.port,
    )
    return Serving(server=server, pictures=pictures, invented=invented)
