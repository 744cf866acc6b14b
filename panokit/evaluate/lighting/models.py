"""Which models are judged, and all that is known of each: from its folder alone."""

import json
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panokit.color.hdr_coding import HdrCoding
from panokit.errors import ModelError, StorageError
from panokit.reflectance.light_network import LIGHT_KINDS, TASK
from panokit.weights import find_model

CARD, TRAINING = "model.toml", "training.json"
# Released suites call a model <experiment>-<size>-s<seed>.
_NAME = re.compile(r"^(?P<experiment>.+?)(-(?P<size>pocket|two-core|full))?(-s(?P<seed>\d+))?$")
_NOISE = re.compile(r"-noise-(\d+)")
# What the suite's recipes of noisy normals have, for models whose tables do not say it.
_SMOOTH_PX = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelFacts:
    """What a model is and how it was trained; None and "" where its folder does not say.

    Attributes:
        name: Of the model, in all tables.
        folder: Where it is.
        file: Of the network, in the folder.
        digest: SHA-256 of the network.
        kind: "stereo", "dematerial", "dense-reflectance" or "picture-reflectance".
        experiment: What is compared; models that differ in the seed alone share it.
        size: "pocket", "two-core", "full", or "".
        seed: Of the training.
        input_px: Width of the pictures that it takes.
        views: "composited" or "object".
        materials: Reflectance maps that go in.
        noise_deg: Mean error of the normals that it was trained with.
        smooth_px: How far their neighbors err alike.
        coding: Of its output.
        converged: Whether its training had.
        samples: That it learned from.
        steps: Of the training.
        epochs: Of the training.
        cpu_hours: Of the training, all processors together.
        parameters: Numbers that were learned.
        places: Where the light of its training samples is from.
        history: A record for each epoch.
    """

    name: str
    folder: Path
    file: str
    digest: str
    kind: str
    experiment: str
    size: str
    seed: int
    input_px: int
    views: str
    materials: int
    noise_deg: float
    smooth_px: float
    coding: HdrCoding
    converged: bool | None
    samples: int | None
    steps: int | None
    epochs: int | None
    cpu_hours: float | None
    parameters: int | None
    places: tuple[str, ...] | None
    history: tuple[Mapping[str, float], ...]

    @property
    def predicts_light(self) -> bool:
        """Whether it predicts a map of light, not of reflectance."""
        return self.kind in LIGHT_KINDS

    def to_json(self) -> dict[str, Any]:
        """What figures need, without the folder and the history."""
        left_out = ("folder", "file", "history", "coding", "places")
        record = {name: getattr(self, name) for name in self.__slots__ if name not in left_out}
        return record | {"coding": self.coding.to_json()}

    def seen(self, places: Iterable[str]) -> list[str] | None:
        """Those of the places that it was trained on; None if its folder does not say."""
        return None if self.places is None else sorted(set(self.places) & set(places))


def find_models(named: Sequence[str]) -> list[ModelFacts]:
    """The models that arguments name: folders, folders of them, or ids of released ones.

    Raises:
        ModelError: If one names none, two have one name, or a folder is damaged.
    """
    found: dict[str, ModelFacts] = {}
    for name in named:
        for folder in _folders(name):
            facts = read_facts(folder)
            known = found.setdefault(facts.name, facts)
            if known.folder.resolve() != facts.folder.resolve():
                raise ModelError(
                    f"{known.folder} and {folder} both call their model {facts.name!r}. Judge "
                    "them into two folders with --out, or rename one."
                )
    return list(found.values())


def _folders(name: str) -> list[Path]:
    place = Path(name)
    if (place / CARD).is_file():
        return [place]
    if place.is_dir():
        inside = [card.parent for card in sorted(place.glob(f"*/{CARD}")) if _is_lighting(card)]
        if not inside:
            raise ModelError(
                f"{name} holds no model that reads light: neither {CARD} nor a folder with one. "
                "Name the folder that `panokit train` wrote."
            )
        return inside
    try:
        return [find_model(name).folder]
    except (ModelError, StorageError) as error:
        raise ModelError(f"There is no folder {name}. {error}") from error


def _is_lighting(card: Path) -> bool:
    """Whether a card is of a model that reads light; damaged ones are told of when read."""
    try:
        return tomllib.loads(card.read_text(encoding="utf-8")).get("task") in (TASK, None)
    except (OSError, tomllib.TOMLDecodeError):
        return True


def read_facts(folder: Path) -> ModelFacts:
    """The facts of the model in a folder.

    Raises:
        ModelError: If it is no model that reads light.
    """
    try:
        card = tomllib.loads((folder / CARD).read_text(encoding="utf-8"))
        spec, file = card["lighting"], card["files"]["lighting"]
        name = str(card["id"])
        training = _training(folder)
        parts = _parts(name)
        # Models released before their tables said it: the suite has it in their names.
        noise = float(spec.get("noise_deg", _noise_of(name)))
        return ModelFacts(
            name=name,
            folder=folder,
            file=str(file["name"]),
            digest=str(file["sha256"]),
            kind=str(spec["kind"]),
            experiment=str(training.get("experiment") or parts["experiment"]),
            size=str(training.get("size") or parts["size"] or ""),
            seed=int(training.get("seed", parts["seed"] or 0)),
            input_px=int(spec["input_px"]),
            views=str(spec["views"]),
            materials=int(spec.get("materials", 1)),
            noise_deg=noise,
            smooth_px=float(spec.get("smooth_px", _SMOOTH_PX if noise else 0.0)),
            coding=HdrCoding.from_json(spec["coding"]) if "coding" in spec else HdrCoding(),
            converged=training.get("converged"),
            samples=training.get("samples"),
            steps=training.get("steps"),
            epochs=training.get("epochs"),
            cpu_hours=training.get("cpu_hours"),
            parameters=training.get("parameters"),
            places=tuple(training["places"]) if "places" in training else None,
            history=tuple(training.get("history", ())),
        )
    except (OSError, tomllib.TOMLDecodeError, KeyError, ValueError, TypeError) as error:
        raise ModelError(
            f"{folder} is not a model that reads light from two views ({error!r}). "
            "Its model.toml needs the tables [lighting] and [files.lighting]."
        ) from error


def _training(folder: Path) -> dict[str, Any]:
    path = folder / TRAINING
    if not path.is_file():
        return {}
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return record


def _parts(name: str) -> dict[str, Any]:
    match = _NAME.match(name)
    return match.groupdict() if match else {"experiment": name, "size": "", "seed": 0}


def _noise_of(name: str) -> float:
    found = _NOISE.search(name)
    return float(found[1]) if found else 0.0
