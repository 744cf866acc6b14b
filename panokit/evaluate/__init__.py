"""How good methods are, measured on data that they have not seen; never torch.

probe_set     the HDR probes and their folds
"""
