"""`panokit synthetic`: a rendered city, and a local server of street pictures."""

import shlex
import time
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console
from panokit.synthetic.settings import CitySettings, ServeSettings

_Flat = Parameter(name="*")


def city(
    *,
    out: Path,
    settings: Annotated[CitySettings, _Flat] = CitySettings(),
    json: Json = False,
) -> int:
    """Render panoramas with their true light; needs panokit[render].

    Parameters
    ----------
    out
        Where panoramas/ and truth/ go; what is there already is kept.
    """
    from panokit.records import RunFolder
    from panokit.synthetic import render_city

    console = Console(as_json=json)
    RunFolder(out).create()
    with console.stage("city", settings.count) as tick:
        paths = render_city(settings, out, on_done=lambda _name, _path: tick())
    console.result(f"{len(paths)} panoramas in {out / 'panoramas'}, their truth in {out / 'truth'}")
    console.value([str(path) for path in paths])
    return 0


def serve(
    *,
    images: Path | None = None,
    settings: Annotated[ServeSettings, _Flat] = ServeSettings(),
) -> int:
    """Serve pictures as the street-imagery services do, on this machine, until interrupted.

    Parameters
    ----------
    images
        A folder of equirectangular pictures; the embedded city if not given.
    """
    from panokit.synthetic import serve as make_server

    console = Console()
    serving = make_server(images, settings)
    west, south, east, north = serving.bbox
    with serving.server as server:
        console.result(f"{len(serving.pictures)} pictures at {server.url}")
        if serving.invented:
            console.note(f"{len(serving.invented)} of them say no place; they got one on a grid.")
        box = f"{west:.5f} {south:.5f} {east:.5f} {north:.5f}"
        where = f"--endpoint {server.url} --bbox {box} --out RUN"
        console.result(f"panokit fetch {where}")
        console.result(
            f"GOOGLE_MAPS_API_KEY={shlex.quote(settings.key)} "
            f"panokit fetch --source google-tiles --accept-terms google {where}"
        )
        console.note("Press Ctrl-C to stop.")
        try:
            while True:
                time.sleep(3600)
        except KeyboardInterrupt:
            met = ", ".join(f"{n} {kind}" for kind, n in sorted(server.faults_met.items()))
            console.note(f"Stopped after {len(server.requests)} requests{met and f'; {met}'}.")
            for violation in server.violations:
                console.note(violation)
    return 0
