import cv2
import numpy as np

from panokit.inpaint.texture import texture


def gravel(size=192, seed=1):
    rng = np.random.default_rng(seed)
    noise = cv2.GaussianBlur(rng.normal(0, 1, (size, size)).astype(np.float32), (0, 0), 1.2)
    return np.clip(120 + 90 * noise[..., None] + np.array([6, 0, -8]), 0, 235).astype(np.uint8)


def disc(size, radius):
    y, x = np.mgrid[:size, :size] - size / 2
    return np.hypot(x, y) < radius


def roughness(picture, where):
    gray = np.asarray(picture, np.float32).mean(axis=-1)
    return np.abs(cv2.Laplacian(gray, cv2.CV_32F))[where].mean()


def test_known_pixels_stay_and_the_hole_is_as_rough_as_its_surroundings():
    picture = gravel()
    hole = disc(192, 40)
    covered = picture.copy()
    covered[hole] = 0
    filled = texture(covered.astype(np.float32), ~hole)
    assert np.array_equal(filled[~hole], picture[~hole])
    inner, outer = disc(192, 36), ~disc(192, 44)
    assert 0.8 < roughness(filled, inner) / roughness(picture, outer) < 1.25


def test_sharp_also_where_the_view_is_larger_than_it_is_searched():
    picture = gravel(560)
    hole = disc(560, 110)
    filled = texture(np.where(hole[..., None], 0, picture).astype(np.float32), ~hole)
    inner, outer = disc(560, 100), ~disc(560, 120)
    assert 0.8 < roughness(filled, inner) / roughness(picture, outer) < 1.25


def test_stripes_go_on_through_the_hole():
    stripes = np.zeros((128, 128, 3), np.uint8)
    stripes[:, (np.arange(128) // 8) % 2 == 0] = 180
    hole = disc(128, 20)
    filled = texture(np.where(hole[..., None], 0, stripes).astype(np.float32), ~hole)
    assert np.abs(filled - stripes)[hole].mean() < 12


def test_the_same_hole_is_filled_in_the_same_way():
    picture, hole = gravel(96), disc(96, 20)
    first = texture(picture.astype(np.float32), ~hole)
    cv2.setRNGSeed(4711)
    assert np.array_equal(first, texture(picture.astype(np.float32), ~hole))


def test_what_is_in_the_hole_is_not_copied_anywhere():
    picture = gravel(448)
    hole = disc(448, 70)
    hole[40:90, 200:240] = True
    picture[hole] = (255, 0, 255)
    filled = texture(picture.astype(np.float32), ~hole)
    magenta = (filled[..., 0] + filled[..., 2]) / 2 - filled[..., 1]
    assert magenta[hole].max() < 30


def test_a_lamp_is_never_copied():
    picture = gravel(128)
    for x, y in ((16, 20), (100, 24), (108, 100), (20, 104), (64, 12), (64, 114)):
        cv2.circle(picture, (x, y), 4, (255, 255, 255), -1)
    hole = disc(128, 30)
    filled = texture(np.where(hole[..., None], 0, picture).astype(np.float32), ~hole)
    assert filled.min(axis=2)[hole].max() < 240


def test_too_little_to_copy_from_is_said():
    known = np.zeros((64, 64), bool)
    known[:4] = True
    assert texture(gravel(64).astype(np.float32), known) is None
