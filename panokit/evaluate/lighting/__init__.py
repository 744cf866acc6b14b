"""How well the light of a scene is read from two views of an object.

sample      what a predictor is given, and the truth that it is not given
predictors  networks and baselines behind one protocol, by name
baselines   what knows only the training maps, or one color
background  the light that the background alone shows
inversion   the light that explains an object's pixels, its normals known
scoring     all figures of one prediction
verdicts    reproduced, not reproduced or undecided, from paired comparisons
"""
