"""Even out the light where copies from different places meet.

Each copy brings the light of where it is from, and two of them side by side show a step that
neither had. A smooth correction takes the steps away: the one whose differences between
neighbors come closest to undoing them, and which is zero where the picture is known (Perez
et al. 2003, "Poisson Image Editing", on the correction in place of the picture).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, identity
from scipy.sparse.linalg import splu

# A step larger than this, in gray levels, is an edge of the scene and stays one: smoothed
# out, it would bleed into its surroundings.
_LARGEST_STEP = 24.0
# Pulls the correction to zero over some 60 pixels, so that it cannot run away.
_RESTRAINT = 3e-4


def seam_correction(
    picture: NDArray[np.float32],
    known: NDArray[np.bool_],
    column: NDArray[np.int32],
    row: NDArray[np.int32],
) -> NDArray[np.float32]:
    """What to add to the copies so that they meet each other and the picture.

    Args:
        picture: (H, W, C) float32; values where not known are ignored.
        known: (H, W) bool.
        column: (H, W), from where each pixel is copied; its own where it is known.
        row: (H, W), likewise.

    Returns:
        (H, W, C) float32, zero where known.
    """
    correction = np.zeros_like(picture)
    count = int((~known).sum())
    if not count:
        return correction
    number = np.full(known.shape, -1)
    number[~known] = np.arange(count)
    matrix = csc_array(identity(count) * _RESTRAINT)
    target = np.zeros((count, picture.shape[2]))
    for down, right in ((0, 1), (1, 0)):
        first = np.s_[: known.shape[0] - down, : known.shape[1] - right]
        second = np.s_[down:, right:]
        step = _steps(picture, known, column, row, (down, right))
        a, b = number[first].ravel(), number[second].ravel()
        pair = (a >= 0) | (b >= 0)
        edges, wanted = _differences(a[pair], b[pair], count), step.reshape(len(pair), -1)[pair]
        matrix = matrix + edges.T @ edges
        target += edges.T @ wanted
    correction[~known] = splu(csc_array(matrix)).solve(target)
    return correction


def _differences(a: NDArray[np.intp], b: NDArray[np.intp], count: int) -> csc_array:
    """The matrix that takes second minus first of each pair; known pixels (-1) count as zero."""
    pair = np.arange(len(a))
    rows = np.concatenate([pair[a >= 0], pair[b >= 0]])
    columns = np.concatenate([a[a >= 0], b[b >= 0]])
    signs = np.concatenate([-np.ones((a >= 0).sum()), np.ones((b >= 0).sum())])
    return csc_array(coo_array((signs, (rows, columns)), shape=(len(a), count)))


def _steps(
    picture: NDArray[np.float32],
    known: NDArray[np.bool_],
    column: NDArray[np.int32],
    row: NDArray[np.int32],
    offset: tuple[int, int],
) -> NDArray[np.float32]:
    """By how much neighbors should differ more than they do, from first to second.

    They should differ as they do where either of them was copied from.
    """
    height, width = known.shape
    down, right = offset
    first, second = np.s_[: height - down, : width - right], np.s_[down:, right:]
    copied = picture[row, column]
    wanted = np.zeros_like(copied[first])
    votes = np.zeros(wanted.shape[:2], np.float32)
    for own, sign in ((first, 1), (second, -1)):
        beside_row = np.clip(row[own] + sign * down, 0, height - 1)
        beside_column = np.clip(column[own] + sign * right, 0, width - 1)
        usable = ~known[own] & known[beside_row, beside_column]
        difference = sign * (picture[beside_row, beside_column] - copied[own])
        wanted += difference * usable[..., None]
        votes += usable
    wanted /= np.maximum(votes, 1)[..., None]
    step = wanted - (copied[second] - copied[first])
    step[(votes == 0) | (np.abs(step).max(axis=-1) > _LARGEST_STEP)] = 0
    return np.asarray(step, np.float32)
