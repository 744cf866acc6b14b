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
evaluation     models and baselines on a dataset, and all that figures need
speed          latency, operations, memory
verdicts       reproduced, not reproduced or undecided, from paired comparisons
"""
