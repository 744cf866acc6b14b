import numpy as np

from panokit.inpaint.adjust import adjusted_offsets
from panokit.inpaint.offsets import candidate_offsets
from panokit.inpaint.sources import highlights, strangeness, uniqueness

SIZE = 96


def disc(radius, size=SIZE):
    y, x = np.mgrid[:size, :size] - size / 2
    return np.hypot(x, y) < radius


def paving(period=13, size=SIZE, shade=3.0):
    rng = np.random.default_rng(0)
    y, x = np.mgrid[:size, :size]
    level = 120 + 60 * ((x % period < 2) | (y % period < 2)) + rng.normal(0, shade, (size, size))
    return np.repeat(level[..., None], 3, axis=2).astype(np.float32)


def test_the_period_of_a_paving_comes_first():
    hole = disc(14)
    offsets = candidate_offsets(paving(), hole, ~hole, 6)
    assert len(offsets) > 5
    assert all(max(min(d % 13, -d % 13), min(r % 13, -r % 13)) == 0 for d, r in offsets[:5])


def test_shifts_reach_from_what_is_known_into_the_hole():
    hole = disc(14)
    source = ~hole
    source[:, SIZE // 2 :] = False
    for _, right in candidate_offsets(paving(), hole, source, 6):
        assert right < 14


def test_where_nothing_may_be_copied_there_is_no_shift():
    hole = disc(14)
    assert candidate_offsets(paving(), hole, np.zeros_like(hole), 6) == []


def test_shifts_are_adjusted_to_the_pixel():
    full, hole = paving(period=26, size=192), disc(28, 192)
    small_hole = disc(8, 48)
    shifts = np.zeros((48, 48, 2), np.int32)
    shifts[small_hole] = (0, 20)  # 80 full pixels, two from three periods
    adjusted = adjusted_offsets(full, ~hole, shifts, small_hole)
    assert np.array_equal(np.unique(adjusted[small_hole], axis=0), [[0, 78]])


def test_what_is_there_only_once_is_unique_and_what_looks_like_nothing_is_strange():
    picture, hole = paving(), disc(12)
    picture[4:16, 4:16] = (250, 40, 20)
    known = ~hole
    offsets = [(0, 26), (26, 0), (39, 39), (0, -39)]
    unique = uniqueness(picture, known, hole, offsets)
    strange = strangeness(picture, known, hole)
    lump = np.s_[7:13, 7:13]
    assert unique[lump].min() > 20
    assert strange[lump].min() > 2
    assert np.median(unique[known]) == 0
    assert np.median(strange[known]) == 0


def test_lamps_are_found_and_white_walls_are_not():
    picture, known = paving(), np.ones((SIZE, SIZE), bool)
    picture[20:24, 20:24] = 255
    assert highlights(picture, known)[20:24, 20:24].all()
    picture[:, 40:] = 255
    assert not highlights(picture, known).any()
