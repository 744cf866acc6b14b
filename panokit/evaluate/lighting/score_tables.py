"""The tables of scores."""

from panokit.evaluate.lighting.outcome import Entrant, Outcome
from panokit.evaluate.lighting.statements import PRIMARY
from panokit.evaluate.lighting.tables import TextTable, figure, interval

# Figure -> its heading.
HEADINGS = {
    "code-ssd": "SSD of code",
    "code-l1": "L1 of code",
    "thesis-dssim": "DSSIM (thesis)",
    "thesis-dssim-log": "DSSIM (thesis, of logs)",
    "dssim-sphere": "DSSIM (sphere)",
    "thesis-mse": "MSE",
    "l1": "L1",
    "log-rmse": "log RMSE",
    "si-rmse": "si-RMSE",
    "rgb-angular": "color, °",
    "irradiance-mean": "irradiance",
    "energy-ratio": "energy ratio",
    "light-vector": "light vector, °",
    "brightest": "brightest, °",
    "thesis-brightest-rgb": "brightest, px (R, G, B)",
    "thesis-brightest-luma": "brightest, px (luma)",
    "brightest-luma-wrapped": "brightest, px (wrapped)",
    "lights-angle-deg": "lights, °",
    "lights-missed": "lights missed",
    "lights-spurious": "lights made up",
    "relit-diffuse-rmse": "matte ball",
    "relit-diffuse-si-rmse": "matte ball, si",
    "relit-glossy-0.3-si-rmse": "satin ball, si",
    "relit-mirror-si-rmse": "mirror ball, si",
    "relit-plane-si-rmse": "plane, si",
    "reflectance-code-ssd": "SSD of code",
    "reflectance-code-l1": "L1 of code",
    "reflectance-mse": "MSE",
    "reflectance-l1": "L1",
    "reflectance-dssim": "DSSIM (thesis)",
}
_LEAGUE = (
    PRIMARY, "thesis-dssim", "thesis-mse", "light-vector", "relit-diffuse-si-rmse",
    "relit-mirror-si-rmse", "relit-plane-si-rmse",
)  # fmt: skip
_ALL = tuple(name for name in HEADINGS if not name.startswith("reflectance"))
_REFLECTANCE = tuple(name for name in HEADINGS if name.startswith("reflectance"))
_LISTED = {
    "STR-1": ("concat-unshared-deep", ""),
    "STR-2": ("concat-shared-deep", "concat-shared"),
    "STR-3": ("dot-product-deep", "dot-product"),
    "STR-4": ("", "no-background"),
    "STR-5": ("", "augmented-expanded"),
    "STR-6": ("", "background-branch"),
    "STR-7": ("", "pyramid"),
    "STR-8": ("", "pyramid-multi-scale"),
}
_LISTED_NAMES = {
    "STR-1": "concat, unshared", "STR-2": "concat, shared", "STR-3": "dot product",
    "STR-4": "without background", "STR-5": "with augmented data",
    "STR-6": "own background branch", "STR-7": "similarity pyramid",
    "STR-8": "pyramid, multi-scale",
}  # fmt: skip
# Mark beside a name -> what it means.
MARKS = {
    "~": "some or all of its trainings had not converged, and count for no verdict",
    "*": "trained on places of this test: proves nothing",
    "?": "does not say what it was trained on",
}
BY_PLACE = "In parentheses 95 % intervals, by drawing places anew"


def league(outcome: Outcome) -> TextTable:
    """All entrants with the main figures."""
    rows = []
    for entrant in outcome.entrants_with(PRIMARY):
        spreads = [outcome.spread(entrant, name) for name in _LEAGUE]
        cells = [
            "–" if s is None else interval(s.mean, s.low, s.high) if number < 2 else figure(s.mean)
            for number, s in enumerate(spreads)
        ]
        # Of heavy tails the median says more than the mean.
        mse = spreads[_LEAGUE.index("thesis-mse")]
        cells[_LEAGUE.index("thesis-mse")] = "–" if mse is None else figure(mse.percentiles[2])
        rows.append((entrant.title + marks(outcome, entrant), _seeds(entrant), *cells))
    heads = [HEADINGS[name] + (", median" if name == "thesis-mse" else "") for name in _LEAGUE]
    return TextTable(
        id="T-1",
        title="All entrants on the same samples",
        columns=("entrant", "seeds", *heads),
        rows=tuple(rows),
        note=f"Means over {len(outcome.keys)} samples of {len(set(outcome.place_names))} places; "
        f"of MSE the median. {BY_PLACE}. {marks_note(outcome)}",
    )


