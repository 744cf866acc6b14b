"""Relighting by precomputed transport: pictures of known scenes under any map, without a renderer.

operators    the picture, and the linear operator with its adjoint
scenes       the scenes by name
reflectance  the BRDFs
linear       the steps that an operator is a chain of
grids        moving light between maps, rings and pixels with its energy kept
ball         balls by circular convolution, mirror balls by counting
tables       the shipped tables
bake         the script that makes them
"""

from panokit.metrics.transport.operators import Transport, relight, transport
from panokit.metrics.transport.scenes import SCENES

__all__ = ["SCENES", "Transport", "relight", "transport"]
