"""How well the light of a scene is read from two views of an object.

sample         what a predictor is given, and the truth that it is not given
predictors     networks and baselines behind one protocol, by name
models         what a model is and how it was trained, from its folder
baselines      what knows only the training maps, or one color
background     the light that the background alone shows
inversion      the light that explains an object's pixels, its normals known
controls       the second view, the normals or the materials spoiled
scoring        all figures of predictions
published      the protocols of others on the same predictions
run            results.jsonl: what is scored is not scored again
kept           pictures and predictions of a few samples, for figures
speed          latency, operations, memory
dataset_facts  what a dataset holds
evaluation     models and baselines on a dataset, and all that figures need
terminal       a few figures, on 80 columns

and from the evaluation's folder alone:

outcome        entrants with their seeds, their scores and curves
experiments    the suite's experiments by name
verdicts       reproduced, not reproduced or undecided, from paired comparisons
statements     what the thesis says, and how it came out
tables         a table as text; score_tables, model_tables and comparison_tables make them
figures        the figures, a module each
pack           all figures and tables
lighting_report the same as a page
"""
