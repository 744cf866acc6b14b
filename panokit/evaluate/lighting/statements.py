"""What the thesis says of its models, as comparisons, and how each came out.

A comparison is between two entrants on the same test samples, seed by seed. The primary figure
of a statement decides it; the others stand beside it. A training that had not converged, or that
saw a place of the test, counts for no verdict, and fewer than three pairs of seeds decide nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from panokit.evaluate.lighting.outcome import Entrant, Outcome, epochs_to_within
from panokit.evaluate.lighting.verdicts import Comparison, Expected, Verdict, compare

LEAST_SEEDS = 3
PRIMARY = "code-ssd"
SECONDARY = ("thesis-dssim", "relit-diffuse-si-rmse", "light-vector")
_SECONDARY_OF_REFLECTANCE = ("reflectance-mse", "reflectance-dssim")
EPOCHS = "epochs"
HOLDS, FAILS = "holds", "does not hold"


@dataclass(frozen=True, slots=True, kw_only=True)
class Statement:
    """A claim about two experiments.

    Attributes:
        number: Of the thesis's figure, or "" for what it never reported.
        text: The claim.
        first: The experiment that is said to be better, or the same.
        second: The other one.
        expected: See `panokit.evaluate.lighting.verdicts.compare`.
        primary: The figure that decides; `EPOCHS` counts epochs to within 5 % of the end.
    """

    number: str
    text: str
    first: str
    second: str
    expected: Expected = "first lower"
    primary: str = PRIMARY

    @property
    def secondary(self) -> tuple[str, ...]:
        """The figures beside the primary one."""
        if self.primary == EPOCHS:
            return ()
        if self.primary.startswith("reflectance"):
            return _SECONDARY_OF_REFLECTANCE
        return tuple(one for one in (PRIMARY, *SECONDARY) if one != self.primary)


def _noise(level: int) -> tuple[Statement, Statement]:
    return (
        Statement(
            number="3.2",
            text=f"true normals are better than normals off by {level}° (light)",
            first="dematerial",
            second=f"dematerial-noise-{level}",
        ),
        Statement(
            number="3.1",
            text=f"true normals are better than normals off by {level}° (reflectance)",
            first="dense-reflectance",
            second=f"dense-reflectance-noise-{level}",
            primary="reflectance-code-ssd",
        ),
    )


STATEMENTS: tuple[Statement, ...] = (
    Statement(number="5.1", text="shared weights are as good as unshared ones",
              first="concat-shared-deep", second="concat-unshared-deep", expected="same"),
    Statement(number="5.2", text="the dot product is better, deep",
              first="dot-product-deep", second="concat-shared-deep"),
    Statement(number="5.2", text="the dot product converges faster, deep",
              first="dot-product-deep", second="concat-shared-deep", primary=EPOCHS),
    Statement(number="5.3", text="the dot product is better, shallow",
              first="dot-product", second="concat-shared"),
    Statement(number="5.3", text="the dot product converges faster, shallow",
              first="dot-product", second="concat-shared", primary=EPOCHS),
    Statement(number="5.3", text="deep is as good as shallow",
              first="dot-product-deep", second="dot-product", expected="same"),
    Statement(number="5.4", text="the background helps",
              first="dot-product", second="no-background"),
    Statement(number="5.5", text="a background branch of its own helps more",
              first="background-branch", second="dot-product"),
    Statement(number="5.5", text="shallow with its own branch beats deep without",
              first="background-branch", second="dot-product-deep"),
    Statement(number="5.6", text="a pyramid of similarities does little",
              first="pyramid", second="background-branch", expected="same"),
    *(statement for level in (10, 20, 30) for statement in _noise(level)),
    Statement(number="3.1", text="with true normals, sparse to dense beats end to end",
              first="dense-reflectance", second="picture-reflectance",
              primary="reflectance-code-ssd"),
    Statement(number="", text="panoramas that panokit expanded help, beside reference probes",
              first="augmented-expanded", second="augmented-reference"),
    Statement(number="", text="expanded panoramas help more than linearized ones",
              first="augmented-expanded", second="augmented-linearized"),
    Statement(number="", text="expanded panoramas help panokit's model",
              first="augmented-expanded-panokit", second="augmented-reference-panokit"),
    Statement(number="", text="expanded panoramas help panokit's model, light direction",
              first="augmented-expanded-panokit", second="augmented-reference-panokit",
              primary="light-vector"),
    Statement(number="", text="expanded panoramas help panokit's model, relit ball",
              first="augmented-expanded-panokit", second="augmented-reference-panokit",
              primary="relit-diffuse-rmse"),
    Statement(number="", text="expanded panoramas help panokit's model more than linearized ones",
              first="augmented-expanded-panokit", second="augmented-linearized-panokit",
              primary="relit-diffuse-rmse"),
    Statement(number="", text="multi-scale features help",
              first="pyramid-multi-scale", second="pyramid"),
    Statement(number="", text="true sharing beats copying the left view's weights",
              first="dot-product", second="copy-left"),
    Statement(number="", text="similarity along the row beats pixel by pixel",
              first="epipolar", second="background-branch"),
    Statement(number="", text="panokit's model beats the thesis's final model",
              first="panokit", second="background-branch", primary="thesis-dssim"),
    Statement(number="", text="panokit's model beats the thesis's final model, light direction",
              first="panokit", second="background-branch", primary="light-vector"),
    Statement(number="", text="panokit's model beats the thesis's final model, relit ball",
              first="panokit", second="background-branch", primary="relit-diffuse-rmse"),
    Statement(number="", text="a background put where the map shows it is better",
              first="panokit", second="panokit-no-window"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """How one figure of a statement came out.

    Attributes:
        statement: What was said.
        figure: Which was compared.
        size: Of the experiments.
        comparison: Of all pairs of seeds that count, or of all where too few do.
        verdict: What may be said.
        why: What keeps it from being said, "" if nothing.
    """

    statement: Statement
    figure: str
    size: str
    comparison: Comparison
    verdict: Verdict
    why: str

    @property
    def word(self) -> str:
        """The verdict; of what the thesis never reported there is nothing to reproduce."""
        if self.statement.number:
            return str(self.verdict)
        return {Verdict.REPRODUCED: HOLDS, Verdict.NOT_REPRODUCED: FAILS}.get(
            self.verdict, str(self.verdict)
        )

    def to_json(self) -> dict[str, object]:
        """A dictionary for `json.dump`."""
        found = self.comparison
        return {
            "number": self.statement.number, "statement": self.statement.text,
            "first": self.statement.first, "second": self.statement.second,
            "expected": self.statement.expected, "size": self.size, "figure": self.figure,
            "primary": self.figure == self.statement.primary,
            "n": found.n, "places": found.places, "seeds": found.seeds,
            "mean": round(found.mean, 6), "low": _finite(found.low),
            "high": _finite(found.high), "relative": round(found.relative, 6),
            "verdict": self.word, "why": self.why,
        }  # fmt: skip


def _finite(value: float) -> float | None:
    """Of a single seed there is no interval."""
    return round(value, 6) if np.isfinite(value) else None


def findings(outcome: Outcome, statements: Sequence[Statement] = STATEMENTS) -> list[Finding]:
    """How each statement came out, at each size where both experiments are there."""
    found: list[Finding] = []
    for statement in statements:
        for size in outcome.sizes:
            first, second = (outcome.entrant(name, size)
                             for name in (statement.first, statement.second))  # fmt: skip
            if first is None or second is None:
                continue
            for figure in (statement.primary, *statement.secondary):
                one = finding(outcome, statement, first, second, figure)
                found += [] if one is None else [one]
    return found


def finding(
    outcome: Outcome, statement: Statement, first: Entrant, second: Entrant, figure: str
) -> Finding | None:
    """How one figure came out; None where the entrants do not have it or share no seed."""
    seeds = sorted(set(first.seeds) & set(second.seeds))
    pairs = [(first.members[first.seeds.index(seed)], second.members[second.seeds.index(seed)])
             for seed in seeds]  # fmt: skip
    barred = {
        name: why
        for why, names in (
            ("not converged", {*outcome.not_converged(first), *outcome.not_converged(second)}),
            ("saw a place of the test", {*outcome.seen(first), *outcome.seen(second)}),
        )
        for name in names
    }
    counted = [pair for pair in pairs if not barred.keys() & set(pair)]
    enough = len(counted) >= LEAST_SEEDS
    judged = counted if enough else pairs
    if not judged:
        return None
    compared = (
        _epochs(outcome, first, second, judged) if figure == EPOCHS
        else _scores(outcome, judged, figure, statement.expected)
    )  # fmt: skip
    if compared is None:
        return None
    reasons = dict.fromkeys(barred[name] for pair in pairs for name in pair if name in barred)
    why = "" if enough else "; ".join(
        [f"{len(counted)} of {LEAST_SEEDS} pairs of seeds count", *reasons]
    )  # fmt: skip
    return Finding(
        statement=statement,
        figure=figure,
        size=first.size,
        comparison=compared,
        verdict=compared.verdict if enough else Verdict.UNDECIDED,
        why=why,
    )


def _scores(
    outcome: Outcome, pairs: Sequence[tuple[str, str]], figure: str, expected: Expected
) -> Comparison | None:
    """Sample by sample."""
    columns = [[outcome.values(name, figure) for name in side] for side in zip(*pairs, strict=True)]
    every = np.stack([one for side in columns for one in side])
    finite: NDArray[np.bool_] = np.all(np.isfinite(every), axis=0)
    if not finite.any():
        return None
    keys = [key for key, there in zip(outcome.keys, finite, strict=True) if there]
    place_of = dict(zip(outcome.keys, outcome.place_names, strict=True))
    one, other = ([dict(zip(keys, values[finite], strict=True)) for values in side]
                  for side in columns)  # fmt: skip
    return compare(one, other, place_of, expected=expected)


def _epochs(
    outcome: Outcome, first: Entrant, second: Entrant, pairs: Sequence[tuple[str, str]]
) -> Comparison | None:
    """Seed by seed: Student's t over differences, since one training is one number."""
    fast = {name: epochs_to_within(curve) for entrant in (first, second)
            for name, curve in outcome.curves_by_member(entrant).items()}  # fmt: skip
    told = [(fast[a], fast[b]) for a, b in pairs if a in fast and b in fast]
    if not told:
        return None
    differences = np.array([a - b for a, b in told], np.float64)
    mean = float(differences.mean())
    # Each count is rounded to a whole epoch, which adds a twelfth to its variance (that of an even
    # spread over one epoch), and the difference of two counts has twice that.
    variance = (differences.var(ddof=1) if len(told) > 1 else np.inf) + 1 / 6
    error = float(np.sqrt(variance / len(told)))
    reach = float(stats.t.ppf(0.975, max(len(told) - 1, 1)) * error)
    low, high = mean - reach, mean + reach
    verdict = Verdict.UNDECIDED
    if high < 0:
        verdict = Verdict.REPRODUCED
    elif low > 0:
        verdict = Verdict.NOT_REPRODUCED
    base = float(np.mean([b for _, b in told]))
    return Comparison(n=len(told), places=0, seeds=len(told), mean=mean, low=low, high=high,
                      relative=mean / base, verdict=verdict)  # fmt: skip


Better = Literal["better", "worse", "unclear"]


def against(
    outcome: Outcome, entrant: Entrant, other: Entrant, figure: str
) -> tuple[Comparison, Better] | None:
    """An entrant against a baseline, without regard to seeds; None where it has no such figure."""
    one, two = outcome.scores(entrant, figure), outcome.scores(other, figure)
    finite = np.isfinite(one) & np.isfinite(two)
    if not finite.any():
        return None
    keys = [key for key, there in zip(outcome.keys, finite, strict=True) if there]
    found = compare(
        [dict(zip(keys, one[finite], strict=True))], [dict(zip(keys, two[finite], strict=True))],
        dict(zip(outcome.keys, outcome.place_names, strict=True)),
    )  # fmt: skip
    said: Better = "better" if found.high < 0 else "worse" if found.low > 0 else "unclear"
    return found, said
