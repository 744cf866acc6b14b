"""Many items through one stage: skip what is complete, keep verdicts, show progress."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

from panokit.console import Console
from panokit.engine import Engine, Outcome, SerialEngine, attempt
from panokit.errors import Rejection
from panokit.ledger import Ledger, Pace
from panokit.pipeline.tasks import StageTask, run_task
from panokit.records import Receipt, RunFolder, is_complete


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchResult:
    """What became of every item of a stage, in the order of the items.

    Attributes:
        stage: The stage.
        receipts: Items that are done, now or before.
        rejections: Items that could not be used.
    """

    stage: str
    receipts: tuple[Receipt, ...] = ()
    rejections: tuple[Rejection, ...] = ()

    @property
    def fresh(self) -> int:
        """How many items were made now."""
        return sum(receipt.fresh for receipt in self.receipts)

    @property
    def found(self) -> int:
        """How many items were complete already."""
        return len(self.receipts) - self.fresh

    def summary(self) -> str:
        """One line for a person."""
        parts = [f"{self.fresh} done"] if self.fresh or not self.found else []
        parts += [f"{self.found} complete already"] if self.found else []
        parts += [f"{len(self.rejections)} rejected"] if self.rejections else []
        return f"{self.stage}: {', '.join(parts)}"


def run_batch(
    stage: str,
    tasks: Sequence[StageTask],
    console: Console,
    *,
    engine: Engine | None = None,
    run: RunFolder | None = None,
) -> BatchResult:
    """Take every task's item through the stage.

    Args:
        stage: The stage, for progress and log.
        tasks: One per item.
        console: Says how it goes.
        engine: Runs the tasks; one after the other if not given.
        run: Keeps verdicts and log, if the tasks belong to a run.
    """
    ledger = Ledger(run.ledger) if run else None
    outcomes: dict[str, Outcome] = {}
    waiting: list[StageTask] = []
    keys: dict[str, str] = {}
    for task in tasks:
        known = _known(task, ledger, keys)
        if known is None:
            waiting.append(task)
        else:
            outcomes[task.item] = known
    started, fresh = time.monotonic(), 0
    if waiting and ledger is not None:
        ledger.set_pace(stage, Pace(wanted=len(waiting), fresh=0, seconds=0.0))
    with console.stage(stage, len(waiting), unit="panoramas") as tick:
        for outcome in (engine or SerialEngine()).run(run_task, waiting):
            if outcome.item in outcomes:
                continue  # an engine that lost sight of a worker had it done twice
            outcomes[outcome.item] = outcome
            fresh += 1
            if run is not None and ledger is not None:
                _remember(outcome, keys[outcome.item], ledger, run)
                seconds = time.monotonic() - started
                ledger.set_pace(stage, Pace(wanted=len(waiting), fresh=fresh, seconds=seconds))
            tick(rejected=isinstance(outcome, Rejection))
            if isinstance(outcome, Rejection):
                console.note(f"{stage}: {outcome.item} rejected ({outcome.reason}): "
                             f"{outcome.message}")  # fmt: skip
    ordered = [outcomes[task.item] for task in tasks]
    return BatchResult(
        stage=stage,
        receipts=tuple(o for o in ordered if isinstance(o, Receipt)),
        rejections=tuple(o for o in ordered if isinstance(o, Rejection)),
    )


def _known(task: StageTask, ledger: Ledger | None, keys: dict[str, str]) -> Outcome | None:
    """The outcome that an earlier run reached with the same key, if there is one."""

    def look() -> Receipt:
        key = keys[task.item] = task.key()
        fresh = not is_complete(task.target, key)
        return Receipt(item=task.item, stage=task.stage, path=task.target, key=key, fresh=fresh)

    outcome = attempt(task.item, task.stage, look)
    if isinstance(outcome, Rejection):
        return outcome
    if not outcome.fresh:
        return outcome
    return ledger.find(task.item, task.stage, outcome.key) if ledger else None


def _remember(outcome: Outcome, key: str, ledger: Ledger, run: RunFolder) -> None:
    if isinstance(outcome, Rejection):
        run.log("rejected", key=key, **outcome.to_json())
        ledger.add(outcome, key)
        return
    run.log(
        "done",
        stage=outcome.stage,
        item=outcome.item,
        key=outcome.key,
        seconds=round(outcome.seconds, 3),
        cpu_s=round(outcome.cpu_s, 3),
        values=dict(outcome.values),
    )
    ledger.add_done(outcome)
