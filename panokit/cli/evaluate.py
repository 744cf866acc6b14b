"""`panokit evaluate`: how well models read light; how much light expansion recovers."""

from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console
from panokit.errors import UsageError
from panokit.evaluate.lighting.settings import LightingEvaluation
from panokit.evaluate.settings import ExpansionEvaluation
from panokit.expand.settings import ExpandSettings


def lighting(
    *models: str,
    data: Path,
    out: Path,
    split: Literal["train", "validation", "test"] = "test",
    baselines: bool = True,
    speed: bool = True,
    report: bool = True,
    settings: Annotated[LightingEvaluation, Parameter(name="*")] = LightingEvaluation(),
    json: Json = False,
) -> int:
    """Judge models that read light from two views, beside baselines that need no training.

    What is scored is kept; run the same command again to go on, or with more models.

    Parameters
    ----------
    models
        Folders of models, folders of such folders, or ids of released models.
    data
        A stereo dataset.
    out
        Where results.jsonl, history.jsonl, models.jsonl and all figures go.
    split
        Of the dataset.
    baselines
        Judge the baselines, too.
    speed
        Measure latency and memory, once for each architecture.
    report
        Draw all figures and write report.html, report.md and summary.json.
    """
    if not models and not baselines:
        raise UsageError("There is nothing to judge. Name a model, or take --no-baselines away.")
    from panokit.evaluate.lighting.evaluation import evaluate
    from panokit.evaluate.lighting.terminal import table_of

    console = Console(as_json=json)
    found = evaluate(
        models, data, out, split=split, with_baselines=baselines, with_speed=speed,
        settings=settings, console=console,
    )  # fmt: skip
    for table in table_of(found):
        console.table(table.header, table.rows)
        for note in table.notes:
            console.result(note)
        console.result("")
    if report:
        return figures(out, json=json)
    console.result(f"All figures: {out / 'results.jsonl'}")
    return 0


def figures(results: Path, /, *, json: Json = False) -> int:
    """Draw all figures and tables of an evaluation anew, without its models or its dataset.

    Parameters
    ----------
    results
        The folder that `panokit evaluate --out` wrote.
    """
    from panokit.evaluate.lighting.lighting_report import write_pack

    console = Console(as_json=json)
    with console.stage("figures", None) as tick:
        summary = write_pack(results, tick=tick)
    console.result(f"Report: {results / 'report.html'}")
    console.value(summary)
    return 0


def expansion(
    *,
    probes: Path,
    out: Path,
    model: tuple[str, ...] = (ExpandSettings().model,),
    peer: Annotated[tuple[str, ...], Parameter(name=("--peer", "--command"))] = (),
    settings: Annotated[ExpansionEvaluation, Parameter(name="*")] = ExpansionEvaluation(),
    json: Json = False,
) -> int:
    """Judge expansion methods on HDR probes: the light they recover from clipped pictures.

    LDR, sRGB, inverse Reinhard and the area rule are always judged, too. What is scored is
    kept; run the same command again to go on, or add a method.

    Parameters
    ----------
    probes
        A folder of HDR maps, with a manifest.csv that tells kinds and places, or without.
    out
        Where expansion.json, expansion.md and the kept scores go.
    model
        A released model, or a model's folder, with {fold} for one of each fold. Can be given
        several times.
    peer
        A method of yours: an .onnx file that takes a picture and gives radiance (with {fold} for
        one of each fold), or a program, "NAME=PROGRAM {input} {output}", that gets a PNG and writes
        an EXR. Can be given several times.
    """
    from panokit.evaluate import evaluate_expansion, write_evaluation
    from panokit.evaluate.peers import method_of, peer_method

    console = Console(as_json=json)
    methods = [*map(method_of, model), *(peer_method(one, settings.timeout_s) for one in peer)]
    result = evaluate_expansion(probes, methods, out, settings, console)
    paths = write_evaluation(result, out)
    from panokit.evaluate.expansion_report import evaluation_record

    record = evaluation_record(result)
    for camera, columns in record["cameras"].items():
        _show(console, camera, columns)
    console.result(f"All figures: {paths[1]}")
    console.value({key: value for key, value in record.items() if key != "rows"})
    return 0


def _show(console: Console, camera: str, columns: dict[str, Any]) -> None:
    """A few figures that fit a terminal of 80 columns."""
    keys = {
        "energy_median": "energy",
        "irradiance_median": "irrad.",
        "light_vector_mean": "vector",
        "ball_median": "ball",
        "pu21_crf_mean": "PU21",
        "cpu_seconds_median": "CPU s",
    }
    rows = []
    for name, column in columns.items():
        mark = {"seen": "*", "unknown": "?", "unseen": ""}[column["status"]]
        figures = [column["figures"][key] for key in keys]
        cells = ["-" if f is None else f"{f['value']:.3g}" for f in figures]
        rows.append((f"{name}{mark}", str(column["pictures"]), *cells))
    console.table((f"camera {camera}", "n", *keys.values()), rows)
    statuses = {column["status"] for column in columns.values()}
    if "seen" in statuses:
        console.result("* trained on these very probes: proves nothing")
    if "unknown" in statuses:
        console.result("? does not say what it was trained on")
    console.result("")
