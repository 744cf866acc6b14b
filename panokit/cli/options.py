"""Options that several commands share, and how a batch command ends."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from panokit.console import Console
from panokit.errors import UsageError

if TYPE_CHECKING:
    from panokit.pipeline.batch import BatchResult

Json = Annotated[
    bool,
    Parameter(name="--json", negative=(), show_default=False, help="Print the result as JSON."),
]
Flag = Annotated[bool, Parameter(negative=())]
Workers = Annotated[
    int,
    Parameter(help="Processes to share the work; each needs memory.", validator=Number(gte=1)),
]


def finish(console: Console, results: Sequence["BatchResult"]) -> int:
    """Print what became of a batch, and the exit code: 1 if any item was rejected.

    Raises:
        UsageError: If there was nothing to do.
    """
    if not any(result.receipts or result.rejections for result in results):
        raise UsageError("There is nothing here to work on. Check the paths.")
    for result in results:
        console.result(result.summary())
    console.value([_as_json(result) for result in results])
    return 1 if any(result.rejections for result in results) else 0


def _as_json(result: "BatchResult") -> dict[str, Any]:
    return {
        "stage": result.stage,
        "done": [{"item": r.item, "path": str(r.path), "fresh": r.fresh} for r in result.receipts],
        "rejected": [rejection.to_json() for rejection in result.rejections],
    }
