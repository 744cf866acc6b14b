"""The table is complete, callable, and tells the truth about which way is better."""

from pathlib import Path

import numpy as np
import pytest

from panokit.errors import UsageError
from panokit.metrics import PROTOCOLS, native_scores, protocol

PAGE = Path(__file__).parents[2] / "docs" / "ideas" / "metrics.md"


def maps() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A truth, a good estimate and a bad one, in units of the clip level."""
    random = np.random.default_rng(0)
    truth = random.uniform(0.2, 0.6, (64, 128, 3)).astype(np.float32)
    good = truth * random.uniform(0.95, 1.05, truth.shape).astype(np.float32)
    truth[20:24, 40:44], good[20:24, 41:45] = 200, 170
    bad = truth[:, ::-1] * np.array([0.5, 0.2, 0.9], np.float32)
    bad[40:48, 80:96] = 3000
    return truth, good, bad


def given(takes: str) -> tuple[tuple, tuple, tuple]:
    """Inputs of equal, good and bad quality for a kind of protocol."""
    truth, good, bad = maps()
    if takes == "maps":
        return (truth, truth), (good, truth), (bad, truth)
    alpha = np.ones((64, 128, 1), np.float32)
    if takes == "renders":
        render, fair, wrong = (np.concatenate([m, alpha], 2) for m in maps())
        return (render, render), (fair, render), (wrong, render)
    if takes == "frames":
        return (truth, truth), (good, truth), (bad, truth)
    if takes == "object images":
        shown = np.clip(truth, 0, 0.9)
        mask = np.ones((64, 128), bool)
        noise = np.random.default_rng(1).uniform(0.3, 1.7, truth.shape)
        return (shown, shown, mask), (shown * noise**0.1, shown, mask), (shown * noise, shown, mask)
    random = np.random.default_rng(2)
    a = random.normal(size=(200, 4))
    near, far = random.normal(0.2, 1, (200, 4)), random.normal(2, 3, (200, 4))
    return (a, a), (near, a), (far, a)


def badness(row, value: float) -> float:
    """A figure as a distance from the best one."""
    if row.better == "near 1":
        return abs(value - 1)
    if row.better == "near 0":
        return abs(value)
    return -value if row.better == "higher" else value


@pytest.mark.parametrize("name", PROTOCOLS)
def test_a_better_estimate_scores_better(name):
    row = PROTOCOLS[name]
    equal, good, bad = (row.score(*inputs) for inputs in given(row.takes))
    if name in ("lights-spurious", "lights-missed") or np.isnan(bad):
        assert equal == 0 or np.isnan(bad)
    elif name in {"light-direction-compat", "owl-compat", "owl-fixed"}:
        assert badness(row, equal) <= badness(row, bad)
    else:
        assert badness(row, equal) <= badness(row, good) <= badness(row, bad)
    if row.better == "lower":
        # The arc cosine of the published float32 code is good to a hundredth of a degree.
        assert equal == pytest.approx(0, abs=0.05 if "angular" in name else 2e-3)


def test_every_row_is_in_the_documentation():
    page = PAGE.read_text(encoding="utf-8")
    missing = [name for name in PROTOCOLS if f"`{name}`" not in page and not _family(name, page)]
    assert missing == []


def _family(name: str, page: str) -> bool:
    """Whether the page names a family such as `relit-<scene>-rmse` or `spheres-rmse-<variant>`."""
    stem = name.removesuffix("-compat").removesuffix("-fixed")
    if f"`{stem}-<variant>`" in page:
        return True
    last = next((p for p in ("-si-rmse", "-rmse", "-angular-deg") if name.endswith(p)), "")
    return name.startswith("relit-") and bool(last) and f"`relit-<scene>{last}`" in page


def test_native_scores_are_those_rows():
    truth, good, _ = maps()
    scores = native_scores(good, truth)
    assert set(scores) == {name for name, row in PROTOCOLS.items() if row.variant == "native"}
    for name in ("mse", "si-rmse-rgb", "relit-diffuse-rmse", "lights-angle-deg"):
        assert scores[name] == PROTOCOLS[name].score(good, truth)


def test_the_thesis_is_judged_on_its_anamorphic_64x64():
    random = np.random.default_rng(3)
    truth = random.lognormal(0, 1, (64, 64, 3)).astype(np.float32)
    for name, row in PROTOCOLS.items():
        if name.startswith("thesis"):
            assert row.score(truth, truth) == pytest.approx(0, abs=1e-9)
            assert row.score(truth[::-1], truth) > 0.01


def test_published_and_corrected_rows_come_in_pairs():
    for name in PROTOCOLS:
        if name.endswith("-compat"):
            assert name.removesuffix("-compat") + "-fixed" in PROTOCOLS


def test_a_wrong_name_is_answered_with_near_ones():
    assert protocol("mse").unit == "radiance²"
    with pytest.raises(UsageError, match="spheres-rmse-compat"):
        protocol("sphere-rmse-compat")
