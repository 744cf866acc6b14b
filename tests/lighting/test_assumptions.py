"""Each assumption that is not met is told, and only that."""

from dataclasses import replace

import numpy as np
import pytest

from panokit.lighting import view_warnings
from tests.lighting.fakes import box_views


@pytest.fixture
def views():
    return box_views()


def test_good_views_give_no_warnings(views):
    assert view_warnings(views) == ()


def moved_down(views):
    return replace(views, right_object=np.roll(views.right_object, 5, axis=0))


def grown(views):
    tall = views.right_object.copy()
    tall[14:50] = np.where(views.right_object[30:31] > 0, 120, 0)
    return replace(views, right_object=tall)


def brighter(views):
    bright = np.minimum(views.right_object.astype(int) * 5 // 4, 255).astype(np.uint8)
    return replace(views, right_object=bright)


def without_object(views):
    return replace(views, mask=np.zeros_like(views.mask))


def at_the_edge(views):
    moved = {name: np.roll(getattr(views, name), 22, axis=1) for name in ("mask", "left_object")}
    wrapped = moved["mask"].copy()
    wrapped[:, :20] = False
    moved["left_object"][:, :20] = 0
    return replace(views, **(moved | {"mask": wrapped}))


def painted(value):
    def paint(views):
        fill = {"left_object": views.mask, "right_object": views.right_object.any(axis=-1)}
        return replace(
            views,
            **{
                n: np.where(m[..., None], np.uint8([value] * 3), 0).astype(np.uint8)
                for n, m in fill.items()
            },
        )

    return paint


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (moved_down, "up or down"),
        (grown, "changed its size"),
        (brighter, "brightness changed"),
        (without_object, "no object"),
        (at_the_edge, "touches the picture's edge"),
        (painted(255), "burnt out"),
        (painted(5), "is black"),
        (lambda views: replace(views, background=0 * views.background), "background"),
    ],
)
def test_a_broken_assumption_is_told(views, change, words):
    assert any(words in text for text in view_warnings(change(views)))


def test_a_camera_that_did_not_move_is_told():
    (text,) = view_warnings(box_views(0))
    assert "sideways" in text
