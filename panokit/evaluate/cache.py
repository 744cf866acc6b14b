"""Scores on disk while a run goes on: one small JSON file per probe and method.

A file is valid for the bytes of the probe, the method's digest and the settings that change
scores; anything else is scored again.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from panokit.errors import RecordError
from panokit.evaluate.area_fit import AreaRecord
from panokit.evaluate.predictors import Predictor
from panokit.evaluate.probe_set import ListedProbe
from panokit.evaluate.scoring import Row
from panokit.evaluate.settings import VERSION, ExpansionEvaluation
from panokit.io.files import read_json, write_json
from panokit.provenance import digest_of


class ScoreCache:
    """The scores in a folder.

    Args:
        folder: Made when the first score is kept.
        settings: Of the run; a run with other cameras does not share its scores.
    """

    def __init__(self, folder: Path, settings: ExpansionEvaluation) -> None:
        self._folder = folder
        self._settings = settings

    def rows(
        self, probe: ListedProbe, index: int, method: str, predictor: Predictor, *, rolled: bool
    ) -> list[Row] | None:
        """The kept scores of a method on a probe, under its present heading; None if none."""
        kept = self._read(self._path(probe, index, ["rows", predictor.digest, rolled]))
        if kept is None:
            return None
        seen = predictor.has_seen(probe)
        return [replace(Row(**row), method=method, seen=seen) for row in kept]

    def keep_rows(
        self,
        probe: ListedProbe,
        index: int,
        predictor: Predictor,
        rows: Sequence[Row],
        *,
        rolled: bool,
    ) -> None:
        """Keep scores; those of a failed answer are not kept, so that a new run tries again."""
        if not any(row.failed for row in rows):
            path = self._path(probe, index, ["rows", predictor.digest, rolled])
            self._write(path, [row.to_json() for row in rows])

    def area_records(self, probe: ListedProbe, index: int, fold: int) -> list[AreaRecord] | None:
        """What the area rule needs of a probe's pictures; None if it is not kept."""
        kept = self._read(self._path(probe, index, ["area"]))
        if kept is None:
            return None
        return [AreaRecord(**(record | {"fold": fold})) for record in kept]

    def keep_area_records(
        self, probe: ListedProbe, index: int, records: Sequence[AreaRecord]
    ) -> None:
        """Keep what the area rule needs."""
        path = self._path(probe, index, ["area"])
        self._write(path, [record.to_json() for record in records])

    def _path(self, probe: ListedProbe, index: int, what: list[Any]) -> Path:
        cameras = list(self._settings.cameras)
        key = digest_of([VERSION, probe.sha256, index, cameras, what])
        return self._folder / f"{probe.name}-{key[:16]}.json"

    def _read(self, path: Path) -> list[dict[str, Any]] | None:
        if not path.is_file():
            return None
        try:
            value = read_json(path)
        except RecordError:
            return None
        return value if isinstance(value, list) else None

    def _write(self, path: Path, value: list[dict[str, Any]]) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)
        write_json(path, value)
