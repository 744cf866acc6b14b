"""Whole runs and batches: the only part that knows both files and stages.

settings    what a pipeline's TOML file says
load        TOML -> settings, with line numbers and near names
runner      a run from places to light probes, and on to models
beforehand  what can be found out before it begins; result, what became of it
fetching    the fetch stage of a run; serving, its server where it has one of its own
judging     QA, its report and the library of a run
references  maps of true range; modelling, datasets and models of all arms; judging_models, scores
once        work with a record beside its folder
reporting   the report of a run
planning    what it would take; costs, what planning knows of the stages
status      how far it is; orphans, what belongs to nothing any more
publishing  what it made, copied to where others read it
batch       many items through one stage, skipping what is complete
tasks       one item through one stage
inputs      what a stage's command works on
adding      maps into a library; pulling, those of Poly Haven
demo        the embedded city, all the way
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.pipeline.batch import BatchResult, run_batch
    from panokit.pipeline.demo import run_demo
    from panokit.pipeline.load import load_settings
    from panokit.pipeline.result import RunResult
    from panokit.pipeline.runner import run_pipeline
    from panokit.pipeline.settings import PipelineSettings

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "BatchResult": "panokit.pipeline.batch",
        "PipelineSettings": "panokit.pipeline.settings",
        "RunResult": "panokit.pipeline.result",
        "load_settings": "panokit.pipeline.load",
        "run_batch": "panokit.pipeline.batch",
        "run_demo": "panokit.pipeline.demo",
        "run_pipeline": "panokit.pipeline.runner",
    },
)
