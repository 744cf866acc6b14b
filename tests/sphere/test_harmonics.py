import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.frames import TOOL_FROM_PANOKIT, Rotation
from panokit.sphere import (
    cosine_factors,
    energy,
    equirect_directions,
    evaluate_harmonics,
    harmonics_basis,
    harmonics_degrees,
    harmonics_for_tool,
    harmonics_from_tool,
    harmonics_map,
    harmonics_order,
    irradiance,
    irradiance_harmonics,
    nonnegative_harmonics,
    project_harmonics,
    rotation_matrices,
    shader_polynomial,
    vmf_factors,
    window_harmonics,
)

POSE = Rotation.from_heading_pitch_roll(0.4, 0.9, -0.3)


def directions(count=50, seed=0):
    found = np.random.default_rng(seed).normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def test_the_first_nine_are_the_table_of_the_docstring():
    x, y, z = directions().T
    one = np.ones_like(x)
    expected = np.stack(
        [
            0.282095 * one,
            0.488603 * x,
            0.488603 * y,
            0.488603 * z,
            1.092548 * z * x,
            1.092548 * x * y,
            0.315392 * (3 * y * y - 1),
            1.092548 * y * z,
            0.546274 * (z * z - x * x),
        ],
        axis=1,
    )
    np.testing.assert_allclose(harmonics_basis(directions(), 2), expected, atol=2e-6)


def test_the_functions_are_orthonormal_at_1024x512():
    basis = harmonics_basis(equirect_directions(1024, 512), 8)
    assert np.abs(project_harmonics(basis, 8) - np.eye(81)).max() < 1e-4


def test_they_are_those_of_scipy():
    from scipy.special import sph_harm_y

    d = directions()
    polar, azimuth = np.arccos(d[:, 1]), np.arctan2(d[:, 0], d[:, 2])
    basis = harmonics_basis(d, 12)
    for degree, m in [(3, 2), (7, 5), (8, 8), (12, 1)]:
        complex_value = sph_harm_y(degree, m, polar, azimuth) * np.sqrt(2) * (-1) ** m
        center = degree * degree + degree
        np.testing.assert_allclose(basis[:, center + m], complex_value.real, atol=1e-12)
        np.testing.assert_allclose(basis[:, center - m], complex_value.imag, atol=1e-12)


def test_high_degrees_stay_finite_and_right_at_the_poles():
    poles = np.array([[0.0, 1, 0], [0, -1, 0]])
    basis = harmonics_basis(poles, 60)
    degree = np.arange(61)
    # Only m = 0 is not zero there: sqrt((2 l + 1) / (4 pi)).
    expected = np.sqrt((2 * degree + 1) / (4 * np.pi))
    np.testing.assert_allclose(basis[0, degree**2 + degree], expected, rtol=1e-11)
    np.testing.assert_allclose((basis**2).sum(axis=1), 61**2 / (4 * np.pi), rtol=1e-11)


@pytest.mark.parametrize("pixels", ["means", "samples"])
def test_a_band_limited_map_comes_back(pixels):
    coefficients = np.random.default_rng(1).normal(size=(81, 3))
    returned = project_harmonics(harmonics_map(coefficients, 128), 8, pixels=pixels)
    limit = 1e-12 if pixels == "samples" else 1e-2
    assert np.abs(returned - coefficients).max() < limit


def test_maps_hold_what_evaluation_says():
    coefficients = np.random.default_rng(1).normal(size=(36, 2))
    expected = evaluate_harmonics(coefficients, equirect_directions(40, 20))
    np.testing.assert_allclose(harmonics_map(coefficients, 40), expected, atol=5e-6)


def test_coefficient_zero_is_the_energy_even_of_a_sun_at_the_pole():
    radiance = np.full((64, 128, 3), 0.3, np.float32)
    radiance[0, 5] = 6e4
    coefficients = project_harmonics(radiance, 4)
    np.testing.assert_allclose(coefficients[0] * np.sqrt(4 * np.pi), energy(radiance), rtol=1e-12)


def test_factors_of_the_cosine_are_the_published_ones():
    published = [np.pi, 2 * np.pi / 3, np.pi / 4, 0, -np.pi / 24, 0, np.pi / 64]
    np.testing.assert_allclose(cosine_factors(6), published, atol=1e-12)
    assert np.isfinite(cosine_factors(400)).all()


def test_irradiance_of_an_analytic_sky():
    # L = 1 + y: E(n) = pi + 2 pi / 3 n_y.
    up = equirect_directions(256, 128)[..., 1:2].astype(np.float64)
    coefficients = irradiance_harmonics(project_harmonics(1 + up, 4, pixels="samples"))
    normals = directions()
    expected = np.pi + 2 * np.pi / 3 * normals[:, 1:2]
    np.testing.assert_allclose(evaluate_harmonics(coefficients, normals), expected, atol=1e-6)


def test_order_eight_gives_the_irradiance_of_a_room_within_a_percent():
    rng = np.random.default_rng(2)
    radiance = rng.gamma(0.3, 1, (32, 64, 3)).repeat(4, 0).repeat(4, 1).astype(np.float32)
    wanted = irradiance(radiance, directions(), exact=True)
    found = evaluate_harmonics(irradiance_harmonics(project_harmonics(radiance, 8)), directions())
    np.testing.assert_allclose(found, wanted, rtol=0.01)


def test_rotation_matrices_are_orthogonal_and_the_first_is_the_rotation():
    matrices = rotation_matrices(POSE, 8)
    np.testing.assert_allclose(matrices[1], POSE.matrix, atol=1e-13)
    for degree, matrix in enumerate(matrices):
        assert matrix.shape == (2 * degree + 1, 2 * degree + 1)
        np.testing.assert_allclose(matrix @ matrix.T, np.eye(len(matrix)), atol=1e-12)


