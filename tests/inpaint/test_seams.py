import numpy as np

from panokit.inpaint.seams import seam_correction

SIZE = 48


def copied_block(shift):
    """A hole in the middle, copied from `shift` pixels to the right."""
    row, column = np.mgrid[:SIZE, :SIZE].astype(np.int32)
    known = np.ones((SIZE, SIZE), bool)
    known[18:30, 12:22] = False
    return known, np.where(known, column, column + shift).astype(np.int32), row


def test_copies_from_a_brighter_place_become_as_bright_as_where_they_go():
    known, column, row = copied_block(14)
    plane = np.arange(SIZE, dtype=np.float32)[None, :, None] * np.ones((SIZE, 1, 3), np.float32)
    correction = seam_correction(plane, known, column, row)
    copied = plane[row, column]
    before = np.abs(copied - plane)[~known].max()
    after = np.abs(copied + correction - plane)[~known].max()
    assert before == 14
    assert after < 1
    assert np.all(correction[known] == 0)


def test_an_edge_of_the_scene_does_not_bleed():
    known, column, row = copied_block(14)
    picture = np.full((SIZE, SIZE, 3), 40, np.float32)
    picture[:, 23:] = 200
    assert np.all(seam_correction(picture, known, column, row) == 0)


def test_where_nothing_was_copied_there_is_nothing_to_correct():
    row, column = np.mgrid[:8, :8].astype(np.int32)
    picture = np.random.default_rng(0).uniform(0, 255, (8, 8, 3)).astype(np.float32)
    assert np.all(seam_correction(picture, np.ones((8, 8), bool), column, row) == 0)
