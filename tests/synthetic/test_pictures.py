import cv2
import numpy as np
import pytest

from panokit.synthetic import ServedPicture
from panokit.synthetic.pictures import PictureStore, RecentBodies


def test_pieces_join_to_the_whole_at_any_size(describe, image):
    picture = ServedPicture(capture=describe("one", 4096), image=image)
    store = PictureStore([picture])
    for width in (512, 1024, 3000):
        size = (width, width // 2)
        whole = store.piece(picture, size, (0, 0, *size))
        left = store.piece(picture, size, (0, 0, width // 3, width // 2))
        right = store.piece(picture, size, (width // 3, 0, *size))
        joined = np.hstack([left, right])
        # Inside, the very same; at the seam a piece looks around the sphere.
        assert np.abs(joined.astype(int) - whole)[:, 4:-4].max() <= 1


def test_smaller_sizes_are_averages(describe, image, gradient):
    picture = ServedPicture(capture=describe("one"), image=image)
    small = PictureStore([picture]).piece(picture, (128, 64), (0, 0, 128, 64))
    expected = cv2.resize(gradient, (128, 64), interpolation=cv2.INTER_AREA)
    assert np.abs(small.astype(int) - expected).max() <= 2


def test_decoded_pictures_stay_within_the_budget(describe, image):
    names = [f"picture-{index}" for index in range(6)]
    pictures = [ServedPicture(capture=describe(name, 1024), image=image) for name in names]
    one_decoded = 1024 * 512 * 3
    store = PictureStore(pictures, budget_bytes=2 * one_decoded)
    for picture in pictures:
        store.piece(picture, (1024, 512), (0, 0, 1, 1))
    kept = store._levels._arrays
    assert sum(array.nbytes for array in kept.values()) <= 2 * one_decoded
    assert ("picture-5",) in kept


def test_nearest_respects_its_radius(pictures):
    store = PictureStore(pictures)
    assert store.nearest(44.50029, -28.0, 50).capture.id == "north"
    assert store.nearest(44.50029, -28.0, 0.5) is None
    # 0.0003 degrees of a great circle of 6371 km.
    assert pictures[0].distance_m(44.5003, -28.0) == pytest.approx(33.36, abs=0.01)


def test_recent_bodies_keep_to_their_budget():
    bodies = RecentBodies(10)
    bodies.put("a", b"12345")
    bodies.put("b", b"12345")
    assert bodies.get("a") == b"12345"
    bodies.put("c", b"123")
    assert [bodies.get(name) for name in "abc"] == [b"12345", None, b"123"]
    bodies.put("d", b"x" * 99)
    assert [bodies.get(name) for name in "acd"] == [None, None, b"x" * 99]


def test_nearest_and_around_agree_with_the_distances(pictures):
    store = PictureStore(pictures)
    for place in [(44.5001, -28.0), (44.59, -28.01), (44.52, -27.9)]:
        nearest = min(pictures, key=lambda one: one.distance_m(*place))
        assert store.nearest(*place, 1e6) is nearest
        assert store.nearest(*place, nearest.distance_m(*place) - 0.1) is None
        within = [one for one in pictures if one.distance_m(*place) <= 3000]
        assert store.around(*place, 3000) == within
