"""Which photographs are nearly side by side."""

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.evaluate.real.pairs import find_pairs
from panokit.evaluate.real.scenes import RealScene, RealView, look_together_at
from panokit.evaluate.real.settings import PairSettings
from panokit.frames import Rotation


def view(name, position, heading_deg=0.0, roll_deg=0.0):
    turn = Rotation.from_heading_pitch_roll(np.radians(heading_deg), 0, np.radians(roll_deg))
    return RealView(
        name=name, intrinsics=np.eye(3), width_px=8, height_px=8, world_from_camera=turn,
        position=np.asarray(position, float), read=lambda: None,
    )  # fmt: skip


def scene(*views):
    return RealScene(
        object="o", place="p", views=views, center=np.array([0, 0, -2.0]), lights=(),
        metered=False, scale_known=True,
    )  # fmt: skip


def names(found):
    return [(pair.left.name, pair.right.name) for pair in found]


def test_the_left_one_is_left():
    found = find_pairs(scene(view("b", [0.2, 0, 0]), view("a", [0, 0, 0])), PairSettings())
    assert names(found) == [("a", "b")]
    assert found[0].over_depth == pytest.approx(0.1)
    assert found[0].rotation_deg == found[0].off_axis_deg == 0


@pytest.mark.parametrize(
    "other",
    [
        view("above", [0, 0.2, 0]),
        view("nearer", [0, 0, -0.2]),
        view("turned", [0.2, 0, 0], heading_deg=-40),
        view("leaning", [0.2, 0, 0], roll_deg=45),
        view("far", [1.5, 0, 0]),
        view("same", [0.01, 0, 0]),
    ],
    ids=lambda one: one.name,
)
def test_what_is_not_side_by_side_is_no_pair(other):
    assert find_pairs(scene(view("a", [0, 0, 0]), other), PairSettings()) == []


def test_each_takes_the_best_partner_and_the_best_come_first():
    views = [view(name, [x, 0, 0]) for name, x in (("a", 0), ("b", 0.2), ("c", 0.6))]
    found = find_pairs(scene(*views), PairSettings())
    assert names(found) == [("a", "b"), ("b", "c")]
    assert names(find_pairs(scene(*views), PairSettings(per_scene=1))) == [("a", "b")]


def test_cameras_meet_where_they_look():
    views = [view("a", [-1, 0, 0], heading_deg=30), view("b", [1, 0.2, 0], heading_deg=-30)]
    found = look_together_at(views)
    np.testing.assert_allclose(found, [0, 0.1, -np.sqrt(3)], atol=0.02)
    with pytest.raises(UsageError, match="one way"):
        look_together_at([view("a", [0, 0, 0]), view("b", [1, 0, 0])])


def test_limits_go_from_small_to_large():
    with pytest.raises(ValueError, match="small to a larger"):
        PairSettings(baseline_over_depth=(0.4, 0.1))
