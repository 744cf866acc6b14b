"""Turn harmonics, and hand them to tools with other axes: exact, degree by degree.

A turned function of degree l is a sum of functions of degree l, so a rotation is one small
matrix per degree and loses nothing, unlike rotating pixels.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import UsageError
from panokit.frames import TOOL_FROM_PANOKIT, Rotation
from panokit.sphere.harmonics import (
    Coefficients,
    harmonics_basis,
    harmonics_degrees,
    harmonics_order,
)
from panokit.sphere.harmonics_filters import cosine_factors

# Most tools write the functions with their z axis as the pole: y, z, x in degree 1. This turns
# a direction in such axes into the one at which our function of the same index is equal to it.
_OURS_FROM_POLAR_Z = Rotation(np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]]))


def rotation_matrices(target_from_source: Rotation, order: int) -> list[NDArray[np.float64]]:
    """The matrix of each degree, (2 l + 1, 2 l + 1) for l = 0 .. order, orthogonal.

    Entry (i, j) is the integral of Y_j(d) Y_i(R d). The product is a polynomial of degree
    2 l, so a Gauss-Legendre rule of order + 1 rows and 2 order + 2 columns gives it exactly.
    """
    nodes, weighted = _quadrature(order)
    turned = harmonics_basis(target_from_source.apply(nodes), order)
    return [
        turned[:, degree**2 : (degree + 1) ** 2].T @ weighted[:, degree**2 : (degree + 1) ** 2]
        for degree in range(order + 1)
    ]


def rotate_harmonics(
    coefficients: NDArray[np.floating[Any]], target_from_source: Rotation
) -> Coefficients:
    """The coefficients of a rotated map, without touching the map.

    Args:
        coefficients: ((order + 1)^2, C).
        target_from_source: As in `rotate_radiance`: what was in direction d is then in
            `target_from_source.apply(d)`.

    Returns:
        ((order + 1)^2, C) float64.
    """
    coefficients = np.asarray(coefficients, np.float64)
    order = harmonics_order(coefficients)
    rotated = np.empty_like(coefficients)
    for degree, matrix in enumerate(rotation_matrices(target_from_source, order)):
        band = slice(degree**2, (degree + 1) ** 2)
        rotated[band] = matrix @ coefficients[band]
    return rotated


def harmonics_for_tool(coefficients: NDArray[np.floating[Any]], tool: str) -> Coefficients:
    """The coefficients in a tool's axes and in the common order of functions.

    The common functions have the tool's z axis as their pole: in degree 1 they are y, z, x,
    in degree 2 xy, yz, 3 z^2 - 1, xz, x^2 - y^2, all with positive factors. three.js keeps
    such coefficients of radiance in `LightProbe.sh`, nine rows of RGB: order 2.

    Args:
        coefficients: ((order + 1)^2, C), panokit's.
        tool: A key of `panokit.frames.TOOL_FROM_PANOKIT`, such as "threejs" or "blender";
            "panokit" keeps the axes and changes the order of functions only.
    """
    return rotate_harmonics(coefficients, _OURS_FROM_POLAR_Z @ _tool_axes(tool))


def harmonics_from_tool(coefficients: NDArray[np.floating[Any]], tool: str) -> Coefficients:
    """The inverse of `harmonics_for_tool`."""
    return rotate_harmonics(coefficients, (_OURS_FROM_POLAR_Z @ _tool_axes(tool)).inverse)


def shader_polynomial(
    coefficients: NDArray[np.floating[Any]], tool: str = "panokit"
) -> Coefficients:
    """What a shader needs for diffuse light: the light that a white matte surface reflects.

    The radiance reflected by a Lambertian surface of albedo 1 and unit normal n = (x, y, z)
    in the tool's axes is, with the rows s of the result,

        s0 + s1 y + s2 z + s3 x + s4 xy + s5 yz + s6 (3 z^2 - 1) + s7 xz + s8 (x^2 - y^2)

    (Ramamoorthi and Hanrahan 2001, with the factors of the functions and 1/pi multiplied in:
    the form in which Filament takes the irradiance of an indirect light.)

    Args:
        coefficients: Of radiance, panokit's, of order 2 at least.
        tool: Whose axes n is in.

    Returns:
        (9, C) float64.
    """
    if harmonics_order(np.asarray(coefficients)) < 2:
        raise UsageError("A shader's polynomial needs harmonics of order 2 or more.")
    turned = harmonics_for_tool(np.asarray(coefficients)[:9], tool)
    turned *= (cosine_factors(2)[harmonics_degrees(2)] / np.pi)[:, None]
    one, axis, mixed = np.sqrt(np.array([1, 3, 15]) / (4 * np.pi))
    flat = np.sqrt(5 / (16 * np.pi))
    factors = np.array([one, *[axis] * 3, mixed, mixed, flat, mixed, mixed / 2])
    return np.asarray(turned * factors[:, None], np.float64)


def _tool_axes(tool: str) -> Rotation:
    if tool not in TOOL_FROM_PANOKIT:
        raise UsageError(f"Unknown tool {tool!r}: choose from {', '.join(TOOL_FROM_PANOKIT)}.")
    return TOOL_FROM_PANOKIT[tool]


@lru_cache(maxsize=8)
def _quadrature(order: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions, and the functions there times the rule's weights."""
    up, weights = np.polynomial.legendre.leggauss(order + 1)
    columns = 2 * order + 2
    phi = np.arange(columns) * (2 * np.pi / columns)
    horizontal = np.sqrt(1 - up**2)[:, None]
    nodes = np.stack(
        [
            horizontal * np.sin(phi),
            np.broadcast_to(up[:, None], (order + 1, columns)),
            horizontal * np.cos(phi),
        ],
        axis=-1,
    ).reshape(-1, 3)
    shares = np.repeat(weights, columns) * (2 * np.pi / columns)
    return nodes, harmonics_basis(nodes, order) * shares[:, None]
