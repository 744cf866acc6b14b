"""`panokit stitch`, `inpaint` and `expand`: one stage over a run or over pictures."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from panokit.cli.options import Json, Workers, finish
from panokit.console import Console
from panokit.expand.settings import ExpandSettings
from panokit.inpaint.settings import InpaintSettings
from panokit.settings import Settings
from panokit.stitch.settings import StitchSettings

_Flat = Parameter(name="*")


def stitch(
    inputs: list[Path],
    /,
    *,
    out: Path | None = None,
    settings: Annotated[StitchSettings, _Flat] = StitchSettings(),
    workers: Workers = 1,
    json: Json = False,
) -> int:
    """Tiles, overlapping views or bracketed exposures to level panoramas.

    Parameters
    ----------
    inputs
        A run folder, folders that `panokit fetch` wrote, or files of views (VIEWS.json).
    out
        Where the panoramas go; a run keeps them itself.
    """
    return _run("stitch", inputs, settings, out, workers=workers, json=json)


def inpaint(
    inputs: list[Path],
    /,
    *,
    out: Path | None = None,
    mask: Path | None = None,
    settings: Annotated[InpaintSettings, _Flat] = InpaintSettings(),
    workers: Workers = 1,
    json: Json = False,
) -> int:
    """Fill what the camera did not see: tripod, car, missing tiles.

    Parameters
    ----------
    inputs
        A run folder, or panoramas, or folders of them.
    out
        Where the filled panoramas go; a run keeps them itself.
    mask
        A picture of the panorama's size, white where to fill; instead of finding holes.
    """
    return _run("inpaint", inputs, settings, out, mask=mask, workers=workers, json=json)


def expand(
    inputs: list[Path],
    /,
    *,
    out: Path | None = None,
    settings: Annotated[ExpandSettings, _Flat] = ExpandSettings(),
    workers: Workers = 1,
    json: Json = False,
) -> int:
    """Panoramas to HDR environment maps: NAME.exr beside its record NAME.json.

    Parameters
    ----------
    inputs
        A run folder, or panoramas, or folders of them.
    out
        Where the maps go; a run keeps them itself.
    """
    return _run("expand", inputs, settings, out, workers=workers, json=json)


def _run(
    stage: str,
    inputs: Sequence[Path],
    settings: Settings,
    out: Path | None,
    *,
    mask: Path | None = None,
    workers: int,
    json: bool,
) -> int:
    from panokit.engine import LocalEngine, SerialEngine
    from panokit.pipeline.batch import run_batch
    from panokit.pipeline.inputs import stage_tasks
    from panokit.records import RunFolder

    console = Console(as_json=json)
    run = RunFolder(inputs[0]) if len(inputs) == 1 and RunFolder(inputs[0]).is_run else None
    tasks = stage_tasks(stage, inputs, settings, out, mask)
    if out is not None and run is None:
        RunFolder(out).create()
    engine = LocalEngine(workers) if workers > 1 else SerialEngine()
    result = run_batch(stage, tasks, console, engine=engine, run=run)
    narrow = [r.item for r in result.receipts if r.values.get("width_limited_by_panorama")]
    if narrow:
        more = f" and {len(narrow) - 1} more" if len(narrow) > 1 else ""
        console.note(
            f"{narrow[0]}{more}: narrower than --width-px, since no map is wider than its panorama."
        )
    return finish(console, [result])
