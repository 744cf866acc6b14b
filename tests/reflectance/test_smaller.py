"""Pictures and normals at another size: means that stay what they are."""

import numpy as np

from panokit.reflectance import hemisphere_normals
from panokit.reflectance.smaller import smaller_normals, smaller_picture, unit_normals


def test_a_smaller_picture_is_means():
    picture = np.random.default_rng(0).integers(0, 256, (32, 32, 3), dtype=np.uint8)
    means = picture.astype(float).reshape(16, 2, 16, 2, 3).mean(axis=(1, 3))
    assert np.abs(smaller_picture(picture, 16) - means).max() <= 0.5
    assert smaller_picture(picture, 32) is picture


def test_smaller_normals_are_unit_and_look_the_same_way():
    normals, _ = hemisphere_normals(128)
    small = smaller_normals(normals, 32)
    there = small.any(axis=-1)
    np.testing.assert_allclose(np.linalg.norm(small[there], axis=-1), 1, atol=1e-5)
    coarse, inside = hemisphere_normals(32)
    both = there & inside
    assert both.sum() > 0.95 * inside.sum()
    assert (small * coarse).sum(axis=-1)[both].min() > np.cos(np.deg2rad(5))
    assert smaller_normals(normals, 128) is normals


def test_what_is_mostly_beside_the_object_has_no_normal():
    normals = np.zeros((2, 4, 3), np.float32)
    normals[0, :, 2], normals[1, 0, 2] = (1, 1, 1, 0), 1
    # Three of four pixels on the left, one of four on the right.
    means = np.stack([normals[:, :2].mean(axis=(0, 1)), normals[:, 2:].mean(axis=(0, 1))])
    np.testing.assert_array_equal(unit_normals(means[None])[0], [[0, 0, 1], [0, 0, 0]])
