"""How good methods are, measured on data that they have not seen; never torch.

probe_set         the HDR probes and their folds
predictors        what can be judged: analytic methods, models; `peers` anything else
area_fit          the area rule, fitted to the other folds
scoring           one method on one picture
cache             scores kept while a run goes on
expansion         all methods on all pictures
figures           from scores to lines of the table
pairs             two methods on the same pictures
expansion_report  the table, as JSON and Markdown
calibration       how sure a model that reads light may be
real              pairs of photographs with measured light, out of published data sets
rendering         the light that explains both views, the shape known
settings          of `panokit evaluate expansion`
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.evaluate.expansion import EvaluationResult as EvaluationResult
    from panokit.evaluate.expansion import evaluate_expansion as evaluate_expansion
    from panokit.evaluate.expansion_report import write_evaluation as write_evaluation
    from panokit.evaluate.peers import command_method as command_method
    from panokit.evaluate.peers import onnx_method as onnx_method
    from panokit.evaluate.predictors import Method as Method
    from panokit.evaluate.predictors import Predictor as Predictor
    from panokit.evaluate.predictors import model_method as model_method
    from panokit.evaluate.settings import ExpansionEvaluation as ExpansionEvaluation

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "EvaluationResult": "panokit.evaluate.expansion",
        "ExpansionEvaluation": "panokit.evaluate.settings",
        "Method": "panokit.evaluate.predictors",
        "Predictor": "panokit.evaluate.predictors",
        "command_method": "panokit.evaluate.peers",
        "evaluate_expansion": "panokit.evaluate.expansion",
        "model_method": "panokit.evaluate.predictors",
        "onnx_method": "panokit.evaluate.peers",
        "write_evaluation": "panokit.evaluate.expansion_report",
    },
)
