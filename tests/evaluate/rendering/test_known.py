"""Objects of samples, rebuilt."""

import numpy as np
import pytest

from panokit.errors import ItemError
from panokit.evaluate.rendering.known import known_geometry, open_objects


def test_the_rebuilt_object_fills_the_masks(vase):
    known = known_geometry(vase.meta, open_objects(), 48)
    pictures = (vase.views.left_object, vase.views.right_object)
    for view, picture in zip(known.views, pictures, strict=True):
        column, row, depth = view.project(known.mesh.vertices.astype(np.float64))
        assert depth.min() > 0
        rows, columns = np.nonzero(picture.any(axis=-1))
        assert column.min() == pytest.approx(columns.min(), abs=1.5)
        assert column.max() == pytest.approx(columns.max() + 1, abs=1.5)
        assert row.min() == pytest.approx(rows.min(), abs=1.5)
        assert row.max() == pytest.approx(rows.max() + 1, abs=1.5)


def test_the_left_camera_is_the_origin(vase):
    left, right = known_geometry(vase.meta, open_objects(), 48).views
    assert left.position == (0, 0, 0)
    np.testing.assert_allclose(right.position, [vase.views.baseline_m, 0, 0], atol=1e-6)
    np.testing.assert_allclose(right.world_from_camera.matrix, np.eye(3), atol=1e-9)


def test_other_sizes_are_the_same_cameras(vase):
    (large, _), (small, _) = (known_geometry(vase.meta, open_objects(), w).views for w in (48, 12))
    np.testing.assert_allclose(large.project(np.array([0.1, 0.2, -2]))[0] / 4,
                               small.project(np.array([0.1, 0.2, -2]))[0])  # fmt: skip


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"object_id": "folder/nobody"}, "folder of meshes"),
        ({"object": {"sha256": "0"}}, "is another"),
        ({"views": {}}, "does not say"),
    ],
)
def test_what_cannot_be_rebuilt_is_told(vase, change, words):
    with pytest.raises(ItemError, match=words):
        known_geometry(vase.meta | change, open_objects(), 48)
