"""Released models: what there is, where their files are, and that they are what was released.

A model is a folder `models/<id>` with `model.toml`, its ONNX files, a card and its scores.
"""

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from panokit.errors import ModelError, StorageError
from panokit.provenance import digest_of
from panokit.shipped import shipped_path, shipped_roots


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelFile:
    """One network of a model.

    Attributes:
        role: What the stage calls it: "gain", "components".
        name: Of the file, in the model's folder.
        sha256: Of its bytes.
        inputs: Names of the inputs, in order.
        outputs: Names of the outputs, in order.
    """

    role: str
    name: str
    sha256: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelTensor:
    """An input or output of a model's networks.

    Attributes:
        type: "float32".
        shape: Lengths; a name where a length is free, the same name for the same length.
        meaning: In words.
    """

    type: str
    shape: tuple[int | str, ...]
    meaning: str

    def to_json(self) -> dict[str, Any]:
        """A dictionary for `json.dump`."""
        return {"type": self.type, "shape": list(self.shape), "meaning": self.meaning}


@dataclass(frozen=True, slots=True, kw_only=True)
class ReleasedModel:
    """A model as its `model.toml` describes it.

    Attributes:
        id: Also the name of its folder.
        task: The stage that runs it; "expand-baseline" is only to be judged beside others.
        license: SPDX identifier of the weights' license.
        description: One line.
        features_version: Of the function that makes the inputs; the stage refuses others. Empty
            where the input is the picture itself.
        folder: Where the files are.
        files: By role.
        tensors: Every input and output of the files, by name.
    """

    id: str
    task: str
    license: str
    description: str
    features_version: str
    folder: Path
    files: Mapping[str, ModelFile]
    tensors: Mapping[str, ModelTensor]

    @property
    def digest(self) -> str:
        """Of all weights: what the provenance of a result says."""
        return digest_of({role: file.sha256 for role, file in sorted(self.files.items())})

    def path(self, role: str) -> Path:
        """Where the network of this role is.

        Raises:
            ModelError: If the model has none.
        """
        if role not in self.files:
            raise ModelError(
                f"Model {self.id!r} has no network {role!r}, only {sorted(self.files)}."
            )
        return self.folder / self.files[role].name


def released_models() -> list[ReleasedModel]:
    """Every model that this installation has, by id."""
    folders: dict[str, Path] = {}
    for root in reversed(shipped_roots()):
        for card in sorted(root.glob("models/*/model.toml")):
            folders[card.parent.name] = card.parent
    return [read_model(folders[name]) for name in sorted(folders)]


def find_model(model_id: str) -> ReleasedModel:
    """The released model with this id.

    Raises:
        ModelError: If there is none; the message lists those there are.
    """
    try:
        return read_model(shipped_path(f"models/{model_id}/model.toml").parent)
    except StorageError as error:
        known = ", ".join(model.id for model in released_models()) or "none"
        raise ModelError(
            f"There is no released model {model_id!r}; this installation has: {known}."
        ) from error


def read_model(folder: Path) -> ReleasedModel:
    """The model in a folder that holds a `model.toml`.

    Raises:
        ModelError: If the description is missing or damaged.
    """
    path = folder / "model.toml"
    try:
        record: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        files = {
            role: ModelFile(
                role=role,
                name=file["name"],
                sha256=file["sha256"],
                inputs=tuple(file["inputs"]),
                outputs=tuple(file["outputs"]),
            )
            for role, file in record["files"].items()
        }
        tensors = {
            name: ModelTensor(
                type=tensor["type"], shape=tuple(tensor["shape"]), meaning=tensor["meaning"]
            )
            for name, tensor in record.get("tensors", {}).items()
        }
        return ReleasedModel(
            id=record["id"],
            task=record["task"],
            license=record["license"],
            description=record["description"],
            features_version=record["features_version"],
            folder=folder,
            files=files,
            tensors=tensors,
        )
    except (OSError, tomllib.TOMLDecodeError, KeyError, TypeError, AttributeError) as error:
        raise ModelError(
            f"{path} does not describe a model ({error}). Install the package again."
        ) from error


def verify_model(model: ReleasedModel) -> None:
    """Check that every file of a model is the one that was released.

    Raises:
        ModelError: If a file is missing or its bytes differ.
    """
    for file in model.files.values():
        path = model.folder / file.name
        try:
            found = hashlib.sha256(path.read_bytes()).hexdigest()
        except OSError as error:
            raise ModelError(
                f"Model {model.id!r}: cannot read {path} ({error.strerror}). Install the "
                "package again."
            ) from error
        if found != file.sha256:
            raise ModelError(
                f"Model {model.id!r}: {file.name} has SHA-256 {found[:12]}..., not "
                f"{file.sha256[:12]}...: it is damaged or was changed. Install the package again."
            )
