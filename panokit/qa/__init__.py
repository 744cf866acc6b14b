"""QA: is this map good enough to light a scene, and how close is it to its reference?

settings      every threshold
verdicts      figures, limits, verdicts, and the report of one map
measurements  what several checks need of a map, worked out once
radiometry    energy, dynamic range, clipping
encoding      whether values are linear: contrast
sources       lights and ambient light, what expansion did to them, a sun seen twice
daylight      what is up and what is blue
geometry      the wrap seam and the poles
tilt          upright lines and the horizon
content       sharpness, holes, empty areas
sunlight      the map's sun against the sky's, with sun_hypotheses on what may be wrong
plausibility  the map among captured maps, those of reference_set
checks        the table of checks; `check` and `judge`
comparison    a map against the map it should be
distribution  a map among maps of other places
items         what to judge
batch         `qa`: many maps, with references
report        the HTML report and qa.json
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.qa.batch import JudgedMap, QaResult, judge_item, qa
    from panokit.qa.checks import check, judge
    from panokit.qa.comparison import Comparison, compare
    from panokit.qa.items import QaItem, find_items
    from panokit.qa.report.write import write_report
    from panokit.qa.settings import QaSettings
    from panokit.qa.verdicts import Check, Report, Verdict

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Check": "panokit.qa.verdicts",
        "Comparison": "panokit.qa.comparison",
        "JudgedMap": "panokit.qa.batch",
        "QaItem": "panokit.qa.items",
        "QaResult": "panokit.qa.batch",
        "QaSettings": "panokit.qa.settings",
        "Report": "panokit.qa.verdicts",
        "Verdict": "panokit.qa.verdicts",
        "check": "panokit.qa.checks",
        "compare": "panokit.qa.comparison",
        "find_items": "panokit.qa.items",
        "judge": "panokit.qa.checks",
        "judge_item": "panokit.qa.batch",
        "qa": "panokit.qa.batch",
        "write_report": "panokit.qa.report.write",
    },
)
