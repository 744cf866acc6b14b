"""Pairs: maps against the maps they should be, where truth exists.

aligning   one frame, one size, one scale
scoring    every protocol of `panokit.metrics`, and summaries of many pairs
pictures   known scenes under the truth and under the estimate
judging    which truth belongs to which map; `judge_pairs`
showing    the sections of a report
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.qa.pairs.aligning import AlignedPair, align_pair
    from panokit.qa.pairs.judging import (
        Matches,
        PairResults,
        judge_pairs,
        match_truths,
        score_pair,
    )
    from panokit.qa.pairs.pictures import relit_sheet
    from panokit.qa.pairs.scoring import PairScore

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "AlignedPair": "panokit.qa.pairs.aligning",
        "Matches": "panokit.qa.pairs.judging",
        "PairResults": "panokit.qa.pairs.judging",
        "PairScore": "panokit.qa.pairs.scoring",
        "align_pair": "panokit.qa.pairs.aligning",
        "judge_pairs": "panokit.qa.pairs.judging",
        "match_truths": "panokit.qa.pairs.judging",
        "relit_sheet": "panokit.qa.pairs.pictures",
        "score_pair": "panokit.qa.pairs.judging",
    },
)
