import numpy as np
import pytest

from panokit.evaluate.pairs import compare_pairs, pairs_table
from panokit.evaluate.scoring import Row


def row(method: str, index: int, camera: str = "A", failed: str = "", **values) -> Row:
    return Row(
        method=method, probe=f"p{index}", category="room", camera=camera, fold=0, seen=False,
        strong=False, values=values, failed=failed,
    )  # fmt: skip


def test_differences_are_of_the_same_picture():
    random = np.random.default_rng(0)
    # Pictures differ far more than the two methods do on each.
    hard = random.uniform(0.1, 0.9, 40)
    rows = [row("ours", i, irradiance_mean=x - 0.01, ball=x) for i, x in enumerate(hard)]
    rows += [row("theirs", i, irradiance_mean=x, ball=x) for i, x in enumerate(hard)]
    found = compare_pairs(rows, "ours", "theirs")["irradiance_mean"]
    assert (found["wins"], found["n"]) == (40, 40)
    assert found["difference"] == pytest.approx(-0.01)
    assert (found["low"], found["high"]) == pytest.approx((-0.01, -0.01))
    turned = compare_pairs(rows, "theirs", "ours")["irradiance_mean"]
    assert (turned["wins"], turned["difference"]) == (0, pytest.approx(0.01))
    # Equal scores are no win for either.
    assert compare_pairs(rows, "ours", "theirs")["ball"]["wins"] == 0


def test_only_pictures_that_both_were_scored_on_count():
    rows = [row("ours", 0, ball=0.1), row("ours", 1, ball=0.1), row("ours", 2, ball=0.1),
            row("theirs", 0, ball=0.2), row("theirs", 1, camera="B", ball=0.2),
            row("theirs", 2, failed="timeout")]  # fmt: skip
    found = compare_pairs(rows, "ours", "theirs")
    assert list(found) == ["ball"]
    assert found["ball"]["n"] == 1
    assert compare_pairs(rows, "ours", "nobody") == {}


def test_the_table_says_by_how_much_it_errs_less():
    rows = [row("ours", i, light_vector_deg=10.0 + i) for i in range(9)]
    rows += [row("theirs", i, light_vector_deg=14.0 + i) for i in range(9)]
    table = pairs_table({"theirs": compare_pairs(rows, "ours", "theirs")})
    assert table[0].count("|") == table[1].count("|") == table[2].count("|")
    assert "| 9 of 9 | 4.0 (4.0 to 4.0) |" in table[2]
