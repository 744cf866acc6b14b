import numpy as np
import pytest

from panokit.errors import ImageError, UsageError
from panokit.metrics import frechet_distance, side_faces


@pytest.mark.parametrize("variant", ["compat", "fixed"])
def test_diagonal_gaussians_by_hand(variant):
    # d^2 = sum (m - m')^2 + sum (s - s')^2 for independent columns.
    base = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]], np.float64)
    a, b = base * [1, 2] + [0, 0], base * [3, 5] + [10, 0]
    unit = np.sqrt(4 / 3)  # the sample deviation of -1, -1, 1, 1
    expected = 100 + ((3 - 1) * unit) ** 2 + ((5 - 2) * unit) ** 2
    assert frechet_distance(a, b, variant) == pytest.approx(expected, rel=1e-5)


def test_correlated_sets_agree_between_variants_and_equal_ones_are_at_zero():
    random = np.random.default_rng(0)
    a = random.normal(size=(300, 6)) @ random.normal(size=(6, 6))
    b = random.normal(size=(200, 6)) @ random.normal(size=(6, 6)) + 0.5
    assert frechet_distance(a, b) == pytest.approx(frechet_distance(a, b, "compat"), rel=1e-3)
    assert frechet_distance(a, a) == pytest.approx(0, abs=1e-8)
    assert frechet_distance(a, b) == pytest.approx(frechet_distance(b, a))


def test_the_fixed_distance_is_sound_where_covariances_are_singular():
    random = np.random.default_rng(1)
    few = random.normal(size=(5, 20))
    assert frechet_distance(few, few) == pytest.approx(0, abs=1e-6)


def panorama() -> np.ndarray:
    """Display values that grow with azimuth: 0 at the left edge, 1 at the right."""
    return np.linspace(0, 1, 256, dtype=np.float32)[None, :, None].repeat(128, 0).repeat(3, 2)


def test_faces_look_front_right_back_left():
    faces = side_faces(panorama(), size_px=32)
    assert faces.shape == (4, 32, 32, 3)
    front, right, _, left = ((face[16, 16, 0] + 1) / 2 for face in faces)
    assert (front, right, left) == pytest.approx((0.5, 0.75, 0.25), abs=0.02)


def test_compat_mirrors_right_and_back_and_reaches_the_edges():
    compat = side_faces(panorama(), "compat", size_px=33)
    fixed = side_faces(panorama(), size_px=33)
    # Azimuth grows to the right on a true face, and to the left on a mirrored one.
    assert np.diff(fixed[1, 16, :, 0]).min() > 0
    assert np.diff(compat[1, 16, :, 0]).max() < 0
    assert np.diff(compat[0, 16, :, 0]).min() > 0
    # Its outer pixels lie on the face's edge, at 45 degrees: an eighth of a turn from 0.5.
    assert (compat[0, 16, -1, 0] + 1) / 2 == pytest.approx(0.625, abs=0.003)
    assert fixed[0, 16, -1, 0] < compat[0, 16, -1, 0] - 0.002


def test_eight_bit_panoramas_become_minus_one_to_one():
    white = np.full((64, 128, 3), 255, np.uint8)
    assert side_faces(white, size_px=8).min() == pytest.approx(1)
    assert side_faces(white * 0, size_px=8).max() == pytest.approx(-1)


def test_wrong_input_is_refused():
    with pytest.raises(ImageError, match="Tone-map"):
        side_faces(panorama() * 5)
    with pytest.raises(ImageError, match="2 H"):
        side_faces(np.zeros((64, 64, 3), np.uint8))
    with pytest.raises(UsageError, match="two or more rows"):
        frechet_distance(np.ones((1, 4)), np.ones((5, 4)))
    with pytest.raises(UsageError, match="finite"):
        frechet_distance(np.full((3, 2), np.nan), np.ones((3, 2)))
    with pytest.raises(UsageError, match="variant"):
        frechet_distance(np.ones((3, 2)), np.ones((3, 2)), "fid")  # type: ignore[arg-type]
