"""What makes samples: a small value that is sent to every worker once."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from panokit.dataset.sample import Sample


class SampleMaker(Protocol):
    """Makes any sample of a dataset, in any process; picklable."""

    def describe(self) -> Mapping[str, Any]:
        """All that decides the samples' bytes, for dataset.json: equal makers say the same."""
        ...

    def split_of(self, index: int) -> str:
        """The split of a sample, whatever the attempt."""
        ...

    def seed_of(self, index: int, attempt: int) -> Sequence[int]:
        """What an attempt's random numbers start from, to repeat a failure."""
        ...

    def make(self, index: int, attempt: int) -> Sample:
        """Make a sample.

        Raises:
            ItemError: If this attempt gives none; another one may.
        """
        ...
