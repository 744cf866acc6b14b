"""What fetching would take: files, bytes, money and days; what a dry run finds out."""

from collections.abc import Sequence
from dataclasses import dataclass

from panokit.fetch.prices import Price
from panokit.fetch.provider import Found


@dataclass(frozen=True, slots=True, kw_only=True)
class FetchPlan:
    """What fetching takes: what a dry run finds out.

    Attributes:
        panoramas: Not on disk yet.
        files: One request for each; searching is done.
        unit: What a file is: "tile", "view", "picture".
        bytes: About how much comes over the network.
        cost_usd: By list price, as if nothing were free.
        free_files: So many a month cost nothing, if nobody else uses them.
        quota_share: Of the source's usual daily quota; 1 is all of it, None where it has none.
        days_at_quota: How many days the usual quota takes, None where it has none.
    """

    panoramas: int = 0
    files: int = 0
    unit: str = "file"
    bytes: int = 0
    cost_usd: float = 0.0
    free_files: int = 0
    quota_share: float | None = None
    days_at_quota: int | None = None

    @property
    def least_cost_usd(self) -> float:
        """The cost if all of the month's free files are still there."""
        if self.files == 0:
            return 0.0
        return self.cost_usd * max(self.files - self.free_files, 0) / self.files


def plan_of(planned: Sequence[Found], price: Price) -> FetchPlan:
    """What fetching these pictures takes at this price."""
    files = sum(len(found.files) for found in planned)
    return FetchPlan(
        panoramas=len(planned),
        files=files,
        unit=price.unit,
        bytes=sum(found.bytes for found in planned),
        cost_usd=files * price.usd_per_unit,
        free_files=price.free_per_month,
        quota_share=files / price.per_day if price.per_day else None,
        days_at_quota=-(-files // price.per_day) if price.per_day else None,
    )
