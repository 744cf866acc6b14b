"""How surfaces reflect: BRDF times the cosine of incidence, for one view and many lights.

GGX is Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces": their
distribution (33) and separable Smith masking (34). One bounce between the facets is counted
and no more, so a rough metal ball under uniform light is darker than the light, as it is in
renderers that do the same (Mitsuba's `roughconductor`, Cycles' GGX without multiple scattering).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Cosines = NDArray[np.float64]
# (normal . view, normal . light, light . view) -> BRDF x (normal . light), 0 below the surface.
Response = Callable[[Cosines, Cosines, Cosines], Cosines]


def lambertian(view: Cosines, light: Cosines, between: Cosines) -> Cosines:
    """A white matte surface: 1 / pi in every direction."""
    return np.maximum(light, 0) / np.pi + 0 * (view + between)


def metal(alpha: float, normal_reflectance: float = 1.0) -> Response:
    """A GGX metal, with Schlick's Fresnel term when it reflects less than all.

    Args:
        alpha: The roughness of Walter et al.; the square of the roughness of artists' tools.
        normal_reflectance: At normal incidence; 1 at grazing (Schlick 1994).
    """

    def response(view: Cosines, light: Cosines, between: Cosines) -> Cosines:
        towards_half = _half_cosine(between)
        fresnel = normal_reflectance + (1 - normal_reflectance) * schlick(towards_half)
        return fresnel * _ggx(alpha, view, light, between)

    return response


def principled_diffuse(base: float, roughness: float, index: float = 1.5) -> Response:
    """The Principled (Disney) dielectric: Burley's diffuse under a GGX coat.

    Burley 2012, "Physically Based Shading at Disney", with its retro-reflection, and the exact
    Fresnel term of a dielectric for the coat. "Specular 0.5" of artists' tools is index 1.5.
    """
    alpha = roughness**2

    def response(view: Cosines, light: Cosines, between: Cosines) -> Cosines:
        half = _half_cosine(between)
        at_view, at_light = schlick(view), schlick(np.clip(light, 0, 1))
        retro = 2 * roughness * half**2
        diffuse = (1 - at_view / 2) * (1 - at_light / 2)
        diffuse = diffuse + retro * (at_view + at_light + at_view * at_light * (retro - 1))
        coat = _dielectric(half, index) * _ggx(alpha, view, light, between)
        return base / np.pi * diffuse * np.maximum(light, 0) + coat

    return response


def schlick(cosine: Cosines) -> Cosines:
    """Schlick's weight of grazing reflection, (1 - cos)^5."""
    return (1 - cosine) ** 5


def _half_cosine(between: Cosines) -> Cosines:
    """Light . half vector: the cosine of half the angle between light and view."""
    return np.sqrt(np.clip((1 + between) / 2, 0, 1))


def _ggx(alpha: float, view: Cosines, light: Cosines, between: Cosines) -> Cosines:
    """D G / (4 n.v), written so that a grazing view needs no division by zero."""
    length = 2 * _half_cosine(between)
    half = np.clip((view + light) / np.maximum(length, 1e-9), 0, 1)
    distribution = alpha**2 / (np.pi * (half**2 * (alpha**2 - 1) + 1) ** 2)
    lit = np.maximum(light, 0)
    # Smith's G1 is 2 c / (c + sqrt(a^2 + (1 - a^2) c^2)); the view's c cancels n.v.
    masked_view = 2 / (view + np.sqrt(alpha**2 + (1 - alpha**2) * view**2))
    masked_light = 2 * lit / (lit + np.sqrt(alpha**2 + (1 - alpha**2) * lit**2))
    response: Cosines = distribution * masked_view * masked_light / 4
    return response


def _dielectric(cosine: Cosines, index: float) -> Cosines:
    """Fresnel's reflectance for unpolarized light coming from air."""
    inside: Cosines = np.sqrt(1 - (1 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    along = (index * cosine - inside) / (index * cosine + inside)
    reflectance: Cosines = (across**2 + along**2) / 2
    return reflectance
