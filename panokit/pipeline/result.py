"""What became of a run."""

from dataclasses import dataclass, field
from pathlib import Path

from panokit.errors import Rejection
from panokit.pipeline.batch import BatchResult
from panokit.pipeline.settings import MODEL_STAGES
from panokit.records import RunFolder


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """What became of a run.

    Attributes:
        run: Its folder.
        batches: One for each stage that ran, in order.
    """

    run: RunFolder
    batches: tuple[BatchResult, ...] = field(default=())

    @property
    def report(self) -> Path | None:
        """QA's report of the maps, if the run came that far."""
        report = self.run.qa / "report.html"
        return report if report.exists() else None

    @property
    def overview(self) -> Path | None:
        """The report of the run itself."""
        overview = self.run.root / "report.html"
        return overview if overview.exists() else None

    @property
    def rejections(self) -> tuple[Rejection, ...]:
        """Everything that was rejected, stage by stage."""
        return tuple(r for batch in self.batches for r in batch.rejections)

    @property
    def nothing_to_do(self) -> bool:
        """Whether everything was complete before this run began."""
        return not any(batch.fresh for batch in self.batches)

    @property
    def rejected_share(self) -> float:
        """Rejected items over all items that were looked at."""
        pictures = [batch for batch in self.batches if batch.stage not in MODEL_STAGES]
        items = {r.item for batch in pictures for r in batch.receipts}
        rejected = {rejection.item for rejection in self.rejections}
        return len(rejected) / max(1, len(items | rejected))