def all_figures(outcome: Outcome) -> TextTable:
    """Every figure of every entrant."""
    entrants = outcome.entrants_with(PRIMARY)
    return TextTable(
        id="T-A2",
        title="The ablation, all figures (means)",
        columns=("entrant", *(HEADINGS[name] for name in _ALL)),
        rows=tuple(
            (e.title + marks(outcome, e), *(_mean(outcome, e, name) for name in _ALL))
            for e in entrants
        ),
        note="Lower is better for all but the energy ratio, which is best at 1.",
    )


def ablation(outcome: Outcome) -> TextTable:
    """The eight listed models, deep and shallow; a dash for what was not trained."""
    rows = []
    for number, names in _LISTED.items():
        cells: list[str] = []
        for name in names:
            entrant = outcome.entrant(name) if name else None
            cells += (
                ["–", "–", "–"] if entrant is None else
                [_mean(outcome, entrant, one) + (marks(outcome, entrant) if not position else "")
                 for position, one in enumerate((PRIMARY, "thesis-dssim", "light-vector"))]
            )  # fmt: skip
        rows.append((f"{number} {_LISTED_NAMES[number]}", *cells))
    three = ("SSD of code", "DSSIM", "light vector, °")
    heads = [f"{depth}: {one}" for depth in ("deep", "shallow") for one in three]
    return TextTable(
        id="T-A",
        title="The models that the thesis lists, deep and shallow",
        columns=("model", *heads),
        rows=tuple(rows),
        note="A dash: not trained. STR-5 with and without augmented data is compared in the "
        f"verdicts. {marks_note(outcome)}",
    )


def reflectance(outcome: Outcome) -> TextTable | None:
    """Predicted reflectance maps; None if there are none."""
    entrants = outcome.entrants_with(_REFLECTANCE[0])
    if not entrants:
        return None
    rows = []
    for entrant in entrants:
        cells = []
        for name in _REFLECTANCE:
            spread = outcome.spread(entrant, name)
            cells.append("–" if spread is None else interval(spread.mean, spread.low, spread.high))
        rows.append((entrant.title + marks(outcome, entrant), _seeds(entrant), *cells))
    return TextTable(
        id="T-R",
        title="Dense reflectance maps",
        columns=("model", "seeds", *(HEADINGS[name] for name in _REFLECTANCE)),
        rows=tuple(rows),
        note="Reflectance is no light: these are judged against the sphere of the sample's "
        f"material, on the half that faces the camera. {BY_PLACE}.",
    )


def percentiles(outcome: Outcome, id_: str, name: str, title: str) -> TextTable:
    """How one figure is distributed, for every entrant."""
    rows = []
    for entrant in outcome.entrants_with(name):
        s = outcome.spread(entrant, name)
        if s is not None:
            rows.append((
                entrant.title + marks(outcome, entrant), str(s.n),
                interval(s.mean, s.low, s.high), figure(s.sd),
                *(figure(p) for p in s.percentiles), figure(s.most),
            ))  # fmt: skip
    return TextTable(
        id=id_,
        title=title,
        columns=("entrant", "n", "mean", "sd", "p5", "p25", "p50", "p75", "p95", "max"),
        rows=tuple(rows),
        note=f"{BY_PLACE}. {marks_note(outcome)}",
    )


def _mean(outcome: Outcome, entrant: Entrant, name: str) -> str:
    spread = outcome.spread(entrant, name)
    return "–" if spread is None else figure(spread.mean)


def _seeds(entrant: Entrant) -> str:
    return "–" if entrant.is_baseline else str(len(entrant.members))


def marks(outcome: Outcome, entrant: Entrant) -> str:
    """What is to be known beside a name: "~" not converged, "*" seen, "?" unknown."""
    return "".join(
        mark for mark, there in (
            ("~", outcome.not_converged(entrant)), ("*", outcome.seen(entrant)),
            ("?", outcome.unknown(entrant)),
        ) if there
    )  # fmt: skip


def marks_note(outcome: Outcome) -> str:
    """What the marks in use mean."""
    used = set("".join(marks(outcome, entrant) for entrant in outcome.entrants))
    return " ".join(f"{mark} {text}." for mark, text in MARKS.items() if mark in used)
