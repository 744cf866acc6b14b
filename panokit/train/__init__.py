"""Training (torch): from HDR probes to a released ONNX model.

recipe    what decides a model, read from models/<id>/recipe.toml
probes    the HDR probes and their folds
examples  their pictures, pooled to the grid once
augment, losses, loop, ensemble   the training itself
release   ONNX export, parity check, model.toml
folds     a network for each fold that has not seen it, for `panokit evaluate`
stage     training from a recipe and a folder of probes
"""
