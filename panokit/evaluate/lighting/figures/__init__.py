"""The figures of an evaluation, one function each; matplotlib is loaded when one is drawn.

drawing  panels, colors, files
curves   F5.1 to F5.6: validation over epochs, seeds as bands
spread   F5.7 to F5.10: bars and distributions of scores
sweeps   normals, memory, controls
sheets   pictures: contact sheets, scenes in predicted light, brackets, the dataset
probes   the light of the splits
"""
