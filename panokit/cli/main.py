"""The table of commands, and what becomes of errors.

Commands are named by text and loaded when called, so `panokit --help` loads nothing else.
"""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import count, takewhile
from pathlib import Path

from cyclopts import App, CycloptsError, Parameter
from pydantic import ValidationError

from panokit import __version__
from panokit.errors import PanokitError, StorageError

_COMMANDS = {
    "demo": ("demo:demo", "Light probes from the embedded city, offline, in about a minute"),
    "run": ("run:run", "Run a pipeline: a city list in, light probes and a report out"),
    "fetch": ("fetch:fetch", "Fetch street panoramas of cities"),
    "stitch": ("stages:stitch", "Tiles, views or photos to level panoramas"),
    "inpaint": ("stages:inpaint", "Fill what the camera did not see"),
    "expand": ("stages:expand", "Panoramas to HDR environment maps"),
    "qa": ("qa:qa", "Check maps, compare them with references, write a report"),
    "train": ("train:train", "Train networks from their recipes"),
    "lighting": ("lighting:lighting", "Click an object in a video, get the light of its scene"),
    "app": ("app:app", "The local web application: lighting from video, panoramas, the library"),
    "doctor": ("doctor:doctor", "What works on this machine, and how to mend what does not"),
}
_GROUPS = {
    "synthetic": (
        "A procedural city with true HDR, and a local server of street pictures",
        {
            "city": ("synthetic:city", "Render panoramas with their true light"),
            "serve": ("synthetic:serve", "Serve pictures as the street-imagery services do"),
        },
    ),
    "probes": (
        "The library of light probes",
        {
            "add": ("probes:add", "Put maps into a library"),
            "list": ("probes:list_probes", "List a library"),
            "show": ("probes:show", "All that is known of one probe"),
            "select": ("probe_sets:select", "Choose probes, balanced and diverse"),
            "export": ("probe_sets:export", "Write probes for other tools, with credits"),
            "verify": ("probes:verify", "Read and hash every probe again"),
            "reindex": ("probes:reindex", "Build the index from the records"),
            "pull": ("pull:pull", "Pull HDR maps of Poly Haven (CC0)"),
        },
    ),
    "dataset": (
        "Stereo samples of unknown objects in known light",
        {
            "render": ("dataset:render", "Render samples lit by the probes of a library"),
            "preview": ("dataset:preview", "A sheet of samples to look at"),
            "verify": ("dataset:verify", "Check every file of every sample, and the splits"),
        },
    ),
    "evaluate": (
        "How good methods are, on data that they have not seen",
        {
            "expansion": ("evaluate:expansion", "The light recovered from clipped panoramas"),
            "figures": ("evaluate:figures", "All figures of an evaluation, drawn anew"),
        },
    ),
    "models": (
        "The released networks",
        {
            "list": ("models:list_models", "List the released models"),
            "show": ("models:show", "A model's card"),
            "verify": ("models:verify", "Check the models' files against their digests"),
        },
    ),
}
_TYPES = {"int", "float", "str", "bool", "none"}
_INTERRUPTED = 130
_TERMINATED = 143
_BROKEN_PIPE = 141


def build_app() -> App:
    """The command-line application."""
    app = App(
        name="panokit",
        help="HDR light probes from street panoramas.",
        version=__version__,
        default_parameter=Parameter(negative_iterable=(), show_default=_default_text),
        suppress_keyboard_interrupt=False,  # `main` says what is kept
    )
    order = count()
    for name, (place, text) in _COMMANDS.items():
        app.command(f"panokit.cli.{place}", name=name, help=text, sort_key=next(order))
    for name, (text, commands) in _GROUPS.items():
        group = App(name=name, help=text, sort_key=next(order))
        for inner, (place, inner_text) in commands.items():
            group.command(f"panokit.cli.{place}", name=inner, help=inner_text)
        if name == "evaluate":
            group.default(_evaluate())
        app.command(group)
    return app


def _evaluate() -> Callable[..., int]:
    """What `panokit evaluate MODEL` does; a default cannot be named by text."""
    from panokit.cli.evaluate import lighting

    return lighting


def _default_text(value: object) -> str | None:
    """A default as --help shows it; one that says nothing ("no", "none", "all") is left out."""
    if value is None or value is False or value in ("", (), []):
        return None
    return " ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code; errors become one line on standard error."""
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    try:
        with _terminated_like_interrupted():
            code = build_app()(
                tokens, exit_on_error=False, print_error=False, result_action="return_value"
            )
    except CycloptsError as error:
        return _fail(_usage_text(error), 2)
    except PanokitError as error:
        return _fail(_one_line(str(error)), error.exit_code)
    except KeyboardInterrupt as stop:
        return _fail("Interrupted; what was done is kept. Run the same command to go on.",
                     _TERMINATED if isinstance(stop, _Terminated) else _INTERRUPTED)  # fmt: skip
    except BrokenPipeError:
        # The reader of our output went away (`panokit probes list | head`): not an error.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _BROKEN_PIPE
    except OSError as error:
        # What no layer below has put into words, such as a folder that may not be read.
        from panokit.io.files import storage_error

        path = Path(error.filename) if error.filename else Path()
        return _fail(str(storage_error("use", path, error)), StorageError.exit_code)
    return code if isinstance(code, int) else 0


class _Terminated(KeyboardInterrupt):
    """The request to end, as schedulers and shutdowns send it."""


@contextmanager
def _terminated_like_interrupted() -> Iterator[None]:
    """Let SIGTERM unwind the program, so that it leaves the same order as Ctrl-C does."""
    is_ours = (
        threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    )
    if not is_ours:
        yield
        return

    def end(*_: object) -> None:
        raise _Terminated

    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _fail(message: str, code: int) -> int:
    sys.stderr.write(f"panokit: {message}\n")
    return code


def _usage_text(error: CycloptsError) -> str:
    """What is wrong with the arguments, as a person would say it."""
    cause = error.__cause__
    if isinstance(cause, ValidationError):
        first = cause.errors()[0]
        # Of a field that takes several types, the location also names the type that was tried.
        parts = map(str, first["loc"])
        names = takewhile(lambda part: part.isidentifier() and part not in _TYPES, parts)
        option = "--" + ".".join(names).replace("_", "-") if first["loc"] else ""
        said = first["msg"].removeprefix("Value error, ")
        message = said[0].lower() + said[1:]
        return f"{option} {first['input']}: {message}." if option else f"{message}."
    return _one_line(str(error))


def _one_line(message: str) -> str:
    return " ".join(line.strip() for line in message.splitlines() if line.strip())
