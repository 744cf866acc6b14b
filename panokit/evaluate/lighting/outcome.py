"""What an evaluation's folder says, ready for figures: entrants, their scores, their curves.

An entrant is an experiment at a size with all its seeds, or a baseline. Its score of a sample is
the mean over seeds, so that more seeds are not more samples.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.errors import StorageError, UsageError
from panokit.evaluate.lighting.evaluation import DATASET, HISTORY, MODELS, read_lines
from panokit.evaluate.lighting.experiments import Experiment, experiment, order_of
from panokit.evaluate.lighting.kept import Kept
from panokit.evaluate.lighting.run import RESULTS, Result, read_results
from panokit.evaluate.lighting.verdicts import place_interval
from panokit.io.files import read_json

Values = NDArray[np.float64]
PERCENTILES = (5, 25, 50, 75, 95)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entrant:
    """An experiment with its seeds, or a baseline.

    Attributes:
        name: Of the experiment, with its size where there are several sizes; or of the baseline.
        title: In figures.
        experiment: Its name alone.
        size: See `panokit.evaluate.lighting.models.ModelFacts`.
        members: Predictors, by seed.
        seeds: Of the members.
        about: Of the experiment.
    """

    name: str
    title: str
    experiment: str
    size: str
    members: tuple[str, ...]
    seeds: tuple[int, ...]
    about: Experiment

    @property
    def is_baseline(self) -> bool:
        """Whether nothing was trained."""
        return self.about.group == "baseline"


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """How a figure is distributed over samples.

    Attributes:
        n: Samples with a finite score.
        mean: Over them.
        low: Lower end of the mean's 95 % interval, by drawing places anew.
        high: Upper end.
        sd: Standard deviation.
        percentiles: At `PERCENTILES`.
        most: The highest.
        seeds: Lowest and highest mean of a seed.
    """

    n: int
    mean: float
    low: float
    high: float
    sd: float
    percentiles: tuple[float, ...]
    most: float
    seeds: tuple[float, float]


class Outcome:
    """An evaluation's folder.

    Args:
        folder: That `panokit evaluate` wrote.

    Raises:
        StorageError: If it holds no results.
    """

    def __init__(self, folder: Path) -> None:
        if not (folder / RESULTS).is_file():
            raise StorageError(
                f"{folder} holds no {RESULTS}. Make one with: panokit evaluate MODEL... --data "
                f"DATASET --out {folder}"
            )
        self.folder = folder
        self.kept = Kept(folder)
        self.models = {line["name"]: line for line in read_lines(folder / MODELS)}
        self.history = read_lines(folder / HISTORY)
        self.dataset: dict[str, Any] = (
            read_json(folder / DATASET) if (folder / DATASET).is_file() else {}
        )
        self._by_predictor: dict[tuple[str, str], dict[str, Result]] = {}
        self._digests: dict[str, str] = {}
        self._values: dict[tuple[str, str, str], Values] = {}
        for result in read_results(folder):
            own = self._by_predictor.setdefault((result.predictor, result.control), {})
            own[result.key] = result
            self._digests[result.predictor] = result.digest
        if not self._by_predictor:
            raise UsageError(f"{folder / RESULTS} has no lines. Run `panokit evaluate` again.")

    @cached_property
    def keys(self) -> list[str]:
        """The samples that every predictor was scored on, in order."""
        each = [set(rows) for (_, control), rows in self._by_predictor.items() if not control]
        return sorted(set.intersection(*each))

    @cached_property
    def place_names(self) -> list[str]:
        """Of the samples."""
        return [self._any[key].place for key in self.keys]

    @cached_property
    def places(self) -> NDArray[np.int64]:
        """(N,) the number of each sample's place."""
        return np.asarray(np.unique(self.place_names, return_inverse=True)[1], np.int64)

    @cached_property
    def categories(self) -> NDArray[np.str_]:
        """(N,) the kind of scene of each sample."""
        return np.array([self._any[key].category for key in self.keys])

    @cached_property
    def _any(self) -> dict[str, Result]:
        return next(rows for (_, control), rows in self._by_predictor.items() if not control)

    @cached_property
    def entrants(self) -> list[Entrant]:
        """All of them, in the order of the suite, baselines last."""
        names = sorted({name for name, control in self._by_predictor if not control})
        groups: dict[tuple[str, str], list[str]] = {}
        for name in names:
            model = self.models.get(name)
            groups.setdefault(
                (model["experiment"], model["size"]) if model else (name, ""), []
            ).append(name)
        sizes = {size for (_, size), members in groups.items() if members[0] in self.models}
        found = [self._entrant(one, size, members, len(sizes) > 1)
                 for (one, size), members in groups.items()]  # fmt: skip
        return sorted(found, key=lambda e: (e.is_baseline, e.size, order_of(e.experiment), e.name))

    @cached_property
    def sizes(self) -> list[str]:
        """The sizes of what was trained, in order; "" is a size of its own."""
        return sorted({one.size for one in self.entrants if not one.is_baseline})

    def _entrant(self, name: str, size: str, members: list[str], tell_size: bool) -> Entrant:
        model = self.models.get(members[0])
        about = experiment(name, model["kind"] if model else "")
        said = f" ({size or 'own size'})" if tell_size and model else ""
        members = sorted(members, key=self.seed_of)
        return Entrant(
            name=f"{name}{said}",
            title=f"{about.title}{said}",
            experiment=name,
            size=size,
            members=tuple(members),
            seeds=tuple(self.seed_of(one) for one in members),
            about=about,
        )

    def seed_of(self, predictor: str) -> int:
        """Of a model; 0 of a baseline."""
        return int(self.models[predictor]["seed"]) if predictor in self.models else 0

    def entrant(self, name: str, size: str | None = None) -> Entrant | None:
        """The entrant of an experiment, or the baseline, if it is there."""
        found = [e for e in self.entrants if e.experiment == name and size in (None, e.size)]
        return found[-1] if found else None

    def entrants_with(self, figure: str) -> list[Entrant]:
        """Those that have a figure."""
        return [e for e in self.entrants if self.has(e.members[0], figure)]

    def has(self, predictor: str, figure: str) -> bool:
        """Whether a predictor has a figure of any sample."""
        rows = self._by_predictor.get((predictor, ""), {})
        return any(figure in row.scores for row in rows.values())

    def digest_of(self, predictor: str) -> str:
        """Of a predictor."""
        return self._digests[predictor]

    def values(self, predictor: str, figure: str, control: str = "") -> Values:
        """(N,) a figure of each of `keys`, NaN where there is none; read-only."""
        what = predictor, figure, control
        if what not in self._values:
            rows = self._by_predictor.get((predictor, control), {})
            found = [rows[key].scores.get(figure, np.nan) if key in rows else np.nan
                     for key in self.keys]  # fmt: skip
            self._values[what] = np.array(found, np.float64)
            self._values[what].setflags(write=False)
        return self._values[what]

    def scores(self, entrant: Entrant, figure: str, control: str = "") -> Values:
        """(N,) the mean over seeds, NaN where none has it."""
        several = np.stack([self.values(one, figure, control) for one in entrant.members])
        counted = np.isfinite(several)
        sums = np.where(counted, several, 0).sum(axis=0)
        with np.errstate(invalid="ignore"):
            return np.asarray(sums / counted.sum(axis=0))

    def controls_of(self, entrant: Entrant) -> list[str]:
        """The controls that ran with an entrant."""
        return [control for name, control in self._by_predictor
                if name == entrant.members[0] and control]  # fmt: skip

    def seconds(self, entrant: Entrant) -> Values:
        """(N,) how long the first seed's predictions took."""
        rows = self._by_predictor[entrant.members[0], ""]
        return np.array([rows[key].seconds for key in self.keys])

    def spread(
        self, entrant: Entrant, figure: str, which: NDArray[np.bool_] | None = None
    ) -> Spread | None:
        """How a figure is distributed, over some of the samples; None if none has it."""
        values = self.scores(entrant, figure)
        chosen = np.isfinite(values) if which is None else np.isfinite(values) & which
        if not chosen.any():
            return None
        own = values[chosen]
        places = np.asarray(np.unique(self.places[chosen], return_inverse=True)[1], np.int64)
        low, high = place_interval(own, places)
        members = [self.values(one, figure)[chosen] for one in entrant.members]
        # One seed may find no light in any sample where another does.
        means = [float(np.nanmean(one)) for one in members if np.isfinite(one).any()]
        return Spread(
            n=len(own),
            mean=float(own.mean()),
            low=low,
            high=high,
            sd=float(own.std(ddof=1)) if len(own) > 1 else 0.0,
            percentiles=tuple(float(p) for p in np.percentile(own, PERCENTILES)),
            most=float(own.max()),
            seeds=(min(means), max(means)),
        )

    def curves(self, entrant: Entrant, figure: str = "ssd") -> NDArray[np.float64]:
        """(seeds, epochs) of the validation; as long as the shortest training."""
        found = list(self.curves_by_member(entrant, figure).values())
        shortest = min((len(one) for one in found), default=0)
        return np.array([one[:shortest] for one in found], np.float64).reshape(len(found), shortest)

    def curves_by_member(self, entrant: Entrant, figure: str = "ssd") -> dict[str, list[float]]:
        """The whole curve of each member that has one, in the order of the members."""
        lines: dict[str, list[tuple[int, float]]] = {}
        for line in self.history:
            if line["model"] in entrant.members and line.get(figure) is not None:
                lines.setdefault(line["model"], []).append((line["epoch"], line[figure]))
        return {name: [value for _, value in sorted(lines[name])]
                for name in entrant.members if name in lines}  # fmt: skip

    def not_converged(self, entrant: Entrant) -> list[str]:
        """Members whose training had not converged."""
        return [one for one in entrant.members
                if one in self.models and self.models[one]["converged"] is False]  # fmt: skip

    def seen(self, entrant: Entrant) -> list[str]:
        """Members that were trained on a place of the test."""
        return [one for one in entrant.members if self.models.get(one, {}).get("seen")]

    def unknown(self, entrant: Entrant) -> list[str]:
        """Members that do not say what they were trained on."""
        return [one for one in entrant.members
                if one in self.models and self.models[one]["seen"] is None]  # fmt: skip


def epochs_to_within(curve: Sequence[float], share: float = 0.05) -> int:
    """The first epoch at which a curve is within a share of its end, from 1 on.

    The end is the mean of the last fifth, since a last epoch may be a lucky one.
    """
    values = np.asarray(curve, np.float64)
    end = float(values[min(int(np.ceil(0.8 * len(values))), len(values) - 1) :].mean())
    return int(np.flatnonzero(values <= end * (1 + share))[0]) + 1
