"""`panokit demo`: light probes from the embedded city."""

from pathlib import Path

from panokit.cli.options import Json
from panokit.cli.run import report_run
from panokit.console import Console


def demo(*, out: Path = Path("demo"), json: Json = False) -> int:
    """Light probes from the embedded city, offline, in about a minute.

    Parameters
    ----------
    out
        Where everything goes.
    """
    from panokit.pipeline.demo import demo_settings, run_demo

    console = Console(as_json=json)
    result = run_demo(out, console)
    code = report_run(result, demo_settings().max_rejected_share, console)
    console.result(f"Open it in a browser: {(out / 'qa' / 'report.html').resolve().as_uri()}")
    return code
