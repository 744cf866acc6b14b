"""What becomes of a shard whose worker died or hung."""

from collections import Counter
from dataclasses import replace

from panokit.console import Console
from panokit.dataset.production.attempts import SampleEvent
from panokit.dataset.production.progress import Progress
from panokit.dataset.production.shard_task import STAGE, ShardItem
from panokit.engine import Loss
from panokit.errors import PanokitError
from panokit.records import RunFolder

# A worker that dies may have been killed by chance; one that hangs hardly hangs by chance.
_MOST_LOSSES = {"died": 3, "silent": 2}
_BLAME = {
    True: (
        "before it began (in a script of your own, call render_dataset below "
        '`if __name__ == "__main__":`; else look for a lack of memory)'
    ),
    False: "between two samples (look for a lack of memory or a failing disk)",
}
_REASONS = {"died": "worker-died", "silent": "timeout"}


class LossPolicy:
    """Tries an attempt again whose worker was lost, and gives it up if that happens again.

    Args:
        progress: Notes the losses.
        run: Logs them.
        console: Tells of them.
        timeout_s: For the message.
    """

    def __init__(
        self, progress: Progress, run: RunFolder, console: Console, timeout_s: float
    ) -> None:
        self._progress, self._run, self._console = progress, run, console
        self._timeout_s = timeout_s
        self._counts: Counter[tuple[int, int]] = Counter()
        self._between: Counter[str] = Counter()

    def __call__(self, item: ShardItem, loss: Loss) -> ShardItem:
        """The shard, to go on with; without the attempt that was under way, if that is to blame.

        Raises:
            PanokitError: If workers are lost again and again.
        """
        event = loss.last_report
        message = (
            f"nothing was heard of it for {self._timeout_s:g} s"
            if loss.reason == "silent"
            else f"its worker process died (exit code {loss.exit_code})"
        )
        reason = _REASONS[loss.reason]
        self._run.log("worker lost", shard=item.path.stem, reason=reason, message=message)
        self._console.note(f"{STAGE}: a worker is replaced: {message}")
        index, attempt = (event.index, event.attempt) if event else (item.indices[0], 0)
        self._progress.lose(
            SampleEvent(kind="failed", index=index, attempt=attempt, reason=reason, message=message)
        )
        if event is None or event.kind != "started":
            # Between samples, as when the shard is written: no sample is to blame.
            self._between[item.path.stem] += 1
            if self._between[item.path.stem] >= _MOST_LOSSES[loss.reason]:
                raise PanokitError(
                    f"The shard {item.path.stem} lost its worker {self._between[item.path.stem]} "
                    f"times {_BLAME[event is None]}: {message}. What was done is kept."
                )
            return item
        self._counts[index, attempt] += 1
        if self._counts[index, attempt] < _MOST_LOSSES[loss.reason]:
            return item
        self._progress.rejected[reason] += 1
        return replace(item, lost={**item.lost, (index, attempt): reason})
