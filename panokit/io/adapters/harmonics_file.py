"""Spherical harmonics as JSON, with the convention written beside the numbers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.envmap import EnvironmentMap
from panokit.errors import RecordError
from panokit.io.adapters.analytic_sun import AnalyticSun
from panokit.sphere import irradiance_harmonics, project_harmonics, shader_polynomial

SCHEMA = "panokit.harmonics/1"
CONVENTION = (
    "Real, orthonormal spherical harmonics without the Condon-Shortley sign, pole +Y. Function "
    "(l, m) has index l (l + 1) + m. Axes: +X right (east), +Y up, -Z forward (north). Degree 1 is "
    "0.488603 times x, y, z. Radiance in direction d is the sum of coefficient times function."
)
POLYNOMIAL = (
    "Radiance that a white matte surface of unit normal (x, y, z) reflects: s0 + s1 y + s2 z "
    "+ s3 x + s4 xy + s5 yz + s6 (3 z^2 - 1) + s7 xz + s8 (x^2 - y^2)."
)


def harmonics_json(
    envmap: EnvironmentMap, *, order: int = 8, sun: AnalyticSun | None = None
) -> dict[str, Any]:
    """The harmonics of a map as a dictionary for `json.dump`.

    Args:
        envmap: The map, of more than 4 `order` columns.
        order: The highest degree.
        sun: The sun beside it, for a map without its sun.

    Returns:
        Coefficients of radiance and of irradiance, (order + 1)^2 rows of RGB each, from order
        2 on the nine numbers that shaders take, and the convention in words.

    Raises:
        ImageError: If the map is too small for the order.
    """
    coefficients = project_harmonics(envmap.radiance, order)
    value: dict[str, Any] = {
        "schema": SCHEMA,
        "convention": CONVENTION,
        "order": order,
        "frame": str(envmap.frame),
        "anchor": str(envmap.anchor),
        "radiance_rgb": _rows(coefficients),
        "irradiance_rgb": _rows(irradiance_harmonics(coefficients)),
        "sun": sun and sun.to_json(),
    }
    if order >= 2:
        value["diffuse_polynomial"] = POLYNOMIAL
        value["diffuse_polynomial_rgb"] = _rows(shader_polynomial(coefficients))
    return value


def harmonics_from_json(value: Any) -> NDArray[np.float64]:
    """The coefficients of radiance in such a dictionary, ((order + 1)^2, 3) float64.

    Raises:
        RecordError: If it is none.
    """
    if not isinstance(value, dict) or value.get("schema") != SCHEMA:
        raise RecordError(
            "This file holds no harmonics of panokit. Export them with: panokit probes export "
            "LIBRARY --to harmonics --out DIR",
            reason="no-harmonics",
        )
    try:
        rows = np.asarray(value["radiance_rgb"], np.float64)
        return rows.reshape((int(value["order"]) + 1) ** 2, 3)
    except (KeyError, TypeError, ValueError) as error:
        raise RecordError(
            f"The file of harmonics is damaged ({error!r}). Export it again.",
            reason="damaged-harmonics",
        ) from error


def _rows(coefficients: NDArray[np.float64]) -> list[list[float]]:
    return [[float(f"{float(value):.9g}") for value in row] for row in coefficients]