@pytest.mark.parametrize("tool", ["threejs", "blender", "mitsuba"])
def test_a_tool_sees_the_same_light_in_its_own_axes(tool):
    coefficients = np.random.default_rng(3).normal(size=(9, 3))
    theirs = harmonics_for_tool(coefficients, tool)
    x, y, z = TOOL_FROM_PANOKIT[tool].apply(directions()).T
    # three.js, SphericalHarmonics3.getBasisAt.
    basis = [0.282095 + 0 * x, 0.488603 * y, 0.488603 * z, 0.488603 * x]
    basis += [1.092548 * x * y, 1.092548 * y * z, 0.315392 * (3 * z * z - 1)]
    basis += [1.092548 * x * z, 0.546274 * (x * x - y * y)]
    seen = np.stack(basis, axis=1) @ theirs
    np.testing.assert_allclose(seen, evaluate_harmonics(coefficients, directions()), atol=2e-5)
    np.testing.assert_allclose(harmonics_from_tool(theirs, tool), coefficients, atol=1e-12)


def test_the_shader_polynomial_is_what_a_white_matte_surface_reflects():
    radiance = np.random.default_rng(4).gamma(1, 1, (32, 64, 3))
    coefficients = project_harmonics(radiance, 4)
    s = shader_polynomial(coefficients, "threejs")
    normals = directions()
    x, y, z = TOOL_FROM_PANOKIT["threejs"].apply(normals).T
    terms = [1 + 0 * x, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y]
    reflected = np.stack(terms, axis=1) @ s
    expected = evaluate_harmonics(irradiance_harmonics(coefficients[:9]), normals) / np.pi
    np.testing.assert_allclose(reflected, expected, atol=1e-10)


def test_windows_fade_degrees_and_keep_the_energy():
    ones = np.ones((81, 1))
    degree = harmonics_degrees(8)
    hann = window_harmonics(ones, "hann", width=6)[:, 0]
    np.testing.assert_allclose(hann[degree == 3], 0.5)
    assert not hann[degree >= 6].any()
    lanczos = window_harmonics(ones, "lanczos", width=6)[:, 0]
    np.testing.assert_allclose(lanczos[degree == 3], 2 / np.pi)
    gauss = window_harmonics(ones, "gauss", width=4)[:, 0]
    np.testing.assert_allclose(gauss[degree == 2], np.exp(-6 / 32))
    assert hann[0] == lanczos[0] == gauss[0] == 1
    assert (np.diff(window_harmonics(ones, "hann")[:, 0]) <= 0).all()


def test_the_automatic_window_removes_all_negative_light_and_no_more():
    sun = harmonics_basis(np.array([[0.6, 0.7, -0.4]]), 8).T * np.array([5.0, 4, 3])
    assert harmonics_map(sun, 256).min() < -0.5
    clean, width = nonnegative_harmonics(sun)
    assert harmonics_map(clean, 512).min() > -1e-3 * harmonics_map(clean, 512).max()
    np.testing.assert_allclose(clean[0], sun[0])
    weaker = window_harmonics(sun, "gauss", width=width * 1.05)
    assert harmonics_map(weaker, 512).min() < 0
    already, none = nonnegative_harmonics(clean * 1.0 + np.eye(81)[:, :1])
    assert none == np.inf
    np.testing.assert_allclose(already[1:], clean[1:])
    black, _ = nonnegative_harmonics(np.zeros((9, 3)))
    assert not black.any()


def test_vmf_factors_are_right_at_both_ends():
    np.testing.assert_allclose(vmf_factors(0, 4), [1, 0, 0, 0, 0])
    np.testing.assert_allclose(vmf_factors(2.0, 1)[1], 1 / np.tanh(2) - 1 / 2)
    for below, above in [(0.99e-6, 1.01e-6), (0.99e8, 1.01e8)]:
        np.testing.assert_allclose(vmf_factors(below, 8), vmf_factors(above, 8), atol=1e-7)
    assert (vmf_factors(1e300, 8) == 1).all()
    with pytest.raises(UsageError, match="kappa"):
        vmf_factors(-1, 3)


def test_bad_calls_say_what_to_do():
    with pytest.raises(ImageError, match="lower order"):
        project_harmonics(np.ones((8, 16, 3)), 8)
    with pytest.raises(ImageError, match="not finite"):
        project_harmonics(np.full((32, 64, 3), np.nan), 2)
    with pytest.raises(ImageError, match="shape"):
        project_harmonics(np.ones((32, 64)), 2)
    with pytest.raises(UsageError, match="order"):
        harmonics_basis(np.eye(3), -1)
    with pytest.raises(UsageError, match="Directions"):
        harmonics_basis(np.ones(4), 1)
    with pytest.raises(UsageError, match="rows"):
        harmonics_order(np.ones((5, 3)))
    with pytest.raises(UsageError, match="tool"):
        harmonics_for_tool(np.ones((4, 3)), "paint")
    with pytest.raises(UsageError, match="order 2"):
        shader_polynomial(np.ones((4, 3)))
    with pytest.raises(UsageError, match="window"):
        window_harmonics(np.ones((4, 3)), "box")
    with pytest.raises(UsageError, match="width"):
        window_harmonics(np.ones((4, 3)), "hann", width=0)
    with pytest.raises(UsageError, match="mean"):
        nonnegative_harmonics(-np.ones((4, 3)))
