"""What becomes of a shard whose worker died or hung."""

from collections import Counter
from dataclasses import replace

from panokit.dataset.attempts import SampleEvent
from panokit.dataset.progress import Progress
from panokit.dataset.shard_task import ShardItem
from panokit.engine import Loss
from panokit.errors import PanokitError
from panokit.records import RunFolder

# A worker that dies may have been killed by chance; one that hangs hardly hangs by chance.
_MOST_LOSSES = {"died": 3, "silent": 2}
_REASONS = {"died": "worker-died", "silent": "timeout"}


class LossPolicy:
    """Tries an attempt again whose worker was lost, and gives it up if that happens again.

    Args:
        progress: Notes the losses.
        run: Logs them.
        timeout_s: For the message.
    """

    def __init__(self, progress: Progress, run: RunFolder, timeout_s: float) -> None:
        self._progress, self._run, self._timeout_s = progress, run, timeout_s
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
        index, attempt = (event.index, event.attempt) if event else (item.indices[0], 0)
        self._progress.lose(
            SampleEvent(kind="failed", index=index, attempt=attempt, reason=reason, message=message)
        )
        if event is None or event.kind != "started":
            # Between samples, as when the shard is written: no sample is to blame.
            self._between[item.path.stem] += 1
            if self._between[item.path.stem] >= _MOST_LOSSES[loss.reason]:
                raise PanokitError(
                    f"The worker that writes the shard {item.path.stem} was lost "
                    f"{self._between[item.path.stem]} times: {message}. Look for a lack of memory "
                    "or a failing disk; what was done is kept."
                )
            return item
        self._counts[index, attempt] += 1
        if self._counts[index, attempt] < _MOST_LOSSES[loss.reason]:
            return item
        self._progress.rejected[reason] += 1
        return replace(item, lost={**item.lost, (index, attempt): reason})
