import numpy as np
import pytest

from panokit.errors import ItemError
from panokit.evaluate.probe_set import find_probes
from panokit.evaluate.scoring import (
    OTHER_ROLLS_PX,
    STRIDE_ROLLS_PX,
    Picture,
    change_in_decades,
    score_picture,
    take_picture,
)


class Known:
    """Answers with what it was given; `digest` and `has_seen` as a predictor's."""

    digest = "known"

    def __init__(self, answer) -> None:
        self.answer = answer

    def predict(self, pixels):
        return self.answer(pixels)

    def has_seen(self, probe):
        return None


@pytest.fixture
def picture(probe_folder) -> Picture:
    probe = find_probes(probe_folder)[2]
    return take_picture(probe, probe.radiance(), "A", index=2, fold=1)


def test_the_truth_itself_scores_as_perfect(picture: Picture):
    row = score_picture("truth", Known(lambda _: 3 * picture.truth), picture, rolled=False)
    assert (row.camera, row.fold, row.seen, row.failed) == ("A", 1, None, "")
    # A factor is taken out by the protocol.
    assert row.values["gain"] == pytest.approx(1 / 3, rel=1e-4)
    assert row.values["energy_ratio"] == pytest.approx(1, rel=1e-4)
    for name in ("irradiance_mean", "ball", "log_rmse", "sun_stops"):
        assert row.values[name] == pytest.approx(0, abs=1e-3), name
    assert row.values["light_vector_deg"] == pytest.approx(0, abs=0.1)
    assert row.values["cpu_seconds"] >= 0
    assert not any(name.startswith("roll") for name in row.values)


def test_a_clipped_picture_is_short_of_light(picture: Picture):
    clipped = np.minimum(picture.truth, 1)
    row = score_picture("clip", Known(lambda _: clipped), picture, rolled=False)
    assert row.values["energy_ratio"] < 0.9
    assert row.values["sun_stops"] < -1
    assert row.values["range_decades"] < 1


def test_turning_the_picture_is_seen_where_it_matters(picture: Picture):
    def turning(pixels):
        return pixels.astype(np.float32) + 1

    def leaning(pixels):
        return (pixels.astype(np.float32) + 1) * np.linspace(1, 2, pixels.shape[1])[:, None]

    even = score_picture("even", Known(turning), picture, rolled=True).values
    uneven = score_picture("uneven", Known(leaning), picture, rolled=True).values
    for shift in (*STRIDE_ROLLS_PX, *OTHER_ROLLS_PX):
        # The little world is 256 wide: its own width is no roll at all.
        assert even[f"roll_{shift}"] == pytest.approx(0, abs=1e-6)
        if shift % 256:
            assert uneven[f"roll_{shift}"] > 1e-4


def test_change_is_in_decades():
    light = np.random.default_rng(0).uniform(1, 2, (8, 16, 3)).astype(np.float32)
    assert change_in_decades(10 * light, light) == pytest.approx(1, abs=2e-3)
    assert change_in_decades(light, light) == 0


def test_what_fails_is_a_row_that_says_so(picture: Picture):
    def fail(_):
        raise ItemError("The lamp is broken.", reason="broken")

    row = score_picture("bad", Known(fail), picture, rolled=False)
    assert row.failed == "broken: The lamp is broken."
    assert not row.values
    black = score_picture("black", Known(lambda p: np.zeros_like(p, np.float32)), picture,
                          rolled=False)  # fmt: skip
    assert black.failed.startswith("no-light")


def test_a_sun_makes_a_strong_scene_and_a_lamp_does_not(probe_folder):
    probes = find_probes(probe_folder)
    strong = [
        take_picture(probe, probe.radiance(), "B", index=i, fold=0).is_strong
        for i, probe in enumerate(probes)
    ]
    assert strong == [False] * 7 + [True]


def test_a_picture_is_the_same_for_its_place_in_the_list(probe_folder):
    probe = find_probes(probe_folder)[0]
    radiance = probe.radiance()
    first, again, other = (
        take_picture(probe, radiance, "B", index=index, fold=0) for index in (4, 4, 5)
    )
    assert np.array_equal(first.pixels, again.pixels)
    assert not np.array_equal(first.pixels, other.pixels)
    assert first.truth.max() > 1
