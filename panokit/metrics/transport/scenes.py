"""The scenes by name: what each is made of and how finely its table is baked."""

from dataclasses import dataclass

from panokit.metrics.transport.reflectance import (
    Response,
    lambertian,
    metal,
    principled_diffuse,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RoughBall:
    """A ball whose response is a table.

    Attributes:
        response: Its BRDF times the cosine of incidence.
        radii: Normals in the table, from facing the camera to the rim.
        rings: Rings of light, from the camera to behind the ball.
        orders: Fourier orders kept around the axis.
    """

    response: Response
    radii: int
    rings: int
    orders: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MirrorBall:
    """A ball that needs no table.

    Attributes:
        normal_reflectance: 1 for a perfect mirror, else Schlick's at normal incidence.
    """

    normal_reflectance: float


ROUGH_BALLS = {
    "diffuse": RoughBall(response=lambertian, radii=64, rings=96, orders=32),
    "glossy-0.1": RoughBall(response=metal(0.1), radii=96, rings=128, orders=128),
    "glossy-0.3": RoughBall(response=metal(0.3), radii=64, rings=96, orders=48),
    "glossy-0.6": RoughBall(response=metal(0.6), radii=64, rings=96, orders=32),
    # The three spheres of StyleLight: roughness 0.3271 of a metal, 0.364 of a dielectric.
    "matte-silver": RoughBall(response=metal(0.3271**2, 0.8), radii=96, rings=128, orders=128),
    "principled-diffuse": RoughBall(
        response=principled_diffuse(0.8, 0.364), radii=96, rings=128, orders=112
    ),
}
MIRROR_BALLS = {
    "mirror": MirrorBall(normal_reflectance=1.0),
    "mirror-silver": MirrorBall(normal_reflectance=0.8),
}
PLANE = "plane"
SCENES = (
    "diffuse",
    "glossy-0.1",
    "glossy-0.3",
    "glossy-0.6",
    "mirror",
    "mirror-silver",
    "matte-silver",
    "principled-diffuse",
    PLANE,
)
